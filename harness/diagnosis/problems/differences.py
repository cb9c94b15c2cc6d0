"""Differences of a sampled motion, and of the force that acts between the samples as they show it.

A force that jumps or bends between two samples is not what it is at either: the differences of a motion are means of it
over the intervals that they span, which are taken of what it adds up to, so that both sides are the same means.
"""

import numpy as np
from scipy.sparse import csr_array, diags_array

from harness.core.arrays import FloatArray
from harness.kernels.solve import Drive


def sloped(t: FloatArray) -> csr_array:
    """Slope at each time t (n,) by those beside it, (n, n); one-sided at the ends."""
    width = np.diff(t)
    to_left = width[1:] / (width[:-1] + width[1:])
    before = np.concatenate(([0.0], to_left, [1.0]))
    below, above = -before[1:] / width, (1.0 - before[:-1]) / width
    main = np.append(0.0, -below) - np.append(above, 0.0)
    return csr_array(diags_array([below, main, above], offsets=[-1, 0, 1]))


_EVEN = 2.0
"""How unlike two neighbouring intervals may be for a parabola to be laid through their ends."""


def spanned(t: FloatArray, of: str, *, smooth: bool = False) -> csr_array:
    """What the differences of a motion at times t (n,), s, show of a force that is known there, (n, n): of "x" two, of
    "v" one, each a mean over the intervals that it spans, between which the force is straight.

    smooth : that it bends there as a parabola does (Simpson's rule), which what jumps does not.
    """
    width = np.diff(t)
    own = np.concatenate(([0.0], width)) + np.concatenate((width, [0.0]))
    before, after = np.concatenate(([0.0], width)) / own, np.concatenate((width, [0.0])) / own
    main, below, above = (before + after) / 2.0, before[1:] / 2.0, after[:-1] / 2.0
    if smooth:
        ratio = width[1:] / width[:-1]
        at = 1 + np.flatnonzero((ratio < _EVEN) & (ratio > 1.0 / _EVEN))
        ratio = ratio[at - 1]
        main[at] = (2.0 + ratio + 1.0 / ratio) / 6.0
        below[at - 1], above[at] = (2.0 - ratio) / 6.0, (2.0 - 1.0 / ratio) / 6.0
    once = csr_array(diags_array([below, main, above], offsets=[-1, 0, 1]))
    return once if of == "v" else csr_array(once @ once)


def felt(drive: Drive, t: FloatArray, of: str) -> FloatArray:
    """The force (n,), N, as the differences of a motion at times t (n,), s, show it: of "x" two, of "v" one."""
    usual = float(np.mean(drive.u))
    width, over = np.diff(drive.t), drive.u - usual
    slope = np.zeros_like(over) if drive.held else np.append(np.diff(over) / width, 0.0)
    speed = _sum(width * (over[:-1] + width * slope[:-1] / 2.0))
    way = _sum(width * (speed[:-1] + width * (over[:-1] / 2.0 + width * slope[:-1] / 6.0)))
    i = np.maximum(np.searchsorted(drive.t, t, side="right") - 1, 0)
    s = t - drive.t[i]
    slope = np.where(s > 0.0, slope[i], 0.0)
    if of == "v":
        return np.asarray(usual + sloped(t) @ (speed[i] + s * (over[i] + s * slope / 2.0)))
    way = way[i] + s * (speed[i] + s * (over[i] / 2.0 + s * slope / 6.0))
    return np.asarray(usual + sloped(t) @ (sloped(t) @ way))


def _sum(steps: FloatArray) -> FloatArray:
    return np.concatenate(([0.0], np.cumsum(steps)))
