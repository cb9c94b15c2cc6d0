"""Where a wave takes most of what is left of a fitted force: along the travel, in time, and of friction in time.

A wave passes the filter and the noise of the force before it is looked for (a matched filter): a slow pass shows one of
which a fast pass, smoothed and shaken by a differentiated encoder, says nothing.
"""

import math
from collections.abc import Iterator

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.measured import BLOCK
from harness.fit.series import PER_CYCLE, peaks, spectrum

_LONGEST, _SHORTEST = 1.5, 400.0
"""Cycles of a wave over the travel, from which to which one is looked for."""
_SLOWEST, _BLOCKS = 0.5, 2.0
"""Cycles of a wave over the recording, and blocks of a cycle, that are the least."""
_PLACES = 24
"""Numbers of cycles, each the same times the one before, at which it is worked out what a wave shows of itself."""
_LEAST_SHOWN = 1e-4
"""Of what the wave that shows most does."""
_MOST = 24
"""Waves of a kind that are tried: they bound the work."""
_MOST_PERIODS = 9
"""The same along the travel."""


def along_travel(problem: InverseDynamics, residual: FloatArray) -> list[float]:
    """Periods, m, of a force along the travel, by what each takes of a residual (m,), whitened."""
    x = problem.measured.x
    return list(_waves(problem, residual, x, np.ones(x.size), _LONGEST, _SHORTEST))[:_MOST_PERIODS]


def in_time(problem: InverseDynamics, residual: FloatArray, of_friction: bool) -> FloatArray:
    """Angular frequencies (k,), rad/s, of a force, or of one that turns round with the motion, in the same way."""
    seen = problem.measured
    size = np.sign(seen.v) if of_friction else np.ones(seen.t.size)
    most = max(seen.t.size / BLOCK / _BLOCKS, 2.0 * _SLOWEST)
    periods = list(_waves(problem, residual, seen.t, size, _SLOWEST, most))[:_MOST]
    return 2.0 * math.pi / np.array(periods)


def _waves(
    problem: InverseDynamics, residual: FloatArray, along: FloatArray, size: FloatArray, fewest: float, most: float
) -> Iterator[float]:
    """Lengths of waves of a size (n,), N, along places or times (n,), from so many cycles to so many.

    Those that take more of a residual (m,) than their neighbours, first the one that takes most.
    """
    span = float(np.ptp(along))
    taken = spectrum(along, problem.counted(residual) * size, fewest, most)
    cycles = fewest + np.arange(taken.size) / PER_CYCLE
    at = np.geomspace(fewest, most, _PLACES)
    angles = 2.0 * np.pi * np.outer(along - along.min(), at) / span
    shown = np.zeros(_PLACES)
    for wave in (np.cos(angles), np.sin(angles)):
        forces = problem.measured.seen(wave * size[:, None])
        shown += np.sum(problem.whitened({"u": forces})["u"] ** 2, axis=0)
    shown = np.maximum(shown, _LEAST_SHOWN * float(np.max(shown)))
    gain = taken / np.exp(np.interp(np.log(cycles), np.log(at), np.log(shown)))
    yield from (span / float(cycles[i]) for i in peaks(gain))
