"""Peaks of a spectrum."""

import numpy as np

from harness.core.arrays import FloatArray, IntArray


def peaks(power: FloatArray) -> IntArray:
    """Indices (k,) of the local maxima of a spectrum (n,), strongest first; its ends are none."""
    inner = power[1:-1]
    tops = np.flatnonzero((inner > power[:-2]) & (inner >= power[2:])) + 1
    strongest: IntArray = tops[np.argsort(power[tops])[::-1]]
    return strongest
