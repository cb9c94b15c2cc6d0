"""From a prepared recording to an outcome: fit, search, decide, say."""

from dataclasses import replace

from harness.diagnosis.advice import next_experiment
from harness.diagnosis.decided import doubt
from harness.diagnosis.driven.holdout import holdout_windows
from harness.diagnosis.driven.noisyfit import along
from harness.diagnosis.driven.search import left_said, search_driven
from harness.diagnosis.driven.validate import Judge
from harness.diagnosis.fit import Fit
from harness.diagnosis.hand import after_hand, knocked_at_release
from harness.diagnosis.holdout import forced, holdout
from harness.diagnosis.long import lifted, shortened
from harness.diagnosis.mechanism import mechanism
from harness.diagnosis.numbers import base_parameters
from harness.diagnosis.outcome import Holdout, Outcome, Spans, Verdict
from harness.diagnosis.problem import Problem
from harness.diagnosis.search import Search, noise_of, search, under
from harness.diagnosis.select import DECISIVE, key_of, settle
from harness.diagnosis.spans import spans_of
from harness.diagnosis.stepping import as_stepped
from harness.diagnosis.steps import Stepping
from harness.kernels.solve import Scales
from harness.model.model import ModelTerm

_MOST_CLOSEST = 3
_NOISY_FORCE = (
    "the noise of the measured force shifts reversals and sticking by more than can be allowed for; a force measured"
    " with less noise would decide"
)
_JUDGED = (
    "terms were kept because the force error on the other recording falls with them, so that its errors took part in"
    " the choice; what stays was not tested for being noise"
)


def diagnose(problem: Problem, judge: Judge | None = None) -> Outcome:
    """Diagnose a recording: what viscous and Coulomb friction leave unexplained, and what explains it.

    judge : another driven recording, which must confirm what is named where nothing explains this one to its noise.
    Raises InputError when the recording holds no free decay to fit, SimulationError when no model could be simulated.
    """
    if problem.by_force:
        driven, scales = search_driven(problem, judge)
        outcome = conclude(driven, scales)
        judged = () if judge is None else (_JUDGED,)
        return replace(outcome, warnings=(*outcome.warnings, left_said(outcome.problem), *judged))
    short, base, scales = shortened(problem)
    whole = None if short is problem else problem
    short, base = along(base, short, scales)
    short = replace(short, noise=noise_of(base, short, scales.omega))
    found = search(short, settle(under(base, short), short, scales), scales)
    doubtful = problem.drive is None and (not found.explained or knocked_at_release(found.chosen, scales))
    free = after_hand(found.problem, scales) if doubtful else None
    if free is not None:
        later, scales, touched = free
        said = f"the first {touched:.4g} s are left out: no free decay, as if a hand had not yet been off"
        outcome = _concluded(later, scales, whole)
        return replace(outcome, warnings=(*outcome.warnings, said))
    return _concluded(found, scales, whole)


def _concluded(found: Search, scales: Scales, whole: Problem | None) -> Outcome:
    """What a free decay's search has come to; whole : all of its samples, where the search saw means of them."""
    told = found if whole is None else lifted(found, whole, scales)
    trace = as_stepped(told, scales)
    return conclude(told, scales, coarse=found) if trace is None else conclude(trace[0], scales, trace[1])


def conclude(found: Search, scales: Scales, stepping: Stepping | None = None, coarse: Search | None = None) -> Outcome:
    """Say what a search has come to.

    stepping : of the engine whose trace the recording is. coarse : the search as it was, where its samples were means:
    what was held out is predicted in it.
    """
    problem = found.problem
    verdict, rival = _verdict(found)
    refined = _refined(found, verdict)
    acting = [(entry, spans_of(entry, refined, problem, scales.omega)) for entry in refined.model.terms]
    mechanisms = sorted(
        (mechanism(found, i, entry, problem, spans) for i, (entry, spans) in enumerate(acting)),
        key=lambda m: -m.delta_bic,
    )
    searched = found if coarse is None else coarse
    prediction = _prediction(searched, verdict, scales, acting)
    warnings = [] if stepping is None else [stepping.sentence]
    if rival is not None:
        warnings.append(_undecided(chosen=found.chosen, rival=rival))
    elif verdict == "unexplained":
        warnings.append("no entry or pair of the catalogue explains it; standard errors are inflated by the misfit")
        warnings += _closest(found)
        warnings += [_NOISY_FORCE] if _force_too_noisy(problem) else []
    if verdict == "missing_physics" and prediction.refined_rmse:
        worse = [c for c, after in prediction.refined_rmse.items() if after > 1.05 * prediction.baseline_rmse[c]]
        if worse:
            warnings.append(f"BIC decides for the refined model although it predicts {', '.join(worse)} worse")
    return Outcome(
        problem=problem,
        scales=scales,
        base=found.base,
        refined=refined,
        verdict=verdict,
        mechanisms=tuple(mechanisms),
        holdout=prediction,
        evidence=tuple((key_of(f)[0], found.base.bic - f.bic) for f in found.singles),
        base_parameters=base_parameters(found.base, problem, scales.omega, verdict == "adequate"),
        refined_parameters=base_parameters(refined, problem, scales.omega, verdict != "unexplained"),
        next_experiment=next_experiment(tuple(mechanisms), problem),
        warnings=tuple(warnings),
        stepping=stepping,
    )


def _force_too_noisy(problem: Problem) -> bool:
    """Whether noise of the force changes reversals and sticking by as much as a term would."""
    return problem.force_noise is not None and problem.force_noise.beyond > DECISIVE


def _verdict(found: Search) -> tuple[Verdict, Fit | None]:
    """The verdict, and the rival of a pair that is not told apart from it."""
    if not found.explained:
        return "unexplained", None
    rival = None if found.problem.by_force else doubt(found)
    if rival is not None:
        return "unexplained", rival
    return "missing_physics" if found.chosen.model.terms else "adequate", None


def _refined(found: Search, verdict: Verdict) -> Fit:
    """The model that a verdict stands by."""
    return found.chosen if verdict == "missing_physics" else found.base


def _prediction(found: Search, verdict: Verdict, scales: Scales, acting: list[tuple[ModelTerm, Spans]]) -> Holdout:
    """What was held out, predicted by the base and the refined model, and by one term too many where none is needed."""
    problem, refined = found.problem, _refined(found, verdict)
    if problem.by_force:
        return holdout_windows(found.base, refined, problem, scales)
    prediction = holdout(found.base, refined, problem, scales, acting)
    if verdict == "adequate":
        prediction = replace(prediction, forced=forced(found.base, found.singles, problem, scales))
    return prediction


def _undecided(chosen: Fit, rival: Fit) -> str:
    """Why a pair that explains a recording is not named."""
    one, other = (" with ".join(key_of(f)) for f in (chosen, rival))
    return (
        f"{one} would explain it, but {other} nearly as well (BIC {rival.bic - chosen.bic:.0f} worse): when pairs of"
        " different kinds do, it is as likely an effect of no catalogue, and none is named; standard errors are"
        " inflated by the misfit"
    )


def _closest(found: Search) -> list[str]:
    """What of the catalogue would take off most, where nothing explains a recording."""
    misfit = found.base.chi2 - found.base.points
    near = [(key_of(f)[0], (found.base.chi2 - f.chi2) / misfit) for f in found.singles[:_MOST_CLOSEST]]
    if misfit <= 0.0 or not near:
        return []
    said = ", ".join(f"{name} {100.0 * share:.0f} %" for name, share in near)
    return [f"of the misfit the closest entries take off, each alone: {said}; none is named, because none explains it"]
