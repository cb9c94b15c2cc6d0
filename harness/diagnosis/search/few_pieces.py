"""The force of a driven recording in few straight pieces, for first looks.

An integrator stops wherever a force bends, at every sample and between them; the slider, two integrations behind, feels
nothing of what a force does within a small part of its cycle. So the force is projected on few knots, and what that
changes of the motion is put on the recording, so that a fitted model leaves what it left.

A long recording in few samples, for first looks: means of what a model leaves, added to what it shows.

A thinned recording throws away most of what it says. What a fitted model leaves over is slow beside the motion, so that
its means over short groups of samples keep nearly all of it, at the noise of a mean.
"""

import math
from contextlib import suppress
from dataclasses import replace

import numpy as np
from scipy.linalg import solveh_banded

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Observation, P
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.starts import OneStart
from harness.kernels.solve import Drive, Scales
from harness.model.model import Model

_PER_CYCLE = 24
"""Groups a cycle is given at least: the third harmonic then keeps 96 % of its height."""


def condensed(problem: P, shown: Observation, samples: int, omega: float) -> tuple[P, float]:
    """A problem of about this many samples, and by how much its chi-square falls short of the whole one's.

    shown : what a model fitted to ``problem`` shows. omega : rad/s.
    """
    n = problem.t.size
    cycles = omega * float(problem.t[-1] - problem.t[0]) / (2.0 * math.pi)
    size = int(n // max(samples, _PER_CYCLE * cycles))
    return (problem, 1.0) if size <= 1 else problem.condensed(shown.y, size)


_PIECES = (40, 80, 160)
"""A cycle, tried one after another."""
_FEWER = 2.0
"""Times fewer pieces, from which it is worth the looks."""
_CHANGED = 0.03
"""Of displacement and of speed, rms: what fewer pieces may change. First looks are to first order, no closer."""
_EMPTY = 1e-12
"""Weight, of that of a knot with samples on both sides, that holds a knot without any."""


def for_looks(current: Fit, problem: P, scales: Scales, samples: int) -> tuple[P, float]:
    """A problem of about this many samples, its force in few pieces, and by how much its chi-square falls short.

    current : fitted to ``problem``. Itself where a look is no simulation.
    """
    if not problem.simulated:
        return problem, 1.0
    small = _first_cycles(problem, current.shown, samples, scales.omega)
    scale_up = problem.points / small.points
    if small is problem:
        small, scale_up = condensed(problem, current.shown, samples, scales.omega)
    return in_few_pieces(small, current.model, scales), scale_up


def _first_cycles(problem: P, shown: Observation, samples: int, omega: float) -> P:
    """The first part of a driven motion of more cycles than so many samples can show; itself where they can.

    It holds as much of the motion's squares as of the cycles may be shown: a motion may begin with a rest, or grow.
    """
    cycles = omega * float(problem.t[-1] - problem.t[0]) / (2.0 * math.pi)
    if _PER_CYCLE * cycles <= samples or "driven" not in problem.given or not isinstance(problem.starts, OneStart):
        return problem
    held = np.cumsum((shown.x - np.mean(shown.x)) ** 2)
    return problem.part(slice(0, int(np.searchsorted(held, samples / (_PER_CYCLE * cycles) * held[-1])) + 1))


def in_few_pieces(problem: P, model: Model, scales: Scales) -> P:
    """The same with a force of fewer pieces, under which ``model`` leaves what it leaves of the recording.

    Itself where no force acts, where fewer pieces would not do, and where the model cannot be followed.
    """
    with suppress(SimulationError):
        return _in_few_pieces(problem, model, scales)
    return problem


def _in_few_pieces(problem: P, model: Model, scales: Scales) -> P:
    drive = None if problem.drive is None else problem.drive.straight
    if drive is None or problem.alone:
        return problem
    cycles = scales.omega * float(drive.t[-1] - drive.t[0]) / (2.0 * math.pi)
    whole: Observation | None = None
    for pieces in _PIECES:
        count = math.ceil(pieces * cycles) + 1
        if drive.t.size < _FEWER * count or count < 2:
            break
        if whole is None:
            whole = observe(model, problem, (), scales, COARSE)
        few = replace(problem, drive=projected(drive, count))
        seen = observe(model, few, (), scales, COARSE)
        if all(
            np.std(one - other) <= _CHANGED * np.std(other) for one, other in ((seen.x, whole.x), (seen.v, whole.v))
        ):
            return replace(few, channels={c: y + seen.y[c] - whole.y[c] for c, y in problem.channels.items()})
    return problem


def projected(drive: Drive, count: int) -> Drive:
    """A force in straight pieces between ``count`` even knots: the nearest one, by its mean square over time."""
    begin, end = float(drive.t[0]), float(drive.t[-1])
    place = (drive.t - begin) * ((count - 1) / (end - begin))
    left = np.minimum(place.astype(np.int64), count - 2)
    share = place - left
    weight = np.gradient(drive.t)
    bands = np.zeros((2, count))
    by = np.zeros(count)
    for knot, own in ((left, 1.0 - share), (left + 1, share)):
        bands[1] += np.bincount(knot, weight * own**2, count)
        by += np.bincount(knot, weight * own * drive.u, count)
    bands[0, 1:] = np.bincount(left, weight * share * (1.0 - share), count)[:-1]
    bands[1] += _EMPTY * float(np.max(bands[1]))
    found: FloatArray = solveh_banded(bands, by)
    return Drive(np.linspace(begin, end, count), found)
