"""Positions and torques of a log on even times, low-passed alike and without delay, with their derivatives."""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray

CUTOFF = 15.0
"""Hz: arms move below some Hz, and a second derivative of an encoder's noise grows with the square of this."""
_SHARE = 0.4
"""Of half the sampling rate: the highest cutoff."""
_ORDER = 2
"""Of the filter, which runs forwards and backwards."""


@dataclass(frozen=True, slots=True)
class Even:
    """Even times. t (n,) : s. cutoff : of the filter, Hz."""

    t: FloatArray
    cutoff: float

    @classmethod
    def of(cls, t: FloatArray, cutoff: float = CUTOFF) -> "Even":
        """Even times over those of a log, at its median interval."""
        interval = float(np.median(np.diff(t)))
        n = max(int((t[-1] - t[0]) / interval), 1) + 1
        return cls(np.linspace(t[0], t[-1], n), min(cutoff, _SHARE * 0.5 / interval))

    @property
    def interval(self) -> float:
        """Between two times, s."""
        return float(self.t[1] - self.t[0])

    def low(self, t: FloatArray, y: FloatArray) -> FloatArray:
        """A channel (m,) of times t (m,) on the even ones, low-passed, (n,)."""
        from scipy.signal import butter, sosfiltfilt

        sections = butter(_ORDER, self.cutoff, fs=1.0 / self.interval, output="sos")
        return np.asarray(sosfiltfilt(sections, np.interp(self.t, t, y)))

    def slope(self, y: FloatArray) -> FloatArray:
        """Derivative (n,) of a channel (n,) on the even times."""
        return np.gradient(y, self.interval)

    @property
    def settled(self) -> slice:
        """Without the ends, where a filter knows nothing of what comes before and after."""
        edge = min(int(1.0 / (self.cutoff * self.interval)) + 1, self.t.size // 10)
        return slice(edge, self.t.size - edge)
