"""Fewer samples for the eye, with every sample kept where something happens."""

from collections.abc import Sequence

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.events import EventKind
from harness.core.trajectory import Trajectory

MOST_EVENTS = 64


def reversal_times(trajectory: Trajectory) -> FloatArray:
    """Times at which the speed changes sign, s: exact ones where the source knows them, else between samples.

    At most 64, the first ones: a chattering trace would otherwise ask for every sample.
    """
    if len(trajectory.events):
        return trajectory.events.of(EventKind.REVERSAL, EventKind.STICK).t[:MOST_EVENTS]
    sign = np.sign(trajectory.v)
    at = np.flatnonzero(sign[1:] * sign[:-1] < 0.0)[:MOST_EVENTS]
    before, after = trajectory.v[at], trajectory.v[at + 1]
    return np.asarray(trajectory.t[at] + (trajectory.t[at + 1] - trajectory.t[at]) * before / (before - after))


def keep(t: FloatArray, channels: Sequence[FloatArray], around: FloatArray, budget: int) -> IntArray:
    """Indices of the samples to draw, increasing, about ``budget`` of them at most.

    All samples when they are no more than the budget. Otherwise half of it goes to full resolution around the times
    ``around``, the rest to the smallest and largest value of every channel in equal stretches: no spike is lost.
    """
    n = t.size
    if n <= budget:
        return np.arange(n)
    chosen = np.zeros(n, dtype=bool)
    chosen[[0, -1]] = True
    if around.size:
        half = max(1, budget // (4 * around.size))
        for centre in np.searchsorted(t, around):
            chosen[max(0, centre - half) : centre + half] = True
    stretches = max(1, budget // (4 * max(1, len(channels))))
    edges = np.linspace(0, n, stretches + 1).astype(np.int64)
    length = int(np.diff(edges).max())
    # rows of one length, so that both extremes come from two calls; the last sample pads the short rows
    rows = np.minimum(edges[:-1, None] + np.arange(length), n - 1)
    for values in channels:
        block = values[rows]
        line = np.arange(stretches)
        chosen[rows[line, block.argmin(axis=1)]] = True
        chosen[rows[line, block.argmax(axis=1)]] = True
    return np.flatnonzero(chosen)
