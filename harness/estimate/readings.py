"""What readings of a sensor that counts say of their own."""

import math

import numpy as np

from harness.core.arrays import FloatArray

_MANY = 3
"""Readings that are alike, one after another, from which on they are one word."""
_BY_NOISE = 0.01
_STANDS = 1 + math.ceil(math.log(_BY_NOISE) / math.log(math.erf(math.sqrt(1.5))))
"""The same where noise brings others to either side: beside noise as large as the rounding, of variance step^2/12, a
reading in the middle of its step is followed by another such one with erf(sqrt(3/2)) = .92, so that one run in a
hundred is as long."""


def words(y: FloatArray) -> FloatArray:
    """Weights (n,) of readings: of three or more that are the same, one after another, the middle alone counts.

    Rounded alike, they are one word. In the middle it errs least where the sensor passes by, by less than the mean of
    as many roundings would, and counts as that, less what a change of speed on the way shifts the middle by; at either
    end it is half a step off. Where the sensor turns round or stands it may be half a step off anywhere, and counts as
    one. Beside short runs to and fro it is noise that brings the readings, each a word of its own.
    """
    first = np.flatnonzero(np.concatenate(([True], y[1:] != y[:-1])))
    size = np.diff(np.concatenate((first, [y.size])))
    step = np.sign(np.diff(y[first]))
    passes = np.zeros(size.size, dtype=np.bool_)
    passes[1:-1] = step[1:] == step[:-1]
    # an end of the recording is as good a neighbour
    steady = np.concatenate(([True], passes | (size >= _MANY), [True]))
    turns = steady[:-2] & steady[2:] | (size >= _STANDS)
    one = (size >= _MANY) & (passes | turns)
    weight = np.where(np.repeat(one, size), 0.0, 1.0)
    worth, speed = np.ones(size.size), 1.0 / size
    # in steps: a speed that changes evenly from v to v' shifts the middle of a time T by an eighth of T (v - v'); the
    # neighbours are two such times apart, and of what the recording cuts off the speed may be any less
    speed[[0, -1]] = 0.0
    shift = size[1:-1] * (speed[2:] - speed[:-2]) / 16.0
    worth[1:-1] = np.where(passes[1:-1], np.maximum(1.0 / (speed[1:-1] + 12.0 * shift**2), 1.0), 1.0)
    # of an even run both in the middle, each half a sample early or late
    share = np.sqrt(worth / (2.0 - size % 2))
    for middle in (first + (size - 1) // 2, first + size // 2):
        weight[middle[one]] = share[one]
    return weight
