"""How long a series remembers, and what repeats along a travel.

Its integrated autocorrelation time, and whether it is long enough to tell; the spectrum of values over places, by sums
over short ones, linear in the samples.
"""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray, IntArray

_LONGEST = 0.1
"""Share of the values over which memory is looked for."""
ENOUGH = 50.0
"""Autocorrelation times that a series must last for the estimate to be trusted (Foreman-Mackey et al. 2013, emcee)."""


@dataclass(frozen=True, slots=True)
class Memory:
    """time : integrated autocorrelation time, in values, at least 1. size : values."""

    time: float
    size: int

    @property
    def independent(self) -> float:
        """How many independent values the series counts as."""
        return self.size / self.time

    @property
    def too_short(self) -> bool:
        """Whether the series is too short for its autocorrelation time to be trusted: the true one may be longer."""
        return self.independent < ENOUGH


def lagged(series: FloatArray, size: int) -> FloatArray:
    """Sums of products of a series (n,) with itself some values later, (size,), for each lag from none on.

    size : lags, at least n. Over as many values more that are none, so that the end does not meet the beginning.
    """
    return np.fft.irfft(np.abs(np.fft.rfft(series, 2 * size)) ** 2)[:size]


def memory(series: FloatArray, longest: int | None = None, begins: tuple[int, ...] = ()) -> Memory:
    """Memory of a series (n,) of mean zero: pairs of lags are summed up to the first without any (Geyer 1992).

    longest : lags looked at, by default a tenth of the values. begins : of further series laid behind the first, none
    of which remembers the one before.
    """
    size = series.size
    apart = np.split(series, begins) if begins else [series]
    products = np.asarray(sum(lagged(own, size) for own in apart))
    products = products[: max(int(_LONGEST * size) if longest is None else longest + 1, 2)]
    if products[0] <= 0.0:
        return Memory(1.0, size)
    share = products / products[0]
    # in pairs, as a noisy correlation swings about zero
    pairs = share[1 : 2 * ((share.size - 1) // 2) + 1].reshape(-1, 2).sum(axis=1)
    ends = np.flatnonzero(pairs <= 0.0)
    return Memory(max(1.0, 1.0 + 2.0 * float(np.sum(pairs[: ends[0] if ends.size else pairs.size]))), size)


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
