"""What of a motion is drawn: fewer samples for the eye, and its distance from another motion."""

from collections.abc import Sequence

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
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


def position_at(reference: Trajectory, t: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Position of ``reference`` at other times, m, and which of the times it covers.

    Cubic Hermite interpolation from x and v: exact at its own samples, off by order h^4 between them and by at most
    h^2/8 times the jump of acceleration in the interval that holds a reversal.
    """
    covered = (t >= reference.t[0]) & (t <= reference.t[-1])
    i = np.clip(np.searchsorted(reference.t, t, side="right") - 1, 0, len(reference) - 2)
    h = reference.t[i + 1] - reference.t[i]
    s = (t - reference.t[i]) / h
    x0, x1, v0, v1 = reference.x[i], reference.x[i + 1], reference.v[i] * h, reference.v[i + 1] * h
    rise = x1 - x0
    inside = x0 + s * (v0 + s * (3.0 * rise - 2.0 * v0 - v1 + s * (v0 + v1 - 2.0 * rise)))
    return np.where(s == 1.0, x1, inside), covered


def position_error(t: FloatArray, x: FloatArray, reference: Trajectory) -> FloatArray:
    """Positions ``x`` at times ``t`` minus the reference's, m, shape (n,); nan where the reference does not reach."""
    exact, covered = position_at(reference, t)
    return np.where(covered, x - exact, np.nan)
