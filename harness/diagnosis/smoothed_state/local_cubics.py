"""A channel smoothed by local cubics: value, slope and bend with standard errors, irregular sampling and all.

Products of matrices of three rows and columns, written out: a library's are compiled ten times as long as these.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.special import chdtri

from harness.core.arrays import BoolArray, FloatArray, IntArray, read_only
from harness.core.jit import compiled

_HALF_WIDTHS = (4, 6, 9, 13, 20, 30, 45)
"""Samples to either side, each half again as many: the widest that still follows the motion is taken."""
ALIKE = 1.25
"""By how much a wider cubic may miss more than the narrowest, where only a start depends on it."""
_LOOKED_AT = 4000
"""Places at which that is judged."""
_TERMS = 4
"""Of a cubic."""
_LEAST_PARTS = 4
"""Widths that a recording must hold."""
_BY_CHANCE = 1e-5
"""How often noise alone leaves so much of a cubic that it counts as more."""
GAP = 5.0
"""Sampling intervals from which on there is a gap."""


def longest_interval(t: FloatArray) -> float:
    """Interval, s, beyond which there is a gap in t (n,)."""
    return GAP * float(np.median(np.diff(t)))


@dataclass(frozen=True, slots=True)
class Smooth:
    """Value, slope and second derivative of a channel at its samples (n,), standard errors of the first two.

    half (n,) : samples to either side that each comes from. widest : of them.
    """

    value: FloatArray
    slope: FloatArray
    bend: FloatArray
    value_sd: FloatArray
    slope_sd: FloatArray
    half: IntArray
    widest: int


def _factored(moments: FloatArray, count: int, lower: FloatArray, pivots: FloatArray) -> None:
    """L (4, 4) and D (4,) of the first ``count`` rows of a cubic's normal matrix, moments[k + m] in row k, column m."""
    for k in range(count):
        for m in range(k + 1):
            left = moments[k + m]
            for i in range(m):
                left -= lower[k, i] * lower[m, i] * pivots[i]
            if m < k:
                lower[k, m] = left / pivots[m]
            else:
                pivots[k] = left


_compiled_factored = compiled(_factored)


def _solved(lower: FloatArray, pivots: FloatArray, count: int, b: FloatArray) -> None:
    """b (4,) becomes the solution x of L D L^T x = b."""
    for k in range(count):
        for m in range(k):
            b[k] -= lower[k, m] * b[m]
    for k in range(count - 1, -1, -1):
        b[k] /= pivots[k]
        for m in range(k + 1, count):
            b[k] -= lower[m, k] * b[m]


_compiled_solved = compiled(_solved)


def _around(
    t: FloatArray, first: int, last: int, i: int, reach: int, moments: FloatArray, lower: FloatArray, pivots: FloatArray
) -> tuple[int, int, float]:
    """The window from .. to around sample i of a stretch, so many samples to either side, and one over its width, 1/s.

    moments (7,), lower (4, 4), pivots (4,) : filled with those of the cubic over it, factored.
    """
    lo, hi = max(i - reach, first), min(i + reach + 1, last)
    # a full width at the ends too, off centre
    lo, hi = max(min(lo, hi - 2 * reach - 1), first), min(max(hi, lo + 2 * reach + 1), last)
    width = max(t[hi - 1] - t[i], t[i] - t[lo])
    rate = 1.0 / width if width > 0.0 else 0.0
    moments[:] = 0.0
    for n in range(lo, hi):
        s, power = rate * (t[n] - t[i]), 1.0
        for k in range(moments.size):
            moments[k] += power
            power *= s
    _compiled_factored(moments, min(_TERMS, hi - lo), lower, pivots)
    return lo, hi, rate


_compiled_around = compiled(_around)


def _local(
    t: FloatArray, y: FloatArray, first: IntArray, last: IntArray, at: IntArray, half: IntArray, out: FloatArray
) -> None:
    """Cubic around each sample in ``at`` (m,), within its stretch first to last (n,), half (n,) samples to either side.

    out (m, 6) : value, slope, second derivative, variances of the first two in units of the noise's, mean square left.
    """
    moments, lower, pivots = np.empty(7), np.empty((4, 4)), np.empty(4)
    c, by_value, by_slope = np.empty(4), np.empty(4), np.empty(4)
    for j in range(at.size):
        i = at[j]
        lo, hi, rate = _compiled_around(t, first[i], last[i], i, half[i], moments, lower, pivots)
        count = min(_TERMS, hi - lo)
        c[:], by_value[:], by_slope[:] = 0.0, 0.0, 0.0
        by_value[0] = by_slope[1] = 1.0
        for n in range(lo, hi):
            s, power = rate * (t[n] - t[i]), 1.0
            for k in range(count):
                c[k] += power * (y[n] - y[i])
                power *= s
        for b in (c, by_value, by_slope):
            _compiled_solved(lower, pivots, count, b)
        left = 0.0
        for n in range(lo, hi):
            s = rate * (t[n] - t[i])
            left += (y[n] - y[i] - c[0] - s * (c[1] + s * (c[2] + s * c[3]))) ** 2
        out[j, 0] = y[i] + c[0]
        out[j, 1] = c[1] * rate
        out[j, 2] = 2.0 * c[2] * rate**2
        out[j, 3] = by_value[0]
        out[j, 4] = by_slope[1] * rate**2
        out[j, 5] = left / max(hi - lo - count, 1)


_compiled_local = compiled(_local)


def local(t: FloatArray, y: FloatArray, first: IntArray, last: IntArray, at: IntArray, half: IntArray) -> FloatArray:
    """What ``_local`` writes, (m, 6)."""
    out = np.empty((at.size, 6))
    _compiled_local(read_only(t), read_only(y), first, last, at, read_only(half), out)
    return out


def stretches(t: FloatArray, longest: float) -> tuple[IntArray, IntArray]:
    """First sample and one past the last, (n,) each, of the stretch without a gap that every sample lies in.

    longest : s, an interval beyond it is a gap.
    """
    gaps = np.flatnonzero(np.diff(t) > longest) + 1
    edges = np.concatenate(([0], gaps, [t.size])).astype(np.int64)
    sizes = np.diff(edges)
    return np.repeat(edges[:-1], sizes), np.repeat(edges[1:], sizes)


def inner(t: FloatArray, longest: float, half: IntArray) -> BoolArray:
    """Samples (n,) in the middle of their cubic, half (n,) to either side: off centre its slope has many times the
    error.
    """
    first, last = stretches(t, longest)
    at = np.arange(t.size)
    return np.asarray((at - first >= half) & (last - at > half), dtype=np.bool_)


def smoothed(
    t: FloatArray,
    y: FloatArray,
    longest: float,
    sigma: float,
    alike: float = ALIKE,
    everywhere: bool = False,
    widest: int | None = None,
) -> Smooth:
    """Smooth a channel (n,) at t (n,), s, over the widest window that still leaves no more than the narrowest does.

    longest : interval (s) beyond which there is a gap, which no window spans. sigma : least noise. alike : by how much
    a wider cubic may miss more than the narrowest. everywhere : of each sample the widest so, and not of most: where a
    slider stops, turns or starts, a wide cubic rounds off what it does. widest : that was chosen of another channel,
    which is to be smoothed alike.
    """
    first, last = stretches(t, longest)
    best = _widest(t, y, first, last, sigma, alike) if widest is None else widest
    every = np.arange(t.size)
    halves = _halves(t, y, first, last, best, sigma) if everywhere else np.full(t.size, best)
    out = local(t, y, first, last, every, halves)
    noise = max(math.sqrt(float(np.median(out[:, 5]))), sigma)
    return Smooth(out[:, 0], out[:, 1], out[:, 2], noise * np.sqrt(out[:, 3]), noise * np.sqrt(out[:, 4]), halves, best)


def _widest(t: FloatArray, y: FloatArray, first: IntArray, last: IntArray, sigma: float, alike: float) -> int:
    """The widest half width with which most cubics leave no more than with the narrowest."""
    some = np.linspace(0, t.size - 1, min(t.size, _LOOKED_AT)).astype(np.int64)
    best, narrowest = _HALF_WIDTHS[0], 0.0
    for half in _HALF_WIDTHS:
        if 2 * half + 1 > t.size // _LEAST_PARTS:
            break
        # a median over cubics in the middle of the motion; jumps of the acceleration are few
        left = math.sqrt(float(np.median(_cubics(t, y, first, last, some, half)[:, 5]))) + sigma
        if narrowest == 0.0:
            narrowest = left
        elif left > alike * narrowest:
            break
        best = half
    return best


def _cubics(t: FloatArray, y: FloatArray, first: IntArray, last: IntArray, at: IntArray, half: int) -> FloatArray:
    """As ``local``, (m, 6), with one half width."""
    return local(t, y, first, last, at, np.full(t.size, half))


def _halves(t: FloatArray, y: FloatArray, first: IntArray, last: IntArray, widest: int, sigma: float) -> IntArray:
    """Samples to either side of each one, (n,), up to where each width leaves there what it leaves elsewhere.

    They change by one from sample to sample, so that each window ends before what it cannot follow, and value and slope
    do not jump where widths do.
    """
    halves, every = np.full(t.size, _HALF_WIDTHS[0]), np.arange(t.size)
    follows = np.ones(t.size, dtype=np.bool_)
    for half in (h for h in _HALF_WIDTHS if h <= widest):
        left = _cubics(t, y, first, last, every, half)[:, 5]
        usual = max(float(np.median(left)), sigma**2)
        freedom = 2 * half + 1 - _TERMS
        follows &= left <= usual * chdtri(freedom, _BY_CHANCE) / freedom
        halves[follows] = half
    for step in (1, -1):
        # the least of the others and how far off they are, from either side
        order = halves[::step] - every
        halves = (np.minimum.accumulate(order) + every)[::step]
    return halves


def _weights(
    t: FloatArray, first: IntArray, last: IntArray, half: IntArray, columns: IntArray, weights: FloatArray
) -> None:
    """What each sample (w,) in a row of ``columns`` (n, w) counts in the cubic around every sample of t (n,).

    weights (n, w) : of the value there; zero beyond its window.
    """
    moments, lower, pivots, by_value = np.empty(7), np.empty((4, 4)), np.empty(4), np.empty(4)
    for i in range(t.size):
        lo, hi, rate = _compiled_around(t, first[i], last[i], i, half[i], moments, lower, pivots)
        by_value[:] = 0.0
        by_value[0] = 1.0
        _compiled_solved(lower, pivots, min(_TERMS, hi - lo), by_value)
        for n in range(lo, hi):
            s = rate * (t[n] - t[i])
            columns[i, n - lo] = n
            weights[i, n - lo] = by_value[0] + s * (by_value[1] + s * (by_value[2] + s * by_value[3]))


_compiled_weights = compiled(_weights)


def smoothing(t: FloatArray, longest: float, half: IntArray) -> csr_array:
    """The cubics of these half widths (n,) as a filter (n, n), through which other channels pass as the first did."""
    first, last = stretches(t, longest)
    wide = 2 * int(np.max(half)) + 1
    columns, weights = np.zeros((t.size, wide), dtype=np.int64), np.zeros((t.size, wide))
    _compiled_weights(read_only(t), first, last, read_only(half), columns, weights)
    rows, there = np.repeat(np.arange(t.size), wide), weights.ravel() != 0.0
    return csr_array((weights.ravel()[there], (rows[there], columns.ravel()[there])), shape=(t.size, t.size))


def _times(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """out = a b, each (3, 3); out is neither."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[0, j] + a[i, 1] * b[1, j] + a[i, 2] * b[2, j]


def _times_turned(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """out = a b^T, each (3, 3); out is neither."""
    for i in range(3):
        for j in range(3):
            out[i, j] = a[i, 0] * b[j, 0] + a[i, 1] * b[j, 1] + a[i, 2] * b[j, 2]


def _at(a: FloatArray, v: FloatArray, out: FloatArray) -> None:
    """out (3,) = a (3, 3) v (3,); out is not v."""
    for i in range(3):
        out[i] = a[i, 0] * v[0] + a[i, 1] * v[1] + a[i, 2] * v[2]


def _over(a: FloatArray, b: FloatArray, out: FloatArray) -> None:
    """out = a b^-1, each (3, 3); b symmetric and positive, by its factors L D L^T, which no scale of its rows harms."""
    l10, l20 = b[1, 0] / b[0, 0], b[2, 0] / b[0, 0]
    d1 = b[1, 1] - l10 * b[1, 0]
    l21 = (b[2, 1] - l20 * b[1, 0]) / d1
    d2 = b[2, 2] - l20 * b[2, 0] - l21 * l21 * d1
    for i in range(3):
        y1 = a[i, 1] - l10 * a[i, 0]
        y2 = a[i, 2] - l20 * a[i, 0] - l21 * y1
        out[i, 2] = y2 / d2
        out[i, 1] = y1 / d1 - l21 * out[i, 2]
        out[i, 0] = a[i, 0] / b[0, 0] - l10 * out[i, 1] - l20 * out[i, 2]


times, times_turned, at, over = compiled(_times), compiled(_times_turned), compiled(_at), compiled(_over)
