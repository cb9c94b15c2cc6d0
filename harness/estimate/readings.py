"""Which readings of a sensor that counts say something of their own."""

import numpy as np

from harness.core.arrays import BoolArray, FloatArray


def one_word(y: FloatArray) -> BoolArray:
    """Samples (n,) that count: of three or more readings that are the same, one after another, the middle one.

    Rounded alike, they are one word. In the middle it errs least where the sensor passes by; at either end it is half a
    step off.
    """
    first = np.flatnonzero(np.concatenate(([True], y[1:] != y[:-1])))
    last = np.concatenate((first[1:], [y.size])) - 1
    counts = np.zeros(y.size, dtype=np.bool_)
    few = last - first < _MANY
    counts[first[few]] = counts[last[few]] = True
    counts[((first + last) // 2)[~few]] = True
    return counts


_MANY = 2
"""Intervals between readings that are alike, from which on they are one word."""
