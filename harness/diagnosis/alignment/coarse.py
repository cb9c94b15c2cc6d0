"""Where two traces may lie over each other: every shift at once, by sums of products over bins of time."""

import math
from collections.abc import Mapping

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.diagnosis.alignment.pair import Signals
from harness.estimate.noise import Noise

BINS = 40
"""Bins a period: two curves half a bin apart differ by 0.3 % of their power."""
_MOST_BINS = 4_000_000
"""Bounds the memory of the transforms: 32 MB a channel."""
_LEAST_SHARED = 0.15
"""Share of the shorter trace that must lie over the other."""
_CANDIDATES = 9
"""Shifts that are refined: bounds the work."""
_APART = 0.3
"""Share of a period between candidates."""


def candidates(first: Signals, second: Signals, noise: Mapping[str, Noise], period: float) -> list[float]:
    """Shifts (s, of the first's times) at which the traces differ least, the best first.

    A shift saves n log((s^2 + e) / (s0^2 + e)) a channel: n bins overlap, s^2 is the mean square difference, offset
    apart, s0^2 that of two strangers with the variances seen there, e the noise of a bin. So a long overlap is worth as
    much as a close one, and two traces at rest, or hiding from each other, are worth nothing.
    Raises InputError for traces too long for their period.
    """
    width = period / BINS
    total = sum(float(one.t[-1] - one.t[0]) for one in (first, second)) / width
    if total > _MOST_BINS:
        found = f"{total / BINS:.3g} periods that the shift may be anywhere in"
        accepted = f"traces of at most {_MOST_BINS / BINS:.0e} periods together are accepted"
        raise InputError("time alignment", found, accepted)
    # imported when it is needed: it brings half of its library along
    from scipy.signal import correlate

    sizes = [max(int((one.t[-1] - one.t[0]) / width), 1) for one in (first, second)]
    lags = np.arange(1 - sizes[0], sizes[1])
    low, high = np.maximum(0, -lags), np.minimum(sizes[0], sizes[1] - lags)
    count = (high - low).astype(np.float64)
    saved = np.zeros(lags.size)
    for c, level in noise.items():
        f, y = (_binned(one.t, one.channels[c], width, n) for one, n in zip((first, second), sizes, strict=True))
        middle, size = 0.5 * (f.mean() + y.mean()), math.sqrt(0.5 * (f.var() + y.var())) or 1.0
        f, y = (f - middle) / size, (y - middle) / size
        sums = [_between(values, low + d, high + d) for values, d in ((f, 0), (y, lags), (f * f, 0), (y * y, lags))]
        product = correlate(y, f, method="fft")
        strangers = sums[2] + sums[3] - (sums[0] ** 2 + sums[1] ** 2) / count
        apart = sums[2] + sums[3] - 2.0 * product - (sums[0] - sums[1]) ** 2 / count
        interval = max(float(np.median(np.diff(one.t))) for one in (first, second))
        e = count * ((level.sigma / size) ** 2 * min(1.0, interval / width) + 1e-6)
        saved += count * np.log((np.maximum(apart, 0.0) + e) / (np.maximum(strangers, 0.0) + e))
    least = max(_LEAST_SHARED * min(sizes), min(BINS, *sizes))
    saved[count < least] = math.inf
    shifts = np.asarray(float(second.t[0] - first.t[0]) + lags * width, dtype=np.float64)
    return _lowest(shifts, saved, _APART * period)


def _binned(t: FloatArray, y: FloatArray, width: float, count: int) -> FloatArray:
    """Means (count,) of a channel over bins, from its first sample on."""
    area = np.concatenate([[0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(t))])
    return np.asarray(np.diff(np.interp(t[0] + width * np.arange(count + 1), t, area)) / width)


def _between(values: FloatArray, low: np.ndarray, high: np.ndarray) -> FloatArray:
    """Sums of values[low:high] for many ranges."""
    total = np.concatenate([[0.0], np.cumsum(values)])
    return np.asarray(total[high] - total[low])


def _lowest(shifts: FloatArray, saved: FloatArray, apart: float) -> list[float]:
    """The lowest places of a curve that are no neighbours."""
    padded = np.concatenate([[math.inf], saved, [math.inf]])
    dips = np.flatnonzero((saved <= padded[:-2]) & (saved <= padded[2:]) & np.isfinite(saved))
    found: list[float] = []
    for i in dips[np.argsort(saved[dips], kind="stable")]:
        if all(abs(shifts[i] - one) > apart for one in found):
            found.append(float(shifts[i]))
        if len(found) == _CANDIDATES:
            break
    return found
