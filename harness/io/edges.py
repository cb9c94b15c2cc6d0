"""Counts that were stamped as they changed, as an interrupt does, and not sampled by a clock."""

import numpy as np

from harness.core.arrays import FloatArray

_SAME, _ALL = 0.01, 0.99
"""Share of a step by which its numbers may be rounded, and share of the samples that lie one from the one before."""
_UNEVEN = 0.2
"""Scatter of the intervals, of their mean, from which no clock sampled: counts of a motion that turns."""


def at_edges(t: FloatArray, x: FloatArray) -> FloatArray | None:
    """Places (n - 1,) at times t[1:] of a count x (n,) that each stamp found one step on; None where a clock sampled.

    At its edge an encoder stands half way between the count before and the one that is written: as it stands, the count
    lags behind by half a step to either side, as play would.
    """
    steps, intervals = np.diff(x), np.diff(t)
    size = float(np.median(np.abs(steps))) if steps.size else 0.0
    if size == 0.0 or np.any(steps == 0.0) or not (np.any(steps > 0.0) and np.any(steps < 0.0)):
        return None
    alike = float(np.mean(np.abs(np.abs(steps) - size) < _SAME * size))
    if alike < _ALL or float(np.std(intervals)) < _UNEVEN * float(np.mean(intervals)):
        return None
    found: FloatArray = x[1:] - 0.5 * size * np.sign(steps)
    return found


_STANDS, _FEWEST, _ONE_WAY = 0.5, 50, 0.9
"""Share of samples, at least, at which a count stands as before, edges from which it is read by them, and steps that
are of one tick or two."""


def at_clocked_edges(t: FloatArray, x: FloatArray) -> tuple[FloatArray, FloatArray] | None:
    """Times and places (k,) at which a count x (n,), which a clock sampled at t (n,), s, went on; None where it hardly
    ever stands, goes back, or is no count.

    Half way in time to the sample at which it is first seen, as an encoder of a few marks stands at a mark: between two
    of them the count tells nothing that its edges do not.
    """
    steps = np.diff(x)
    moved = np.flatnonzero(steps != 0.0)
    if moved.size < _FEWEST or moved.size > (1.0 - _STANDS) * steps.size or np.ptp(np.sign(steps[moved])) > 0.0:
        return None
    size = float(np.min(np.abs(steps[moved])))
    ticks = np.abs(steps[moved]) / size
    whole = np.all(np.abs(ticks - np.round(ticks)) < _SAME) and np.mean(ticks < 2.0 + _SAME) >= _ONE_WAY
    if not whole:
        return None
    # of several marks since the last sample, the middle one
    places = x[moved] + 0.5 * (steps[moved] + size * np.sign(steps[moved]))
    return 0.5 * (t[moved] + t[moved + 1]), np.asarray(places, dtype=np.float64)
