"""Damping and frequency over the amplitude, from turning points alone: no law of friction is assumed.

A half-swing goes from one turning point to the next, so that where the sensor's zero lies does not matter. The
logarithm of two that follow one another is an equivalent viscous damping at the amplitude between them.
"""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.estimate.channel import fit_channel
from harness.estimate.every import KINDS, sizes
from harness.estimate.reversals import NoDecay

_MOST = 24
"""Points that are told: where there are more half-swings, each is over several."""
_STRAYS = math.log(1.5)
"""How far a frequency may lie off the median of all."""
_FEWEST = 3
"""Turning points that a damping takes."""


@dataclass(frozen=True, slots=True)
class OverAmplitude:
    """amplitude (k,), m or rad; zeta and frequency (Hz) there, with standard errors, each (k,)."""

    amplitude: FloatArray
    zeta: FloatArray
    zeta_stderr: FloatArray
    frequency_hz: FloatArray
    frequency_stderr: FloatArray

    @classmethod
    def of(cls, t: FloatArray, x: FloatArray, variance: FloatArray) -> "OverAmplitude | None":
        """Of turning points x (n,) at t (n,), s, with variances (n,); None where they are too few."""
        size = np.abs(np.diff(x))
        ends = np.flatnonzero(size <= 0.0)
        size = size[: ends[0] if ends.size else size.size]
        if size.size < _FEWEST - 1:
            return None
        over = max(-(-(size.size - 1) // _MOST), 1)
        i = np.arange(0, size.size - over, over)
        j = i + over
        first, last = size[i], size[j]
        delta = np.log(first / last) / over
        amplitude = 0.5 * np.sqrt(first * last)
        # neighbours share a turning point
        inner = (1.0 / last - 1.0 / first) ** 2 * variance[i + 1]
        if over > 1:
            inner = variance[i + 1] / first**2 + variance[j] / last**2
        spread = np.sqrt(variance[i] / first**2 + inner + variance[j + 1] / last**2) / over
        wide = np.hypot(math.pi, delta)
        took = t[j + 1] - t[i]
        frequency = 0.5 * (over + 1) / took
        # a turning point is late by its error over the speed that it has a radian away
        late = np.sqrt(variance[i] / first**2 + variance[j + 1] / last**2) / (math.pi * frequency)
        # noise turns more often than the swing does
        strays = np.flatnonzero(np.abs(np.log(frequency / np.median(frequency))) > _STRAYS)
        keep = slice(int(strays[0]) if strays.size else None)
        columns = amplitude, delta / wide, spread * math.pi**2 / wide**3, frequency, frequency * late / took
        return cls(*(column[keep] for column in columns)) if keep.stop != 0 else None


def measured(t: FloatArray, channels: Mapping[str, FloatArray]) -> OverAmplitude | None:
    """From the first of x, v, a (n,) at t (n,), s, that shows a decay; amplitudes are of the position."""
    for name, kind in KINDS.items():
        if name in channels:
            with suppress(NoDecay):
                return OverAmplitude.of(*sizes(fit_channel(t, channels[name], kind)))
    return None
