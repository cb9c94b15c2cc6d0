"""What the decrement of a decay says at a glance: the check that nothing looks wrong to somebody who trusts it.

Turning points of position obey X' = q X - (1 + q) x_k, the largest accelerations of successive half-cycles, taken just
before the reversals, A' = q A - 2 q omega_n^2 x_k (magnitudes; q = exp(-pi zeta/sqrt(1 - zeta^2))).
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from harness.core.arrays import FloatArray

SMALLEST = 0.15
"""Of the first extreme: smaller ones are left out, noise is too large a part of them."""
LEAST = 4


@dataclass(frozen=True, slots=True)
class Decrement:
    """omega_n (rad/s), zeta, x_k (m); nan where fewer than four half-cycles were seen."""

    omega_n: float
    zeta: float
    x_k: float

    def plausible(self, omega_n: float, length: float) -> bool:
        """Whether nobody would look twice.

        Finite, the frequency within 5 % of omega_n, damping and friction positive and below a tenth: of critical, and
        of the length of the motion.
        """
        if not all(map(math.isfinite, (self.omega_n, self.zeta, self.x_k))):
            return False
        near = abs(self.omega_n / omega_n - 1.0) < 0.05
        return near and 0.0 < self.zeta < 0.1 and 0.0 < self.x_k < 0.1 * length


def decrement(t: FloatArray, y: FloatArray, channel: str) -> Decrement:
    """The three numbers from one channel, "x" (m) or "a" (m/s^2), shape (n,), of a free decay."""
    extremes, half = _extremes(t, y)
    keep = int(np.argmax(extremes < SMALLEST * extremes[0])) if np.any(extremes < SMALLEST * extremes[0]) else None
    extremes = extremes[:keep]
    if extremes.size < LEAST or not half > 0.0:
        return Decrement(math.nan, math.nan, math.nan)
    q, less = np.polyfit(extremes[:-1], extremes[1:], 1)
    if not q > 0.0:
        return Decrement(math.nan, math.nan, math.nan)
    beta = -math.log(q) / math.pi
    zeta = beta / math.sqrt(1.0 + beta**2)
    omega_n = math.pi / half / math.sqrt(1.0 - zeta**2)
    x_k = -less / (1.0 + q) if channel == "x" else -less / (2.0 * q * omega_n**2)
    return Decrement(omega_n, zeta, float(x_k))


def _extremes(t: FloatArray, y: FloatArray) -> tuple[FloatArray, float]:
    """Magnitudes of the extremes of the half-cycles in between crossings of zero, and the time of a half-cycle, s."""
    smooth, half = y, math.nan
    for _ in range(2):
        crossed = np.flatnonzero(np.diff(np.signbit(smooth)))
        if crossed.size < LEAST:
            return np.zeros(1), math.nan
        gaps = np.diff(t[crossed[: max(LEAST, crossed.size // 2)]])
        half = float(np.median(gaps[gaps > 0.5 * gaps.max()]))
        # once more with crossings that noise has not multiplied
        width = max(1, int(0.15 * half / (t[1] - t[0])))
        smooth = np.convolve(y, np.ones(width) / width, mode="same")
    at = t[crossed]
    apart = np.concatenate([[True], np.diff(at) > 0.6 * half])
    at = at[apart]
    found = [_extreme(t, y, low, high) for low, high in pairwise(at.tolist()) if high - low < 1.4 * half]
    return (np.array(found) if found else np.zeros(1)), half


def _extreme(t: FloatArray, y: FloatArray, low: float, high: float) -> float:
    """The extreme of a half-cycle: a parabola through its middle half."""
    inside = np.abs(t - 0.5 * (low + high)) < 0.25 * (high - low)
    if np.count_nonzero(inside) < 4:
        return 0.0
    s = (t[inside] - 0.5 * (low + high)) / (high - low)
    curve = np.polynomial.Polynomial.fit(s, np.abs(y[inside]), 2)
    return float(np.max(curve(np.linspace(s[0], s[-1], 50))))
