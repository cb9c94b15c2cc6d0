"""What repeats along a travel: the spectrum of values over places, by sums over short ones, linear in the samples."""

import numpy as np

from harness.core.arrays import FloatArray, IntArray

PER_CYCLE = 4
"""Frequencies tried per one over the travel."""
_PLACES, _PER_PERIOD = 1 << 13, 20
"""Places over the travel at least, and to the shortest period."""


def peaks(power: FloatArray) -> IntArray:
    """Indices (k,) of the local maxima of a spectrum (n,), strongest first; its ends are none."""
    inner = power[1:-1]
    tops = np.flatnonzero((inner > power[:-2]) & (inner >= power[2:])) + 1
    strongest: IntArray = tops[np.argsort(power[tops])[::-1]]
    return strongest


def standing_out(x: FloatArray, y: FloatArray, fewest: float, most: float) -> list[float]:
    """Periods (m) at which y (n,) stands out over places x (n,), strongest first, in a number of cycles from .. to."""
    travel = float(np.ptp(x))
    power = spectrum(x, y - float(np.mean(y)), fewest, most)
    return [travel / (fewest + i / PER_CYCLE) for i in peaks(power).tolist()]


def spectrum(x: FloatArray, y: FloatArray, fewest: float, most: float) -> FloatArray:
    """Squared amplitude from the fewest to the most cycles over the travel."""
    travel = float(np.ptp(x))
    places = max(_PLACES, int(_PER_PERIOD * most))
    place = np.minimum(((x - x.min()) / travel * places).astype(np.int64), places - 1)
    sums = np.bincount(place, y, places)
    power: FloatArray = np.abs(np.fft.rfft(sums, PER_CYCLE * places)) ** 2
    return power[round(fewest * PER_CYCLE) : round(most * PER_CYCLE)] * (2.0 / x.size) ** 2
