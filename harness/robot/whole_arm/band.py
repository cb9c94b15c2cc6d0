"""One zero-phase low-pass for everything, by Fourier: filters, differentiates and takes fewer samples in one pass.

A series is laid on its end-to-end line and continued oddly beyond both ends, where it is then smooth and periodic. The
gain is that of a Butterworth of order 4 run forwards and backwards, 1 / (1 + (f / f_lowpass)^8), at every rate alike;
derivatives of a filtered series are exact there.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray

ORDER = 4
_TRIM = 2.5
"""Samples left out at either end, in 1/f_lowpass: the slowest pole of the filter has then died to 0.3 %."""


@dataclass(frozen=True, slots=True)
class Band:
    """lowpass : Hz, where the gain is a half. size : samples of the series filtered. rate : theirs, Hz."""

    lowpass: float
    size: int
    rate: float

    def gain(self, f: FloatArray) -> FloatArray:
        """Gain (m,) at frequencies (m,), Hz."""
        return 1.0 / (1.0 + (f / self.lowpass) ** (2 * ORDER))

    def taken(self, lowest: float) -> "Band":
        """The same filter for a series at the least whole share of this rate that is at least ``lowest``, Hz."""
        step = max(int(self.rate // lowest), 1)
        return Band(self.lowpass, (self.size - 1) // step + 1, self.rate / step)

    def filtered(
        self, y: FloatArray, out: "Band", derivatives: int = 0, late: float = 0.0, means: bool = False
    ) -> list[FloatArray]:
        """The filtered series and so many of its derivatives, each (out.size, ...), of a series (size, ...).

        late : s by which the series is moved ahead. means : its values are means over each sample's own step.
        """
        step = round(self.rate / out.rate)
        # whole steps, so that both ends of the line are samples of the result
        y = y[: (out.size - 1) * step + 1]
        last = y.shape[0] - 1
        slope = (y[last] - y[0]) / last
        t = np.arange(y.shape[0], dtype=np.float64).reshape((-1,) + (1,) * (y.ndim - 1))
        flat = y - y[0] - slope * t
        spectrum = np.fft.rfft(np.concatenate((flat[:last], flat[last:0:-1] * -1.0)), axis=0)
        kept = 2 * (out.size - 1)
        f = np.arange(kept // 2 + 1) * self.rate / (2 * last)
        shape = np.sinc(f / self.rate) if means else 1.0
        gain = (self.gain(f) / shape * (f < out.rate / 2.0)).reshape((-1,) + (1,) * (y.ndim - 1))
        turn = (2j * math.pi * f).reshape(gain.shape)
        part = spectrum[: f.size] * gain * np.exp(turn * late) / step
        line = y[0] + slope * late * self.rate + slope * step * np.arange(out.size).reshape((-1,) + (1,) * (y.ndim - 1))
        added = (line, slope * self.rate, 0.0)
        return [
            np.fft.irfft(part * turn**order, kept, axis=0)[: out.size] + (added[order] if order < len(added) else 0.0)
            for order in range(derivatives + 1)
        ]

    @property
    def trimmed(self) -> slice:
        """Samples that no end of the series reaches."""
        edge = math.ceil(_TRIM * self.rate / self.lowpass)
        return slice(edge, self.size - edge)
