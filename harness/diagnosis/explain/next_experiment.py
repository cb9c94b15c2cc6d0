"""The recording that would decide between names that this one leaves open."""

from collections.abc import Sequence
from dataclasses import dataclass

from harness.diagnosis.explain.other_release import Release, releases
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.outcome import Grade, Mechanism
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import LEAST_CYCLES, MOST_LIKELY, Rule
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search, under
from harness.kernels.solve import Scales
from harness.model.experiments import DRIVEN, LARGER, SLOW
from harness.model.registry import TERMS

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
_ALONG_THE_WAY = "strokes from other places: what hangs on the place stays where it is"
_APART = 0.5
"""Of what a model leaves now, from which a difference is worth a recording; it moves no verdict."""


@dataclass(frozen=True, slots=True)
class Open:
    """Two models that a recording does not tell apart, and their names."""

    names: tuple[str, str]
    family: str
    first: Fit
    rival: Fit | None


def _told(name: str, other: str) -> str | None:
    """What an entry of one name says of how it is told from another."""
    return next((t.told_from[other] for t in TERMS if t.name == name and other in t.told_from), None)


def left_open(mechanisms: Sequence[Mechanism], found: Search) -> Open | None:
    """A term of the chosen model and the first that could stand in its place; None where nothing is open."""
    if len(mechanisms) > 1 and mechanisms[0].grade is Grade.ONE_OF:
        first, other = mechanisms[0], mechanisms[1].name
        best = next((f for f in (*found.rivals, *found.singles) if key_of(f) == (other,)), None)
        return Open((first.name, other), first.entry.term.family, found.chosen, best)
    for m in mechanisms:
        if m.alternatives:
            other = m.alternatives[0].name
            kept = sorted([*(n for n in key_of(found.chosen) if n != m.name), other])
            rival = next((f for f in found.rivals if sorted(key_of(f)) == kept), None)
            return Open((m.name, other), m.entry.term.family, found.chosen, rival)
    return None


def left_open_by_grade(mechanisms: Sequence[Mechanism], graded: Graded) -> Open | None:
    """The first two names of a list, or a main effect and the first that could stand in its place."""
    if not mechanisms:
        return None
    first = mechanisms[0]
    others = [a.name for a in first.alternatives]
    if first.grade is Grade.ONE_OF:
        others = [m.name for m in mechanisms[1:] if m.grade is Grade.ONE_OF]
    if not others:
        return None
    fits = {f.name: f.fit for f in graded.finalists}
    return Open((first.name, others[0]), first.entry.term.family, fits[first.name], fits.get(others[0]))


def next_experiment(found: Open | None, problem: Problem, scales: Scales) -> str:
    """A sentence, empty when nothing is open."""
    if found is None:
        return ""
    name, other = found.names
    told = _told(name, other) or _told(other, name)
    if "driven" in problem.given:
        return f"To tell {name} from {other}: {DRIVEN[told] if told else _DRIVEN[found.family]}."
    advice = told or _BY_FAMILY[found.family]
    if found.family == "sensor":
        return f"To tell {name} from {other}: {LARGER if {'x', 'a'} <= set(problem.channels) else advice}."
    far = _by_release(found, problem, scales)
    return f"To tell {name} from {other}: {far or advice}."


def to_be_sure(mechanisms: Sequence[Mechanism], rules: Sequence[Rule], driven: bool) -> str:
    """What would make sure of a law that is most likely: a sentence, empty where it is sure or others are listed.

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
        advice = _ALONG_THE_WAY
    else:
        advice = (_DRIVEN if driven else _BY_FAMILY)[term.family]
    return f"To be sure of {listed[0].name}: {advice}."


def _by_release(found: Open, problem: Problem, scales: Scales) -> str:
    """From how far to let go for the two to part; "" where no other amplitude parts them, or nothing lets go."""
    one_clock = any("one-clock" in e.term.needs for f in (found.first, found.rival) if f for e in f.model.terms)
    if found.rival is None or one_clock or "driven" in problem.given or problem.covariates:
        return ""
    each = releases(under(found.first, problem), under(found.rival, problem), problem, scales)
    unit = "rad" if problem.angular else "m"
    told = [one for one in (_best(each, larger=True), _best(each, larger=False)) if one is not None]
    told.sort(key=lambda one: -one.apart)
    if not told:
        return ""
    said = " or ".join(f"from {one.amplitude:.2g} {unit} ({_apart(one)})" for one in told)
    return f"let it go {said}, and diagnose both recordings with --together"


def _best(each: Sequence[Release], larger: bool) -> Release | None:
    side = [one for one in each if (one.factor > 1.0) is larger and one.apart >= _APART]
    return side[0] if side else None


def _apart(one: Release) -> str:
    # two figures, and no power of ten however many times it is
    apart = f"{float(f'{one.apart:.2g}'):.12g}"
    return f"{one.factor:.2g} times as far, where the two differ by {apart} times what is left now"
