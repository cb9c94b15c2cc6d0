"""The motion behind a residual: from a model, or from recorded channels alone."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.model.model import ModelTerm
from harness.model.term import Place, Seen

_SMOOTH = 1.0 / 12.0
"""Of a period: running means of it lose 1 % of a sine, and noise more."""
_REST = 0.3
"""Periods of standing still from which it is a rest: a turning point is slow for 0.002 of one."""
_SLOW = 5e-3
"""Of the largest speed: slower is standing still."""
_LINE = 3
"""Samples that a slope needs."""


@dataclass(frozen=True, slots=True)
class Motion:
    """Where the slider was: x (m or rad), v, each (n,); stuck (n,); omega of the swing, rad/s."""

    x: FloatArray
    v: FloatArray
    stuck: BoolArray
    omega: float


def running(y: FloatArray, width: int) -> FloatArray:
    """Mean of y (n,) over ``width`` samples (odd) around each; shorter at the ends."""
    half, i = width // 2, np.arange(y.size)
    total = np.concatenate(([0.0], np.cumsum(y)))
    lo, hi = np.maximum(i - half, 0), np.minimum(i + half + 1, y.size)
    mean: FloatArray = (total[hi] - total[lo]) / (hi - lo)
    return mean


def _slope(t: FloatArray, y: FloatArray, width: int) -> FloatArray:
    """Slope of the straight line through ``width`` samples around each, by running sums."""
    if width < _LINE:
        return np.gradient(y, t)
    s = t - t[0]
    ms, my = running(s, width), running(y, width)
    slope: FloatArray = (running(s * y, width) - ms * my) / np.maximum(running(s * s, width) - ms * ms, 1e-300)
    return slope


def _integral(t: FloatArray, y: FloatArray, period: float) -> FloatArray:
    """Running integral without its drift."""
    total = np.concatenate(([0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(t))))
    width = max(3, round(period / float(np.median(np.diff(t)))) | 1)
    drift = running(running(total, width), width) if y.size > 2 * width else np.full(y.size, total.mean())
    return total - drift


def motion_of(t: FloatArray, channels: Mapping[str, FloatArray], omega: float) -> Motion:
    """Position and speed from whatever was recorded of x, v, a (n,) at t, s: smoothed, good enough to say where.

    omega : of the swing, rad/s.
    """
    period = 2.0 * math.pi / omega
    width = max(1, int(_SMOOTH * period / float(np.median(np.diff(t)))) | 1)
    if "x" in channels:
        x = channels["x"]
        v = channels["v"] if "v" in channels else _slope(t, x, width)
        x = running(x, width) if width > _LINE else x
    else:
        v = channels["v"] if "v" in channels else _integral(t, channels["a"], period)
        x = _integral(t, v, period)
    # stretches longer than a third of a period without speed to speak of
    slow = np.abs(v) < _SLOW * np.max(np.abs(v))
    edges = np.diff(np.concatenate(([0], slow.astype(np.int8), [0])))
    stuck = np.zeros(t.size, dtype=np.bool_)
    for lo, hi in zip(np.flatnonzero(edges == 1), np.flatnonzero(edges == -1), strict=True):
        stuck[lo:hi] = t[hi - 1] - t[lo] > _REST * period
    return Motion(x, v, stuck, omega)


def place_of(entry: ModelTerm, found: Fit, problem: Problem, omega: float) -> Place:
    """Where a term of a fitted model acts; omega in rad/s."""
    return entry.term.place(entry.values, Seen(problem.t, found.shown.x, found.shown.y, omega))
