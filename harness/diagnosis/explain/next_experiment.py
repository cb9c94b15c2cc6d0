"""From how far to let go, so that two laws which follow a recording alike no longer do.

Both fitted models are run from other amplitudes. What one shows of a release is given to the other to follow: its
start is free, and its parameters too as far as the recordings at hand leave them free. What it cannot follow, over what
the first leaves now, says how far the two are apart there.
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit, whitened
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.outcome import Grade, Mechanism
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.search.extend import key_of
from harness.diagnosis.search.search import Search
from harness.diagnosis.starts import OneStart
from harness.kernels.solve import By, Scales
from harness.model.elsewhere import parted
from harness.model.model import Model, Restoring

_FACTORS = (0.25, 0.35, 0.5, 0.7, 1.4, 2.0)
"""Amplitudes that are tried, over the largest at hand: what a rig that was let go from there can mostly do."""
_HIGHEST = 2.6
"""rad: from where a pendulum is let go at most; near the top it hardly falls."""
_STARTS = ("x0", "v0", "offset")
_SAMPLES = 1500
"""Samples that are looked at: they bound the work."""


@dataclass(frozen=True, slots=True)
class Open:
    """Two models that a recording does not tell apart, and their names."""

    names: tuple[str, str]
    family: str
    first: Fit
    rival: Fit | None


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
    listed = [m.name for m in mechanisms[1:] if m.grade is Grade.ONE_OF]
    others = listed if first.grade is Grade.ONE_OF else [a.name for a in first.alternatives]
    if not others:
        return None
    fits = {f.name: f.fit for f in graded.finalists}
    return Open((first.name, others[0]), first.entry.term.family, fits[first.name], fits.get(others[0]))


class Release(NamedTuple):
    """A release. amplitude : m or rad. factor : over the largest at hand. apart : rms between the two laws there, over
    that which the better one leaves now.
    """

    amplitude: float
    factor: float
    apart: float


def releases(first: Fit, rival: Fit, problem: Problem, scales: Scales) -> list[Release]:
    """How far two models are apart at every amplitude that is tried, the furthest first."""
    single = max(problem.alone or (problem,), key=lambda one: float(np.ptp(next(iter(one.channels.values())))))
    thin = single.part(slice(None, None, max(1, single.t.size // _SAMPLES)))
    none = np.zeros(thin.t.size)
    empty = replace(
        thin, t=thin.t - thin.t[0], channels=dict.fromkeys(thin.channels, none), weight={}, starts=OneStart()
    )
    widest = float(np.max(np.abs(first.shown.x)))
    left = math.sqrt(max(first.chi2 / max(first.points - len(first.free), 1), 1.0))
    found = []
    for factor in _FACTORS:
        amplitude = factor * widest
        if first.model.restoring is Restoring.PENDULUM and amplitude > _HIGHEST:
            continue
        there = Scales(scales.x * max(factor, 1.0), scales.v * max(factor, 1.0), scales.omega)
        with suppress(SimulationError):
            squares = _not_followed(_let_go(first.model, amplitude), rival, amplitude, empty, there)
            found.append(Release(amplitude, factor, math.sqrt(max(squares, 0.0) / empty.points) / left))
    return sorted(found, key=lambda one: -one.apart)


def _let_go(model: Model, amplitude: float) -> Model:
    return replace(model.of_recording(0), x0=amplitude, v0=0.0, t0=0.0)


def _not_followed(true: Model, rival: Fit, amplitude: float, empty: Problem, scales: Scales) -> float:
    """Squares, in units of the noise, that the rival leaves of what ``true`` shows, to first order."""
    names = [f.by for f in rival.free]
    starts = [name for name in _STARTS if name != "offset" or any(f.name == "offset" for f in rival.free)]
    # a number of another recording, or of a start at hand, says nothing of the new one
    by: tuple[By, ...] = (*(b for b in names if not _of_a_start(b) and _here(b)), *starts)
    shown = observe(true, empty, (), scales, COARSE)
    other = observe(_let_go(rival.model, amplitude), empty, by, scales, COARSE)
    miss = whitened(empty, {c: shown.y[c] - other.y[c] for c in empty.channels})
    new = whitened(empty, other.dy)
    # numbers of the rival, then the new start's: what is at hand says something of the former alone
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
    return not isinstance(by, str) or parted(by)[1] == 0
