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
