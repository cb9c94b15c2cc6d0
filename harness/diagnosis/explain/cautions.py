"""What a reader of a verdict is warned of, and whether its model is good enough to change a simulation by."""

import math

from harness.diagnosis.baseline.words import strokes_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.grading.contest import Contest, in_step
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.grading.prediction import free_run, ratio
from harness.diagnosis.outcome import Grade, Holdout, Outcome
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import ADVISED, DECISIVE, LEAST_CYCLES, MOST_LIKELY, PREDICTS_WORSE, SHARE_OF_MISFIT
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search
from harness.diagnosis.verdict import Judgement

_NOTHING = "No parameter or term is advised to be changed:"


def unadvised(outcome: Outcome) -> str | None:
    """Why nothing is to be changed by the refined model, one sentence; None where it serves.

    It must leave noise, or be the main effect with the remainder said beside it; its numbers must be the recording's
    and no bound's; and run freely it must miss less than the base model does.
    """
    if outcome.verdict == "adequate":
        return None
    refined, left = outcome.refined, outcome.chi2_per_point(outcome.refined)
    if left is not None and left >= ADVISED.value and outcome.verdict != "main_effect":
        return f"{_NOTHING} the best model found leaves {math.sqrt(left):.3g} times the noise itself."
    held = [f.name for f, v in zip(refined.free, refined.values, strict=True) if v <= f.lower or v >= f.upper]
    if held:
        return (
            f"{_NOTHING} in the best model found {' and '.join(held)} ended on a"
            " bound, so that other numbers stand in for it."
        )
    if not _runs_better(outcome):
        return (
            f"{_NOTHING} fitted to the first part of the recording, the best model found misses as much of the rest as"
            " the base model."
        )
    return None


def left_beside(outcome: Outcome) -> str | None:
    """What a reader of advice is to know of the model behind it; None where that leaves noise alone."""
    left = outcome.chi2_per_point(outcome.refined)
    if left is None or left < ADVISED.value:
        return None
    return (
        f"These numbers are of a model that leaves {math.sqrt(left):.3g} times the noise: what it lacks is in them too."
    )


def _runs_better(outcome: Outcome) -> bool:
    """Whether the last part of a recording, predicted from the first, is missed by less than the base model misses."""
    forward = outcome.mechanisms[0].forward if outcome.mechanisms else None
    if forward is not None:
        pairs = [(forward.refined_rmse[c], before) for c, before in forward.baseline_rmse.items()]
        return math.prod(after / before for after, before in pairs if before > 0.0) < 1.0
    if not outcome.problem.starts.names:
        # windows each begin as recorded: there is no free run, and what was held out has been predicted already
        return True
    base, refined = (free_run(f, outcome.problem, outcome.scales) for f in (outcome.base, outcome.refined))
    return base is None or refined is None or ratio(refined, base) < 1.0


_MOST_CLOSEST = 3
"""Names listed as closest."""
_NOISY_FORCE = (
    "the noise of the measured force shifts reversals and sticking by more than can be allowed for; a force measured"
    " with less noise would decide"
)


def cautions(found: Search, judgement: Judgement, prediction: Holdout) -> tuple[str, ...]:
    """Sentences, none where all is as it should be."""
    if judgement.rival is not None:
        return (_undecided(chosen=found.chosen, rival=judgement.rival),)
    if judgement.verdict == "unexplained":
        none = "no entry or pair of the catalogue explains it"
        why = none if found.doubted is None else _followed(found.doubted)
        said = f"{why}; standard errors are inflated by the misfit"
        noisy = found.problem.spare > DECISIVE.value
        return (said, *_closest(found), *((_NOISY_FORCE,) if noisy else ()))
    unsure = _unsure(found, judgement)
    if judgement.verdict == "missing_physics" and prediction.refined_rmse:
        most = {c: PREDICTS_WORSE.value * before for c, before in prediction.baseline_rmse.items()}
        worse = [c for c, after in prediction.refined_rmse.items() if after > most[c]]
        said = f"BIC decides for the refined model although it predicts {', '.join(worse)} worse"
        return (*unsure, said) if worse else unsure
    return unsure


def _unsure(found: Search, judgement: Judgement) -> tuple[str, ...]:
    """Why a lone law that explains a recording is not sure."""
    said = []
    if LEAST_CYCLES in judgement.rules:
        cycles = strokes_of(found.chosen, found.problem).cycles
        said.append(f"it explains the recording to its noise, but {_few(cycles, found.problem)}")
    if SHARE_OF_MISFIT in judgement.rules:
        said.append(
            f"noise is {100.0 * found.chosen.chi2 / found.base.chi2:.0f} % of what viscous and Coulomb friction leave:"
            " several small effects could do the rest as well"
        )
    return tuple(said)


def _undecided(chosen: Fit, rival: Fit) -> str:
    """Why a pair that explains a recording is not named."""
    one, other = (" with ".join(key_of(f)) for f in (chosen, rival))
    return (
        f"{one} would explain it, but {other} nearly as well (BIC {rival.bic - chosen.bic:.0f} worse): when pairs of"
        " different kinds do, it is as likely an effect of no catalogue, and none is named; standard errors are"
        " inflated by the misfit"
    )


def _few(cycles: float, problem: Problem) -> str:
    of = "recording" if "driven" in problem.given else "decay"
    return f"{cycles:.3g} cycles are few to exclude every other name; a {of} of {LEAST_CYCLES.value:g} would do"


def _closest(found: Search) -> tuple[str, ...]:
    """What of the catalogue would take off most, where nothing explains a recording."""
    misfit = found.base.chi2 - found.base.points
    near = [(key_of(f)[0], (found.base.chi2 - f.chi2) / misfit) for f in found.singles[:_MOST_CLOSEST]]
    if misfit <= 0.0 or not near:
        return ()
    said = ", ".join(f"{name} {100.0 * share:.0f} %" for name, share in near)
    return (f"of the misfit the closest entries take off, each alone: {said}; none is named, because none explains it",)


def _followed(pair: Fit) -> str:
    """Why a pair that meets the noise is no verdict."""
    return (
        f"{' with '.join(key_of(pair))} would leave noise alone, but two laws can follow the few independent strokes of"
        " this recording whatever acts"
    )


def cautions_of_misfit(graded: Graded, doubted: Fit | None = None) -> tuple[str, ...]:
    """Sentences on a misfit that no model explains; doubted : a pair that meets the noise on too few words."""
    tried = "entry or pair" if graded.misfit.problem.pairs_searched else "entry"
    why = f"no {tried} of the catalogue explains it to its noise" if doubted is None else _followed(doubted)
    said = [f"{why}; standard errors allow for the misfit"]
    if graded.misfit.left_out > 0.0:
        said.append(
            f"the first {graded.misfit.left_out:.4g} s, up to the first turning point, took no part: what lets go there"
            " cannot be told from what is missing"
        )
    if LEAST_CYCLES in graded.rules:
        said.append(_few(graded.cycles, graded.misfit.problem))
    said += unlikely(graded)
    return (*said, *keeping_time(graded))


def keeping_time(found: Contest) -> tuple[str, ...]:
    """Why what takes much is not named, where that is a law that keeps time with the motion."""
    clock = in_step(found)
    if clock is None:
        return ()
    return (
        f"{clock.name} takes {100.0 * clock.share:.0f} % of the misfit off and is no name: it keeps time with the"
        " motion itself, and such a law follows any other",
    )


def unlikely(found: Contest) -> tuple[str, ...]:
    """Why what is named is not sure: how often small effects alone come to the same."""
    none = found.posterior[""]
    if found.grade not in (Grade.MAIN, Grade.ONE_OF) or MOST_LIKELY not in found.rules:
        return ()
    return (
        f"of simulated machines that look like this one {100.0 * none:.0f} % have no main effect: several small ones"
        " come to the same",
    )
