"""What readings of a sensor that counts say of their own."""

import numpy as np

from harness.core.arrays import FloatArray

_MANY = 3
"""Readings that are alike, one after another, from which on they are one word."""
_STANDS = 12
"""The same where readings go to and fro, which noise makes them do without a turn."""


def words(y: FloatArray) -> FloatArray:
    """Weights (n,) of readings: of three or more that are the same, one after another, the middle alone counts.

    Rounded alike, they are one word. In the middle it errs least where the sensor passes by, by less than the mean of
    as many roundings would, and counts as that; at either end it is half a step off. Where the sensor turns round or
    stands it may be half a step off anywhere, and counts as one; short runs that follow one another to and fro are
    noise, whose readings are words of their own.
    """
    first = np.flatnonzero(np.concatenate(([True], y[1:] != y[:-1])))
    size = np.diff(np.concatenate((first, [y.size])))
    step = np.sign(np.diff(y[first]))
    passes = np.zeros(size.size, dtype=np.bool_)
    passes[1:-1] = step[1:] == step[:-1]
    # an end of the recording is as good as a neighbour that passes
    beside = np.concatenate(([True], passes, [True]))
    turns = beside[:-2] & beside[2:] | (size >= _STANDS)
    weight = np.ones(y.size)
    for run in np.flatnonzero((size >= _MANY) & (passes | turns)):
        begin, n, worth = first[run], size[run], size[run] if passes[run] else 1.0
        middle = slice(begin + (n - 1) // 2, begin + n // 2 + 1)
        weight[begin : begin + n] = 0.0
        weight[middle] = np.sqrt(worth / (middle.stop - middle.start))
    return weight
