"""All that is said of a verdict, in sentences: the verdict itself, what a reader is warned of, what to record next."""

import math
from collections.abc import Mapping, Sequence

from harness.core.quantity import Quantity, outweighs
from harness.core.wording import capitalised
from harness.diagnosis.baseline.words import strokes_of
from harness.diagnosis.explain.could_hide import Hidden
from harness.diagnosis.explain.next_experiment import Open, releases
from harness.diagnosis.fit.standard_errors import unit_of
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
    INTEGRATED,
    LEAST_CYCLES,
    MAIN_FROM,
    MOST_LIKELY,
    PREDICTS_WORSE,
    SHARE_OF_MISFIT,
    Rule,
)
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search, under
from harness.diagnosis.verdict import Judgement
from harness.kernels.solve import Scales
from harness.model.model import Restoring
from harness.model.registry import TERMS
from harness.model.term import DRIVEN, LARGER, SLOW

_WORTH = 0.01
"""Share of the misfit from which a table is worth a sentence."""
_HARDLY = 1.1
"""Of the noise, below which it is no use to say what a residual looks like."""
_FRICTION, _ERRORS = ("zeta", "x_k", "c", "f_k"), 2.0
"""Numbers of friction, and standard errors from zero within which one is not seen."""
_SURE = 0.99
"""Probability that is not told apart from certainty."""


def sentence_of(outcome: Outcome, has: Sequence[str] = ()) -> str:
    """The verdict in two sentences at most, with numbers.

    has : names of the terms that the user's own simulation has, which it then does not lack.
    """
    it, its = _recorded(outcome)
    mechanisms = outcome.mechanisms
    match outcome.verdict:
        case "adequate":
            return _enough(outcome, it, its)
        case "missing_physics" if len(mechanisms) == 1 and MOST_LIKELY in outcome.rules:
            return f"{_most_likely(outcome, f'explains {it} to {its} noise', has)}. {mechanisms[0].statement}"
        case "missing_physics":
            return _missing(mechanisms, has)
    # beside the names that share a verdict a model may hold small parts
    parts = {Grade.TABULATED, Grade.EXPLAINS} | ({Grade.MINOR} if outcome.verdict == "one_of" else set())
    named = [m for m in mechanisms if m.grade not in parts]
    words, share = [_plain(m.name) for m in named], _percent(named[0].share) if named else ""
    if outcome.verdict == "main_effect":
        likely = _most_likely(outcome, f"explains {share} of the misfit", has)
        return f"{likely}: {_numbers(named[0])}.{_residual(outcome)}"
    if outcome.verdict == "one_of":
        return _one_of(outcome, words, share)
    part = named[0] if named and named[0].grade is Grade.PART else None
    untold = f"Cannot tell what is missing: {_untold(outcome, words, share)}"
    return untold if part is None else _beside_a_rest(part)


def _beside_a_rest(part: Mechanism) -> str:
    """A law that is there, whatever else is."""
    said = f"Part of what is missing is {_plain(part.name)} ({_percent(part.share)} of the misfit): {_numbers(part)}"
    return f"{said}. Every stretch held out is predicted better with it; the rest is unexplained."


def _untold(outcome: Outcome, words: Sequence[str], share: str) -> str:
    """What is known where nothing is named for sure."""
    most = "no term of the catalogue explains most of the misfit."
    if INTEGRATED in outcome.rules:
        few = f"less than {100.0 * INTEGRATED.value:g} % of it"
        return f"this trace has no noise, and viscous and Coulomb friction leave {few}, no more than an integrator may."
    if words:
        return f"{most} The largest contribution is {words[0]} ({share} of the misfit)."
    if outcome.remainder is not None:
        return f"{most}{_residual(outcome)}"
    held = outcome.problem.holds(outcome.base.model)
    if held is not None:
        f_k, force = outcome.base.model.f_k, f"{held:.3g} {unit_of('N', outcome.problem)}"
        slides = "viscous and Coulomb friction explain how it slides"
        return f"{slides}, but at rest {force} do not move it, {held / f_k:.2g} times f_k."
    # nothing was graded by its share: what comes near is all that is known
    it, its = _recorded(outcome)
    best = max(outcome.evidence, key=lambda tried: tried.delta_bic, default=None)
    near = "" if best is None or best.delta_bic <= 0.0 else f"; {_plain(best.name)} comes nearest"
    return f"no term of the catalogue is sure to explain {it} to {its} noise{near}."


def _recorded(outcome: Outcome) -> tuple[str, str]:
    """What a verdict is of, and its possessive."""
    if not outcome.problem.alone:
        return "this recording", "its"
    differ = "" if outcome.pooled is None else outcome.pooled.differs_in
    return f"these recordings{differ and f', which differ in {differ},'}", "their"


def _enough(outcome: Outcome, it: str, its: str) -> str:
    """That nothing is missing, as far as the recording was looked at, or which law is likelier and not decided for."""
    explain, problem = f"viscous and Coulomb friction explain {it} to {its} noise", outcome.problem
    first = max(outcome.posterior, key=lambda one: one.probability, default=None)
    if first is not None and first.names and outcome.stepping is None:
        likelier = f"{' with '.join(map(_plain, first.names))} may be missing (P {min(first.probability, _SURE):.2f})"
        return f"No missing physics is shown: {explain}. {capitalised(likelier)}, which this evidence does not decide."
    friction = [q for name, q in outcome.base_parameters.items() if name in _FRICTION]
    if friction and all(q.value is not None and q.value <= _ERRORS * (q.stderr or 0.0) for q in friction):
        return "No missing physics is shown, nor any friction: its numbers are within two standard errors of zero."
    p = next((f" (P {min(one.probability, _SURE):.2f})" for one in outcome.posterior if not one.names), "")
    if problem.looked_at is None:
        return f"No missing physics{p}: {explain}."
    speed, share = problem.looked_at
    slow = f"{speed:.2g} {unit_of('m/s', problem)}"
    return (
        f"No missing physics above {slow}{p}: {explain} at such speeds. What friction does below, beside reversals"
        f" ({1.0 - share:.0%} of the time), was not looked at."
    )


def _one_of(outcome: Outcome, words: Sequence[str], share: str) -> str:
    """Names that a recording cannot distinguish."""
    it, its = _recorded(outcome)
    either = f"{', '.join(words[:-1])} or {words[-1]}"
    names = f"{either}; {it} cannot distinguish them"
    likely = [m.probability for m in outcome.mechanisms if m.grade is Grade.ONE_OF and m.probability is not None]
    surest = bool(likely) and likely[0] > MOST_LIKELY.value
    if surest:
        names = f"most likely {words[0]}; {it} cannot exclude {' or '.join(words[1:])}"
    together = min(sum(likely), _SURE)
    p = f" (together P {together:.2f})" if likely else ""
    left = outcome.remainder is not None
    first = f"{words[0]} explains {f'{share} of the misfit' if left else f'{it} to {its} noise'}"
    if likely and sum(likely) < MOST_LIKELY.value:
        return f"Physics is missing, probably no single effect of the catalogue. Nearest{p}: {either}; {first}."
    if left:
        return f"Dominant effect missing{p}: {names}. {capitalised(first)}."
    others = "the other does" if len(words) == 2 else "the others do"
    return f"Missing physics{p}: {names}. {capitalised(first)}{'' if surest else f', {others} nearly as well'}."


def _residual(outcome: Outcome) -> str:
    """What the best model's residual is like, a blank before it; empty where nothing is known of it."""
    tables = [m for m in outcome.mechanisms if m.grade is Grade.TABULATED]
    if tables and (tables[0].share or 0.0) >= _WORTH:
        return f" A force without a name, tabulated, explains {_percent(tables[0].share)} of it."
    left = outcome.remainder
    if left is None:
        return ""
    if left.over_noise < _HARDLY:
        return " The residual is little more than the sensors' noise."
    return f" {capitalised(left.looks_like)}, and is {_two_figures(left.over_noise)} times the sensors' noise."


def _most_likely(outcome: Outcome, does: str, has: Sequence[str]) -> str:
    """What the first name does, and its probability where that is known."""
    first = outcome.mechanisms[0]
    p = "" if first.probability is None else f"P {min(first.probability, _SURE):.2f}, "
    had = ", which your simulation has" if first.name in has else ""
    return f"Most likely missing: {_plain(first.name)}{had} ({p}{does})"


def _missing(mechanisms: Sequence[Mechanism], has: Sequence[str]) -> str:
    """What explains the recording, and how much of it the simulation has."""
    missing, own = ([m for m in mechanisms if (m.name in has) is inside] for inside in (False, True))
    had = " and ".join(_plain(m.name) for m in own)
    if not missing:
        return f"No missing physics: the recording needs {had}, which your simulation has. {mechanisms[0].statement}"
    if len(missing) == 1:
        said = f"Missing physics: {_plain(missing[0].name)}{f', beside {had} of your simulation' if had else ''}."
        return f"{said} {missing[0].statement}"
    return f"Missing physics: {' and '.join(f'{_plain(m.name)} ({_numbers(m)})' for m in missing)}."


def _numbers(one: Mechanism) -> str:
    return ", ".join(f"{name} = {q}" for name, q in one.parameters.items())


def _plain(name: str) -> str:
    return name.replace("-", " ")


def _two_figures(times: float) -> str:
    """No power of ten, however many times it is."""
    return f"{float(f'{times:.2g}'):.12g}"


def _percent(share: float | None) -> str:
    return "an unknown share" if share is None else f"{100.0 * share:.0f} %"


_NOTHING = "No change is advised:"


def unadvised(outcome: Outcome) -> str | None:
    """Why nothing is to be changed by the refined model, one sentence; None where it serves.

    It must leave noise, or be the main effect with the remainder said beside it; its numbers must be the recording's
    and no bound's; and run freely it must miss less than the base model does.
    """
    if outcome.verdict == "adequate":
        return None
    refined, left = outcome.refined, outcome.chi2_per_point(outcome.refined)
    if left is not None and left >= ADVISED.value and outcome.verdict != "main_effect":
        return f"{_NOTHING} the best model's residual is {math.sqrt(left):.3g} times the noise."
    held = [f.name for f, v in zip(refined.free, refined.values, strict=True) if v <= f.lower or v >= f.upper]
    if held:
        return f"{_NOTHING} {' and '.join(held)} of the best model ended on a bound, so that other numbers compensate."
    if not _runs_better(outcome):
        return (
            f"{_NOTHING} fitted to the first part of the recording, the best model predicts the rest no better than the"
            " base model."
        )
    return None


def left_beside(outcome: Outcome) -> str | None:
    """What a reader of advice is to know of the model behind it; None where that leaves noise alone."""
    left = outcome.chi2_per_point(outcome.refined)
    if left is None or left < ADVISED.value:
        return None
    return f"The residual of this model is {math.sqrt(left):.3g} times the noise: what it lacks biases these numbers."


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
            " an effect outside the catalogue is as likely, and none is reported; standard errors are inflated"
            " accordingly",
        )
    if (
        judgement.verdict == "unexplained"
        and found.left is Left.NOISE
        and found.problem.holds(chosen.model) is not None
    ):
        return ("friction at rest larger than sliding is static friction's, or Stribeck's, or a bristle's",)
    said = []
    if judgement.verdict == "unexplained":
        why = _unexplained(found)
        if MAIN_FROM in judgement.rules:
            why = f"{' with '.join(key_of(chosen))} would explain it, but a smooth curve of no name may be it as well"
        said.append(f"{why}; standard errors are inflated accordingly")
        misfit = base.chi2 - base.points
        closest = found.singles[:_MOST_CLOSEST] if misfit > 0.0 else ()
        near = [f"{key_of(f)[0]} {100.0 * (base.chi2 - f.chi2) / misfit:.0f} %" for f in closest]
        if near:
            said.append(f"closest terms, share of the misfit explained by each alone: {', '.join(near)}")
        if found.problem.spare > DECISIVE.value:
            said.append(
                "the noise of the measured force shifts reversals and sticking by more than can be allowed for; a force"
                " measured with less noise would decide"
            )
        return tuple(said)
    if LEAST_CYCLES in judgement.rules:
        few = _few(strokes_of(chosen, found.problem).cycles, found.problem)
        said.append(few)
    if SHARE_OF_MISFIT in judgement.rules:
        said.append(
            f"noise is {100.0 * chosen.chi2 / base.chi2:.0f} % of the base model's residual: several small effects"
            " could explain the rest as well"
        )
    if judgement.verdict == "missing_physics" and prediction.refined_rmse:
        most = {c: PREDICTS_WORSE.value * before for c, before in prediction.baseline_rmse.items()}
        worse = [c for c, after in prediction.refined_rmse.items() if after > most[c]]
        if worse:
            said.append(f"BIC prefers the refined model although it predicts {', '.join(worse)} worse")
    return tuple(said)


def cautions_of_misfit(graded: Graded, found: Search) -> tuple[str, ...]:
    """Of a misfit that no model explains; found : the search that came to nothing."""
    misfit = graded.misfit
    said = [f"{_unexplained(found)}; standard errors are inflated accordingly"]
    if misfit.left_out > 0.0:
        said.append(f"skipped the first {misfit.left_out:.3g} s, up to the first turning point (release transient)")
    if LEAST_CYCLES in graded.rules:
        said.append(_few(graded.cycles, misfit.problem))
    return (*said, *_doubts(graded), *keeping_time(graded))


def cautions_of_force(graded: ForceGraded) -> tuple[str, ...]:
    """Of a fitted force that nothing explains."""
    none = "no model fits the force down to its noise"
    if graded.over.left is Left.NOISE:
        none = "what fits the force down to its noise simulates worse than viscous and Coulomb friction alone"
    said = [f"{none}; standard errors are inflated accordingly"]
    if LEAST_CYCLES in graded.rules:
        many = f"{2.0 * LEAST_CYCLES.value:g}"
        said.append(f"{graded.words:.3g} effective samples are too few to exclude every other term; {many} would do")
    return (*said, *_doubts(graded), *keeping_time(graded))


def _few(cycles: float, problem: Problem) -> str:
    of = "recording" if "driven" in problem.given else "decay"
    return f"{cycles:.3g} cycles are too few to exclude every other term; a {of} of {LEAST_CYCLES.value:g} would do"


def _unexplained(found: Search) -> str:
    """Why there is no verdict, a pair that meets the noise among them."""
    if found.doubted is None:
        return "no model fits down to the noise"
    pair = f"{' with '.join(key_of(found.doubted))} would leave only noise, but"
    if found.doubted_by:
        return f"{pair} a smooth curve of the {found.doubted_by} that has no name says as much"
    return f"{pair} two laws can mimic any effect in so few independent half-cycles"


def keeping_time(found: Contest) -> tuple[str, ...]:
    """Why what takes much is not named, where that is a law that keeps time with the motion."""
    clock = in_step(found)
    if clock is None:
        return ()
    return (
        f"{clock.name} fits {100.0 * clock.share:.0f} % of the misfit but is not reported: phase-locked to the motion,"
        " it can mimic any law",
    )


def _doubts(found: Contest) -> tuple[str, ...]:
    """Why what is named is not sure: how often small effects alone come to the same."""
    if found.grade not in (Grade.MAIN, Grade.ONE_OF) or MOST_LIKELY not in found.rules:
        return ()
    return (
        f"of simulated machines like this one {100.0 * found.posterior['']:.0f} % have no dominant effect, but several"
        " small ones that look the same",
    )


def out_of_budget(seconds: float) -> str:
    """Of a search that a budget, s, ended."""
    return f"the budget of {seconds:g} s ended the search with the best so far; --budget {4.0 * seconds:g} tries more"


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
    return (f"{laws} could be hidden in it; each number has the systematic error that it would cause",) if laws else ()


def by_form(numbers: Mapping[str, Quantity], listed: bool) -> tuple[str, ...]:
    """On the numbers that another form of a named law, or a listed one, would shift by more than their errors."""
    moved = {name: q for name, q in numbers.items() if outweighs(q.systematic, q.stderr)}
    each = " and ".join(f"{name} by up to {q.systematic:.2g} {q.unit}".removesuffix(" 1") for name, q in moved.items())
    other = "another form of the law, or another name that is listed," if listed else "another form of the law"
    return (f"{other} would shift {each}: a systematic error, beside the standard one",) if moved else ()


_BY_FAMILY = {
    "friction": "releases from several displacements, the smallest a few times x_k, and a longer rest at the end",
    "damping": "releases from displacements that differ by a factor of three or more",
    "stiffness": LARGER,
    "environment": "the same release repeated, later: an effect of the clock stays with the clock",
    "sensor": "position and acceleration recorded together",
}
_DRIVEN = {
    "friction": SLOW,
    "damping": "drives whose speeds differ by a factor of three or more",
    "stiffness": DRIVEN[LARGER],
    "environment": "the same drive repeated, later: an effect of the clock stays with the clock",
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
    if "driven" in problem.given or "u" in problem.channels:
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
        advice = f"a recording of {2.0 * LEAST_CYCLES.value:g} independent half-cycles or more"
    elif LEAST_CYCLES in rules:
        advice = f"a decay of {LEAST_CYCLES.value:g} cycles or more, let go from farther out if friction ends it before"
    elif term.repeating("travel") is not None:
        advice = "strokes from other places: an effect of the place stays where it is"
    else:
        advice = (_DRIVEN if driven else _BY_FAMILY)[term.family]
    return f"To be sure of {listed[0].name}: {advice}."


def _by_release(found: Open, problem: Problem, scales: Scales) -> str:
    """From how far to let go for the two to part; "" where no other amplitude parts them, or nothing lets go."""
    one_clock = any("one-clock" in e.term.needs for f in (found.first, found.rival) if f for e in f.model.terms)
    if found.rival is None or one_clock or problem.covariates or found.first.model.restoring is Restoring.NONE:
        return ""
    each = releases(under(found.first, problem), under(found.rival, problem), problem, scales)
    sides = [[one for one in each if (one.factor > 1.0) is larger and one.apart >= _PARTS] for larger in (True, False)]
    told = sorted((side[0] for side in sides if side), key=lambda one: -one.apart)
    if not told:
        return ""
    unit, about = "rad" if problem.angular else "m", "the two then differ by {} times the residual"
    said = []
    for one in told:
        said.append(f"{one.amplitude:.2g} {unit} ({about.format(_two_figures(one.apart))})")
        about = "{} times"
    return f"let it go from {' or '.join(said)}, and diagnose both recordings with --together"
