"""Noise of a filtered series with gaps: an autoregression learnt on stretches, and the series freed of its memory."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray

_ORDER = 8
"""Of the autoregression: follows the fall of a filter's gain within a band of one and a half times its own."""
_FREQUENCIES, _DIP = 513, 2.0
"""Frequencies at which a spectrum is looked at, and how far it may fall below what it was at lower ones."""


@dataclass(frozen=True, slots=True)
class Stretches:
    """kept (m,) : samples that count. depth (m,) : how many kept ones lie before each without a gap; -1 if not kept."""

    kept: BoolArray
    depth: IntArray

    @classmethod
    def of(cls, kept: BoolArray) -> "Stretches":
        """The stretches of a mask (m,)."""
        rows = np.arange(kept.size)
        last_gap = np.maximum.accumulate(np.where(kept, -1, rows))
        return cls(kept, np.where(kept, rows - last_gap - 1, -1))


@dataclass(frozen=True, slots=True)
class Noise:
    """predictors : of orders 0 to p, the coefficients (k+1,) that leave the error of prediction, 1 first.

    sigma (p+1,) : standard deviation of that error by order, the unit of the series.
    """

    predictors: tuple[FloatArray, ...]
    sigma: FloatArray

    @classmethod
    def learnt(cls, series: FloatArray, stretches: Stretches, fitted: int, floor: float = 0.0) -> "Noise":
        """By Burg's method from a residual (m,) of a fit with so many numbers; always stable.

        floor : standard deviation of white noise that is there whatever the residual shows.

        Of no less than half the density anywhere that it has at some lower frequency. What is left at low frequencies
        is often not noise but what the model lacks. A likelihood that took it for noise would trust the highest
        frequencies alone, where torque has least to say; this one weights all alike, and counts the errors by the low
        ones.
        """
        forward = np.where(stretches.kept, series, 0.0)
        backward = forward.copy()

        def burg(k: int, *_: object) -> float:
            valid = np.flatnonzero(stretches.depth >= k)
            f, b = forward[valid], backward[valid - 1]
            below = float(f @ f + b @ b)
            found = -2.0 * float(f @ b) / below if valid.size > _ORDER and below > 0.0 else 0.0
            forward[valid], backward[valid] = f + found * b, b + found * f
            return found

        own = cls._of(float(forward @ forward) / max(int(np.sum(stretches.kept)) - fitted, 1), burg)
        turn = np.exp(-1j * math.pi * np.linspace(0.0, 1.0, _FREQUENCIES))
        density = (own.sigma[-1] / np.abs(np.polyval(own.predictors[-1][::-1], turn))) ** 2
        density = np.maximum(density, np.maximum.accumulate(density) / _DIP) + floor**2
        covariance = np.fft.irfft(density)

        def levinson(k: int, last: FloatArray, power: float) -> float:
            return -float(last @ covariance[k:0:-1]) / max(power, 1e-300)

        return cls._of(float(covariance[0]), levinson)

    @classmethod
    def _of(cls, power: float, reflection: Callable[[int, FloatArray, float], float]) -> "Noise":
        """By the variance of a series and its reflections, of each order, the predictor before it, and its error's."""
        predictors, powers = [np.ones(1)], [power]
        for k in range(1, _ORDER + 1):
            found, last = reflection(k, predictors[-1], powers[-1]), np.append(predictors[-1], 0.0)
            predictors.append(last + found * last[::-1])
            powers.append(powers[-1] * (1.0 - found**2))
        return cls(tuple(predictors), np.sqrt(np.maximum(powers, 1e-300)))

    def whitened(self, series: FloatArray, stretches: Stretches) -> FloatArray:
        """Kept samples (k, ...) of a series (m, ...) as errors of prediction in units of theirs."""
        found = np.zeros_like(series, dtype=np.float64)
        for k, predictor in enumerate(self.predictors):
            rows = np.flatnonzero(stretches.depth >= _ORDER if k == _ORDER else stretches.depth == k)
            for lag in range(k + 1):
                found[rows] += predictor[lag] * series[rows - lag]
            found[rows] /= self.sigma[k]
        return found[stretches.kept]
