"""Where a sampled signal crosses zero, and how high it rises."""

import numpy as np

from harness.core.arrays import FloatArray


def falling(t: FloatArray, y: FloatArray) -> FloatArray:
    """Times at which y goes from above 0 to 0 or below, by linear interpolation."""
    i = np.flatnonzero((y[:-1] > 0.0) & (y[1:] <= 0.0))
    found: FloatArray = t[i] + y[i] * (t[i + 1] - t[i]) / (y[i] - y[i + 1])
    return found


def highest(y: FloatArray) -> float:
    """Largest value of evenly sampled y, by a parabola through the largest sample and its neighbours."""
    i = int(np.argmax(y))
    if i in (0, y.size - 1):
        return float(y[i])
    before, at, after = (float(value) for value in y[i - 1 : i + 2])
    bend = before - 2.0 * at + after
    return at if bend >= 0.0 else at - 0.125 * (after - before) ** 2 / bend
