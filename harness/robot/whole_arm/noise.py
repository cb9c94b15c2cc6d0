"""Noise of a filtered series with gaps: an autoregression learnt on stretches, and the series freed of its memory."""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray

ORDER = 8
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
    def learnt(
        cls, series: FloatArray, stretches: Stretches, fitted: int, floor: float = 0.0, order: int = ORDER
    ) -> "Noise":
        """By Burg's method from a residual (m,) of a fit with so many numbers; always stable.

        floor : standard deviation of white noise that is there whatever the residual shows.
        """
        depth = stretches.depth
        size = int(np.sum(stretches.kept))
        forward = np.where(stretches.kept, series, 0.0)
        backward = forward.copy()
        power = float(forward @ forward) / max(size - fitted, 1)
        predictors, powers = [np.ones(1)], [power]
        for k in range(1, order + 1):
            valid = np.flatnonzero(depth >= k)
            f, b = forward[valid], backward[valid - 1]
            reflection = 0.0
            if valid.size > order and (below := float(f @ f + b @ b)) > 0.0:
                reflection = -2.0 * float(f @ b) / below
            forward[valid], after = f + reflection * b, b + reflection * f
            backward[valid] = after
            last = np.append(predictors[-1], 0.0)
            predictors.append(last + reflection * last[::-1])
            powers.append(powers[-1] * (1.0 - reflection**2))
        return cls(tuple(predictors), np.sqrt(np.maximum(powers, 1e-300))).rising(floor)

    def rising(self, floor: float) -> "Noise":
        """Noise of no less than half the density anywhere that it has at some lower frequency.

        What is left at low frequencies is often not noise but what the model lacks. A likelihood that took it for noise
        would trust the highest frequencies alone, where torque has least to say; this one weights all alike, and counts
        the errors by the low ones.
        """
        turn = np.exp(-1j * math.pi * np.linspace(0.0, 1.0, _FREQUENCIES))
        density = (self.sigma[-1] / np.abs(np.polyval(self.predictors[-1][::-1], turn))) ** 2
        density = np.maximum(density, np.maximum.accumulate(density) / _DIP) + floor**2
        covariance = np.fft.irfft(density)[: len(self.predictors)]
        return Noise(*_levinson(covariance))

    def whitened(self, series: FloatArray, stretches: Stretches) -> FloatArray:
        """Kept samples (k, ...) of a series (m, ...) as errors of prediction in units of theirs."""
        order = len(self.predictors) - 1
        found = np.zeros_like(series, dtype=np.float64)
        for k, predictor in enumerate(self.predictors):
            rows = np.flatnonzero(stretches.depth >= order if k == order else stretches.depth == k)
            for lag in range(k + 1):
                found[rows] += predictor[lag] * series[rows - lag]
            found[rows] /= self.sigma[k]
        return found[stretches.kept]

    @property
    def rms(self) -> float:
        """Standard deviation of the series itself."""
        return float(self.sigma[0])


def _levinson(covariance: FloatArray) -> tuple[tuple[FloatArray, ...], FloatArray]:
    """Predictors of orders 0 to p, and the standard deviations of their errors (p+1,), from covariances (p+1,)."""
    predictors, powers = [np.ones(1)], [float(covariance[0])]
    for k in range(1, covariance.size):
        last = predictors[-1]
        reflection = -float(last @ covariance[k:0:-1]) / max(powers[-1], 1e-300)
        longer = np.append(last, 0.0)
        predictors.append(longer + reflection * longer[::-1])
        powers.append(powers[-1] * (1.0 - reflection**2))
    return tuple(predictors), np.sqrt(np.maximum(powers, 1e-300))


def white_level(series: FloatArray, rate: float) -> float:
    """Density of a recorded series' white noise, unit^2/Hz, from the middle of its second differences.

    Motion bends little from sample to sample, and the few differences across a jump do not move the middle.
    """
    sigma = float(np.median(np.abs(np.diff(series, n=2)))) / (MEDIAN_OF_NORMAL * math.sqrt(6.0))
    return 2.0 * sigma**2 / rate


MEDIAN_OF_NORMAL = 0.6745
"""Median size of a normal number of deviation one; second differences of white noise have six times its variance."""
