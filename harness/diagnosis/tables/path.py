"""Whether a path through the plane of position and speed comes back, so that a force over it is told from a drift."""

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import PATH_AGAIN, PATH_APART

_CELLS = 8
"""Cells along each side of the plane that was swept."""


def comes_back(t: FloatArray, x: FloatArray, v: FloatArray) -> bool:
    """Whether most of the time is spent in cells that are seen again at clearly different times; each (n,)."""
    return time_again(t, x, v) >= PATH_AGAIN.value


def time_again(t: FloatArray, x: FloatArray, v: FloatArray) -> float:
    """Share of the samples whose cell of the plane is seen at times so far apart; each (n,)."""
    if float(np.ptp(x)) == 0.0 or float(np.ptp(v)) == 0.0:
        return 0.0
    cell = _CELLS * _part(x) + _part(v)
    first, last = np.full(_CELLS**2, np.inf), np.full(_CELLS**2, -np.inf)
    np.minimum.at(first, cell, t)
    np.maximum.at(last, cell, t)
    return float(np.mean((last - first)[cell] >= PATH_APART.value * float(t[-1] - t[0])))


def _part(y: FloatArray) -> IntArray:
    return np.asarray(np.minimum(_CELLS * (y - y.min()) / np.ptp(y), _CELLS - 1), dtype=np.int64)


def returns(problem: Problem, x: FloatArray, v: FloatArray) -> bool:
    """Whether the path of a motion x, v (n,) that is followed comes back: several amplitudes, or a drive that does it.

    A free decay passes each place of the plane once, and two alike pass the same ones.
    """
    if problem.drive is None:
        return problem.parts_amplitude_from_time
    return comes_back(problem.t, x, v)
