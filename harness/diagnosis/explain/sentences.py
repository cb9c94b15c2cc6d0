"""All that is said of a verdict, in sentences: the verdict itself, what a reader is warned of, what to record next."""

import math
from collections.abc import Mapping, Sequence

from harness.core.quantity import Quantity
from harness.diagnosis.baseline.words import strokes_of
from harness.diagnosis.explain.could_hide import Hidden
from harness.diagnosis.explain.next_experiment import Open, Release, releases
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.grading.contest import Contest, in_step
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.grading.prediction import free_run, ratio
from harness.diagnosis.inverse_dynamics.grade import ForceGraded
from harness.diagnosis.outcome import Grade, Holdout, Mechanism, Outcome
from harness.diagnosis.problem import Problem
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import (
    ADVISED,
    DECISIVE,
    LEAST_CYCLES,
    MOST_LIKELY,
    PREDICTS_WORSE,
    SHARE_OF_MISFIT,
    Rule,
)
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search, under
from harness.diagnosis.verdict import Judgement
from harness.kernels.solve import Scales
from harness.model.registry import TERMS
from harness.model.term import DRIVEN, LARGER, SLOW

_ONE = ("this recording", "its", "it", "this recording")
_SEVERAL = ("these recordings", "their", "they", "these recordings together")
_SURE = 0.99
"""Probability that is not told apart from certainty."""


def sentence_of(outcome: Outcome, has: Sequence[str] = ()) -> str:
    """The verdict in a sentence or two, with numbers, and what was chosen before it.

    has : names of the terms that the user's own simulation has, which then does not leave them out.
    """
    return " ".join((_verdict(outcome, has), *outcome.problem.choices))


def _verdict(outcome: Outcome, has: Sequence[str]) -> str:
    it, its, they, _ = _SEVERAL if outcome.problem.alone else _ONE
    verdict, mechanisms = outcome.verdict, outcome.mechanisms
    if verdict == "adequate":
        return f"Viscous and Coulomb friction explain {it} to {its} noise: nothing is left out that {they} could show."
    if verdict == "missing_physics":
        said = " ".join(m.statement for m in mechanisms)
        if len(mechanisms) == 1 and MOST_LIKELY in outcome.rules:
            return f"{_most_likely(outcome, f'explains {it} to {its} noise', has)} {said}"
        return f"{_left_out([m.name for m in mechanisms], has)}: {said}"
    # a constant force that the base has
    beside = "".join(f" Beside it: {m.statement}" for m in mechanisms if m.grade is Grade.EXPLAINS)
    tables, table = [m for m in mechanisms if m.grade is Grade.TABULATED], ""
    if tables:
        laws = " ".join(dict.fromkeys(m.statement for m in tables))
        table = f" What has no name is in the model as a table that takes {_percent(tables[0].share)} off. {laws}"
    left = "" if outcome.remainder is None else outcome.remainder.looks_like
    return f"{_graded(outcome, has)}{beside}{table}{f' {left[0].upper()}{left[1:]}.' if left else ''}"


def _graded(outcome: Outcome, has: Sequence[str]) -> str:
    """Which names are how much of what is left out."""
    it, its, _, these = _SEVERAL if outcome.problem.alone else _ONE
    # beside the names that share a verdict a model may hold small parts
    parts = {Grade.TABULATED, Grade.EXPLAINS} | ({Grade.MINOR} if outcome.verdict == "one_of" else set())
    named = [m for m in outcome.mechanisms if m.grade not in parts]
    words = [_plain(m.name) for m in named]
    share = _percent(named[0].share) if named else ""
    if outcome.verdict == "main_effect":
        over = 1.0 if outcome.remainder is None else outcome.remainder.over_noise
        likely = _most_likely(outcome, f"{share} of the misfit", has)
        return f"{likely} {named[0].statement} The residual is {over:.2g} times the sensors' noise."
    if outcome.verdict == "one_of":
        one_of = f"one of {', '.join(words[:-1])} or {words[-1]}"
        leaves = "viscous and Coulomb friction leave" if has else "the simulation leaves"
        if outcome.remainder is None:
            others = "the other" if len(words) == 2 else "the others"
            return (
                f"What {leaves} out is {one_of}: {words[0]} explains {it} to {its} noise, {others} nearly as well, and"
                f" {these} cannot tell which."
            )
        return (
            f"The main thing that {leaves} out is {one_of}; {these} cannot tell which. The first takes {share} of the"
            " misfit off."
        )
    minor = f" The largest single part of it is {words[0]} ({share})." if words else ""
    return (
        f"Viscous and Coulomb friction do not explain {it}, and no entry of the catalogue is the main part of what they"
        f" leave.{minor}"
    )


def _most_likely(outcome: Outcome, does: str, has: Sequence[str]) -> str:
    """What the first name does, and its probability where that is known."""
    first = outcome.mechanisms[0]
    p = "" if first.probability is None else f"P {min(first.probability, _SURE):.2f}, "
    had = ", which your simulation has" if first.name in has else ""
    return f"Most likely missing: {_plain(first.name)}{had} ({p}{does}):"


def _left_out(names: Sequence[str], has: Sequence[str]) -> str:
    """What explains the recording, and how much of it the simulation has."""
    own, missing = (" and ".join(_plain(n) for n in names if (n in has) is inside) for inside in (True, False))
    if not own:
        return f"The simulation leaves out {missing}"
    if not missing:
        return f"Viscous and Coulomb friction leave out {own}, which your simulation has"
    return f"The simulation has {own} and leaves out {missing}"


def _plain(name: str) -> str:
    return name.replace("-", " ")


def _percent(share: float | None) -> str:
    return "an unknown share" if share is None else f"{100.0 * share:.0f} %"


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
            f"{_NOTHING} in the best model found {' and '.join(held)} ended on a bound, so that other numbers stand in"
            " for it."
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


def cautions(found: Search, judgement: Judgement, prediction: Holdout) -> tuple[str, ...]:
    """Of a search that explains a recording, or ends at nothing; none where all is as it should be."""
    chosen, base = found.chosen, found.base
    if judgement.rival is not None:
        one, other = (" with ".join(key_of(f)) for f in (chosen, judgement.rival))
        return (
            f"{one} would explain it, but {other} nearly as well (BIC {judgement.rival.bic - chosen.bic:.0f} worse):"
            " when pairs of different kinds do, it is as likely an effect of no catalogue, and none is named; standard"
            " errors are inflated by the misfit",
        )
    said = []
    if judgement.verdict == "unexplained":
        why = "no entry or pair of the catalogue explains it" if found.doubted is None else _followed(found.doubted)
        said.append(f"{why}; standard errors are inflated by the misfit")
        misfit = base.chi2 - base.points
        closest = found.singles[:_MOST_CLOSEST] if misfit > 0.0 else ()
        near = [f"{key_of(f)[0]} {100.0 * (base.chi2 - f.chi2) / misfit:.0f} %" for f in closest]
        if near:
            said.append(
                f"of the misfit the closest entries take off, each alone: {', '.join(near)}; none is named, because"
                " none explains it"
            )
        if found.problem.spare > DECISIVE.value:
            said.append(
                "the noise of the measured force shifts reversals and sticking by more than can be allowed for; a force"
                " measured with less noise would decide"
            )
        return tuple(said)
    if LEAST_CYCLES in judgement.rules:
        few = _few(strokes_of(chosen, found.problem).cycles, found.problem)
        said.append(f"it explains the recording to its noise, but {few}")
    if SHARE_OF_MISFIT in judgement.rules:
        said.append(
            f"noise is {100.0 * chosen.chi2 / base.chi2:.0f} % of what viscous and Coulomb friction leave: several"
            " small effects could do the rest as well"
        )
    if judgement.verdict == "missing_physics" and prediction.refined_rmse:
        most = {c: PREDICTS_WORSE.value * before for c, before in prediction.baseline_rmse.items()}
        worse = [c for c, after in prediction.refined_rmse.items() if after > most[c]]
        if worse:
            said.append(f"BIC decides for the refined model although it predicts {', '.join(worse)} worse")
    return tuple(said)


def cautions_of_misfit(graded: Graded, doubted: Fit | None = None) -> tuple[str, ...]:
    """Of a misfit that no model explains; doubted : a pair that meets the noise on too few words."""
    misfit = graded.misfit
    tried = "entry or pair" if misfit.problem.pairs_searched else "entry"
    why = f"no {tried} of the catalogue explains it to its noise" if doubted is None else _followed(doubted)
    said = [f"{why}; standard errors allow for the misfit"]
    if misfit.left_out > 0.0:
        said.append(
            f"the first {misfit.left_out:.4g} s, up to the first turning point, took no part: what lets go there cannot"
            " be told from what is missing"
        )
    if LEAST_CYCLES in graded.rules:
        said.append(_few(graded.cycles, misfit.problem))
    return (*said, *_doubts(graded), *keeping_time(graded))


def cautions_of_force(graded: ForceGraded) -> tuple[str, ...]:
    """Of a fitted force that nothing explains."""
    none = "no entry of the catalogue says the force to its noise"
    if graded.over.left is Left.NOISE:
        none = "what says the force to its noise moves worse than viscous and Coulomb friction alone"
    said = [f"{none}; standard errors allow for what is left"]
    if LEAST_CYCLES in graded.rules:
        many = f"{2.0 * LEAST_CYCLES.value:g}"
        said.append(f"{graded.words:.3g} effective samples are few to exclude every other name; {many} would do")
    return (*said, *_doubts(graded), *keeping_time(graded))


def _few(cycles: float, problem: Problem) -> str:
    of = "recording" if "driven" in problem.given else "decay"
    return f"{cycles:.3g} cycles are few to exclude every other name; a {of} of {LEAST_CYCLES.value:g} would do"


def _followed(pair: Fit) -> str:
    """Why a pair that meets the noise is no verdict."""
    return (
        f"{' with '.join(key_of(pair))} would leave noise alone, but two laws can follow the few independent strokes of"
        " this recording whatever acts"
    )


def keeping_time(found: Contest) -> tuple[str, ...]:
    """Why what takes much is not named, where that is a law that keeps time with the motion."""
    clock = in_step(found)
    if clock is None:
        return ()
    return (
        f"{clock.name} takes {100.0 * clock.share:.0f} % of the misfit off and is no name: it keeps time with the"
        " motion itself, and such a law follows any other",
    )


def _doubts(found: Contest) -> tuple[str, ...]:
    """Why what is named is not sure: how often small effects alone come to the same."""
    if found.grade not in (Grade.MAIN, Grade.ONE_OF) or MOST_LIKELY not in found.rules:
        return ()
    return (
        f"of simulated machines that look like this one {100.0 * found.posterior['']:.0f} % have no main effect:"
        " several small ones come to the same",
    )


def out_of_budget(seconds: float) -> str:
    """Of a search that a budget, s, ended."""
    return (
        f"the budget of {seconds:g} s ended the search: what is said is the best so far, and laws that were not tried"
        f" may explain more (--budget {4.0 * seconds:g} goes on)"
    )


_MOST_HIDDEN = 2
"""Laws that could hide and are said, those that shift a number most."""


def hiding(numbers: Mapping[str, Quantity], hidden: tuple[Hidden, ...]) -> tuple[str, ...]:
    """On the laws that could shift a number by most of its standard errors; none where there are none."""
    errors = {name: q.stderr for name, q in numbers.items() if q.stderr}

    def worst(one: Hidden) -> float:
        return max((one.shifts[name] / error for name, error in errors.items() if name in one.shifts), default=0.0)

    by_name = {one.name: one for one in sorted(hidden, key=worst)}  # of a law's variants the one that shifts most
    largest = list(reversed(by_name.values()))[:_MOST_HIDDEN]
    laws = " or ".join(f"{h.name} with {h.number} up to {h.most:.2g} {h.unit}".removesuffix(" 1") for h in largest)
    return (f"{laws} could hide in it: beside each number stands what that could shift it by",) if laws else ()


_BY_FAMILY = {
    "friction": "releases from several displacements, the smallest a few times x_k, and a longer rest at the end",
    "damping": "releases from displacements that differ by a factor of three or more",
    "stiffness": LARGER,
    "environment": "the same release repeated: what hangs on the clock and what hangs on the motion then part",
    "sensor": "position and acceleration recorded together",
}
_DRIVEN = {
    "friction": SLOW,
    "damping": "drives whose speeds differ by a factor of three or more",
    "stiffness": DRIVEN[LARGER],
    "environment": "the same drive repeated: what hangs on the clock and what hangs on the motion then part",
    "sensor": "position and acceleration recorded together",
}
_PARTS = 0.5
"""Of what a model leaves now, from which a difference is worth a recording; it moves no verdict."""


def next_experiment(found: Open | None, problem: Problem, scales: Scales) -> str:
    """What would decide between names that a recording leaves open; empty when nothing is open."""
    if found is None:
        return ""
    name, other = found.names
    told = next(
        (t.told_from[b] for a, b in (found.names, (other, name)) for t in TERMS if t.name == a and b in t.told_from),
        None,
    )
    if "driven" in problem.given:
        advice = DRIVEN[told] if told else _DRIVEN[found.family]
    elif found.family == "sensor" and {"x", "a"} <= set(problem.channels):
        advice = LARGER
    else:
        far = "" if found.family == "sensor" else _by_release(found, problem, scales)
        advice = far or told or _BY_FAMILY[found.family]
    return f"To tell {name} from {other}: {advice}."


def to_be_sure(mechanisms: Sequence[Mechanism], rules: Sequence[Rule], driven: bool) -> str:
    """What would make sure of a law that is most likely: empty where it is sure or others are listed.

    driven : whether a force drives the slider, and nothing lets it go.
    """
    listed = [m for m in mechanisms if m.grade in (Grade.EXPLAINS, Grade.MAIN)]
    if len(listed) != 1 or not {LEAST_CYCLES, MOST_LIKELY}.intersection(rules):
        return ""
    term = listed[0].entry.term
    if LEAST_CYCLES in rules and driven:
        advice = f"a recording of {2.0 * LEAST_CYCLES.value:g} independent strokes or more"
    elif LEAST_CYCLES in rules:
        advice = f"a decay of {LEAST_CYCLES.value:g} cycles or more, let go from farther out if friction ends it before"
    elif term.repeating("travel") is not None:
        advice = "strokes from other places: what hangs on the place stays where it is"
    else:
        advice = (_DRIVEN if driven else _BY_FAMILY)[term.family]
    return f"To be sure of {listed[0].name}: {advice}."


def _by_release(found: Open, problem: Problem, scales: Scales) -> str:
    """From how far to let go for the two to part; "" where no other amplitude parts them, or nothing lets go."""
    one_clock = any("one-clock" in e.term.needs for f in (found.first, found.rival) if f for e in f.model.terms)
    if found.rival is None or one_clock or problem.covariates:
        return ""
    each = releases(under(found.first, problem), under(found.rival, problem), problem, scales)
    sides = [[one for one in each if (one.factor > 1.0) is larger and one.apart >= _PARTS] for larger in (True, False)]
    told = sorted((side[0] for side in sides if side), key=lambda one: -one.apart)
    said = " or ".join(_released(one, "rad" if problem.angular else "m") for one in told)
    return f"let it go {said}, and diagnose both recordings with --together" if told else ""


def _released(one: Release, unit: str) -> str:
    # two figures, and no power of ten however many times it is
    apart = f"{float(f'{one.apart:.2g}'):.12g}"
    far = f"{one.factor:.2g} times as far, where the two differ by {apart} times what is left now"
    return f"from {one.amplitude:.2g} {unit} ({far})"
