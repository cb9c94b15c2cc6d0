"""Where a position stays in one place, and what a noisy force that then moves nothing is likely to be.

Noise of a force that is measured carries a simulation over its break-away long before the slider comes loose.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.estimate.noise import DECISIVE, Noise

_NOTHING = 1e-300
"""Of a range whose share is taken."""
_NOISES = 3.0
"""Standard deviations to either side within which a position that rests scatters."""
_FEWEST = 6
"""Samples of a rest whose force is smoothed: fewer hardly tell its noise from its course."""


def rests(q: FloatArray, within: float, width: int) -> tuple[IntArray, IntArray]:
    """First and last samples (r,) between which a position (n,) stays within a range for at least ``width`` samples."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    flat = maximum_filter1d(q, width) - minimum_filter1d(q, width) <= within
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flat.astype(np.int8), [0]))))
    return np.maximum(edges[::2] - width // 2, 0), np.minimum(edges[1::2] - 1 + width // 2, q.size - 1)


def turning(q: FloatArray, within: float, first: IntArray, last: IntArray, reach: int) -> FloatArray:
    """Samples (r,) that a position (n,) which never rests would stay within a range, between first and last ones (r,).

    It comes and goes as accelerated outside: through the range in h, through a distance d beyond it in ``reach`` more,
    so that (1 + reach / h)^2 = 1 + d / within. One that is no further than it takes ``reach`` to come in is at rest.
    """
    ways = [(first, np.maximum(first - reach, 0)), (last, np.minimum(last + reach, q.size - 1))]
    beyond = np.array([np.abs(q[there] - q[edge]) / max(within, _NOTHING) for edge, there in ways])
    return np.asarray(np.sum(reach / np.maximum(np.sqrt(1.0 + beyond) - 1.0, 1.0), axis=0))


def quiet_at_rest(t: FloatArray, q: FloatArray, u: FloatArray, own: Noise, noise: Noise, longest: float) -> FloatArray:
    """A force u (n,), N, whose noise is taken away where a position q (n,) rests; t (n,), s. The rest of it as it is.

    own, noise : of the position and of the force. longest : interval, s, beyond which there is a gap.
    """
    out = u.copy()
    within = max(2.0 * _NOISES * own.sigma, 1.5 * own.step)
    first, last = rests(q, within, _FEWEST)
    longer = last - first > 2.0 * turning(q, within, first, last, _FEWEST)
    gap = np.concatenate(([0], np.cumsum(np.diff(t) > longest)))
    for a, b in zip(first[longer], last[longer], strict=True):
        # between its ends, where it may be moving; of a rest with a gap in it no more is known
        inner = slice(a + 1, b)
        if b - a - 1 >= _FEWEST and gap[a] == gap[b]:
            out[inner] = _course(t[inner], u[inner], noise.sigma)
    return out


def _course(t: FloatArray, u: FloatArray, sigma: float) -> FloatArray:
    """What a force u (n,) at t (n,), s, is likely to be beneath white noise: lines, and jumps between them.

    By halving where that explains most (binary segmentation); samples between jumps that are too near stay as they are.
    """
    out, parts = u.copy(), [(0, u.size)]
    while parts:
        a, b = parts.pop()
        if b - a < _FEWEST:
            continue
        at, y = t[a:b] - t[a], (u[a:b] - u[a]) / sigma
        left, right = _left_by_lines(at, y), _left_by_lines(at[::-1] * -1.0, y[::-1])[::-1]
        gain = left[-1] - left[:-1] - right[1:]
        cut = int(np.argmax(gain))
        if gain[cut] > DECISIVE + 2.0 * math.log(u.size):
            parts += [(a, a + cut + 1), (a + cut + 1, b)]
            continue
        since, level = at - float(np.mean(at)), np.full(b - a, float(np.mean(y)))
        slope = float(since @ y) / float(since @ since)
        line = level + slope * since if slope**2 * float(since @ since) > DECISIVE else level
        out[a:b] = u[a] + sigma * line
    return out


def _left_by_lines(t: FloatArray, y: FloatArray) -> FloatArray:
    """Sum of squares (n,) that the best line through the first samples, up to each, leaves."""
    n = np.arange(1.0, t.size + 1.0)
    one, two, up, off, power = (np.cumsum(s) for s in (t, t * t, y, t * y, y * y))
    spread, shared = two - one * one / n, off - one * up / n
    taken = np.where(spread > 0.0, shared**2 / np.maximum(spread, _NOTHING), 0.0)
    return np.asarray(np.maximum(power - up * up / n - taken, 0.0), dtype=np.float64)
