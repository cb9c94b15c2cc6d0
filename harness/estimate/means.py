"""Means of neighbours, for a channel of far more samples than its motion needs: they say as much of what is slow.

What looks at every sample itself is what one sample can change: the end of a sensor's range, samples that stray, and
the samples beside a reversal.
"""

import numpy as np

from harness.core.arrays import FloatArray
from harness.estimate.noise import Noise

ENOUGH, FINISHED = 100_000, 1024
"""Means that a channel keeps at least, and those of a half-cycle where it is known."""
_NOISE, _SMOOTH = 1.1, 1e-3
"""Samples half way between kept ones may lie off the line between these by so many times what neighbours do, or by so
much of what the channel moves: there are 70 a period then."""


def is_dense(y: FloatArray, size: int) -> bool:
    """Whether samples of y (n,) between each ``size``-th lie on the line between those, but for the noise."""
    next_to, between = (_off(y, lag) for lag in (1, max(size // 2, 1)))
    return bool(between**2 <= (_NOISE * next_to) ** 2 + (_SMOOTH * float(np.std(y))) ** 2)


def _off(y: FloatArray, lag: int) -> float:
    """How far samples lie off the middle of two neighbours ``lag`` away: all but one in a hundred, next to a jump."""
    every = max(y.size // ENOUGH, 1)
    before, at, after = (y[first : y.size - 2 * lag + first : every] for first in (0, lag, 2 * lag))
    return float(np.quantile(np.abs(at - 0.5 * (before + after)), 0.99))


def means(y: FloatArray, size: int) -> FloatArray:
    """Of each ``size`` neighbours of y (n,), (n // size,); the last ones that are fewer are not counted."""
    return y if size < 2 else np.asarray(y[: y.size // size * size].reshape(-1, size).mean(axis=1), dtype=np.float64)


def in_means(t: FloatArray, y: FloatArray, noise: Noise) -> tuple[FloatArray, FloatArray, Noise]:
    """A channel y (n,) at t (n,), s, and its noise; in means where its samples are many and dense."""
    size = y.size // ENOUGH
    if size < 2 or not is_dense(y, size):
        return t, y, noise
    return means(t, size), means(y, size), noise.of_means(size)
