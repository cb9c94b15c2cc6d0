"""The recording that would decide between names that this one leaves open.

From how far to let go, so that two laws which follow this recording alike no longer do.

Both fitted models are run from other amplitudes. What one shows of a release is given to the other to follow: its
start is free, and its parameters too as far as the recordings at hand leave them free. What it cannot follow, over what
the first leaves now, says how far the two are apart there.
"""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, whitened
from harness.diagnosis.fit.observe import COARSE, observe
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.outcome import Grade, Mechanism
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.starts import OneStart
from harness.diagnosis.rules import LEAST_CYCLES, MOST_LIKELY, Rule
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search, under
from harness.kernels.solve import By, Scales
from harness.model.elsewhere import parted
from harness.model.model import Model, Restoring
from harness.model.registry import TERMS
from harness.model.term import DRIVEN, LARGER, SLOW

_FACTORS = (0.25, 0.35, 0.5, 0.7, 1.4, 2.0)
"""Amplitudes that are tried, over the largest at hand: what a rig that was let go from there can mostly do."""
_HIGHEST = 2.6
"""rad: from where a pendulum is let go at most; near the top it hardly falls."""
_STARTS = ("x0", "v0", "offset")
_SAMPLES = 1500
"""Samples that are looked at: they bound the work."""


@dataclass(frozen=True, slots=True)
class Release:
    """A release. amplitude : m or rad. factor : over the largest at hand. apart : rms between the two laws there, over
    that which the better one leaves now.
    """

    amplitude: float
    factor: float
    apart: float


def releases(first: Fit, rival: Fit, problem: Problem, scales: Scales) -> list[Release]:
    """How far two models are apart at every amplitude that is tried, the furthest first."""
    return sorted(_each(first, rival, problem, scales), key=lambda one: -one.apart)


def _each(first: Fit, rival: Fit, problem: Problem, scales: Scales) -> Iterator[Release]:
    single = max(problem.alone or (problem,), key=lambda one: float(np.ptp(next(iter(one.channels.values())))))
    thin = single.part(slice(None, None, max(1, single.t.size // _SAMPLES)))
    none = np.zeros(thin.t.size)
    empty = replace(
        thin, t=thin.t - thin.t[0], channels=dict.fromkeys(thin.channels, none), weight={}, starts=OneStart()
    )
    widest = float(np.max(np.abs(first.shown.x)))
    left = math.sqrt(max(first.chi2 / max(first.points - len(first.free), 1), 1.0))
    for factor in _FACTORS:
        amplitude = factor * widest
        if first.model.restoring is Restoring.PENDULUM and amplitude > _HIGHEST:
            continue
        there = Scales(scales.x * max(factor, 1.0), scales.v * max(factor, 1.0), scales.omega)
        with suppress(SimulationError):
            squares = _not_followed(_let_go(first.model, amplitude), rival, amplitude, empty, there)
            yield Release(amplitude, factor, math.sqrt(max(squares, 0.0) / empty.points) / left)


def _let_go(model: Model, amplitude: float) -> Model:
    return replace(model.of_recording(0), x0=amplitude, v0=0.0, t0=0.0)


def _not_followed(true: Model, rival: Fit, amplitude: float, empty: Problem, scales: Scales) -> float:
    """Squares, in units of the noise, that the rival leaves of what ``true`` shows, to first order."""
    of_all = [f for f in rival.free if not _of_a_start(f.by)]
    starts = [name for name in _STARTS if name != "offset" or any(f.name == "offset" for f in rival.free)]
    by: tuple[By, ...] = (*(f.by for f in of_all if _here(f.by)), *starts)
    shown = observe(true, empty, (), scales, COARSE)
    other = observe(_let_go(rival.model, amplitude), empty, by, scales, COARSE)
    miss = whitened(empty, {c: shown.y[c] - other.y[c] for c in empty.channels})
    new = whitened(empty, other.dy)
    # numbers of the rival, then the new start's: what is at hand says something of the former alone
    names = [f.by for f in rival.free]
    size = len(names) + len(starts)
    place = [names.index(b) if b in names and b not in starts else len(names) + starts.index(str(b)) for b in by]
    normal = np.zeros((size, size))
    normal[: len(names), : len(names)] = rival.jacobian.T @ rival.jacobian
    normal[np.ix_(place, place)] += new.T @ new
    right = np.zeros(size)
    right[place] = new.T @ miss
    scale = np.sqrt(np.maximum(np.diag(normal), 1e-300))
    moved = np.linalg.lstsq(normal / np.outer(scale, scale), right / scale, rcond=1e-12)[0]
    return float(miss @ miss - (right / scale) @ moved)


def _of_a_start(by: By) -> bool:
    return isinstance(by, str) and (parted(by)[0] in _STARTS or ".w" in by or ".z" in by)


def _here(by: By) -> bool:
    """Whether a number acts in a further recording that is as the first."""
    return not isinstance(by, str) or parted(by)[1] == 0


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
