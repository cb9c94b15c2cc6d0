"""Intervals for what a proof counts and measures."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from scipy.stats import beta, norm

from harness.core.arrays import FloatArray

LEVEL = 0.95
RESAMPLES = 2000
_FITTED = 6.0
"""Numbers that a base fit takes from a residual."""
_SCATTER = float(norm.ppf(0.995))
"""Standard deviations of a normal number that are left once in a hundred times."""


def is_noise(ratio: float, points: int, correlation: float) -> bool:
    """Whether a residual's rms over the true noise's is one, within what chance leaves 99 times of a hundred.

    correlation : of first-order noise from one of its points to the next.
    """
    independent = points * (1.0 - correlation**2) / (1.0 + correlation**2)
    return abs(ratio**2 - 1.0) <= _SCATTER * math.sqrt(2.0 / independent) + _FITTED / independent


@dataclass(frozen=True, slots=True)
class Rate:
    """A share of cases with its exact (Clopper-Pearson) 95 % interval; all None when there was no case."""

    hits: int
    cases: int
    value: float | None
    low: float | None
    high: float | None

    @classmethod
    def of(cls, outcomes: Sequence[bool]) -> "Rate":
        """The share of true outcomes."""
        n, k = len(outcomes), sum(map(bool, outcomes))
        if n == 0:
            return cls(0, 0, None, None, None)
        tail = 0.5 * (1.0 - LEVEL)
        low = float(beta.ppf(tail, k, n - k + 1)) if k > 0 else 0.0
        high = float(beta.ppf(1.0 - tail, k + 1, n - k)) if k < n else 1.0
        return cls(k, n, k / n, low, high)

    def as_dict(self) -> dict[str, float | int | None]:
        """For JSON."""
        return asdict(self)


@dataclass(frozen=True, slots=True)
class Median:
    """A median with its bootstrap 95 % interval; all None when there was no case. Infinite values count as they are."""

    cases: int
    value: float | None
    low: float | None
    high: float | None

    @classmethod
    def of(cls, values: Sequence[float], seed: int = 0) -> "Median":
        """The median of the values; resampled with a fixed seed, so that it can be computed again."""
        if not values:
            return cls(0, None, None, None)
        array: FloatArray = np.asarray(values, dtype=np.float64)
        rng = np.random.default_rng(seed)
        # the upper of the two middle values: a mean of them would make infinity of one that was withheld
        middle = array.size // 2
        picks = np.sort(array[rng.integers(array.size, size=(RESAMPLES, array.size))], axis=1)[:, middle]
        low, high = np.quantile(picks, [0.5 * (1.0 - LEVEL), 0.5 * (1.0 + LEVEL)], method="nearest")
        return cls(array.size, float(np.sort(array)[middle]), float(low), float(high))

    def as_dict(self) -> dict[str, float | int | None]:
        """For JSON; an infinite value becomes null."""
        return {k: v if v is not None and np.isfinite(v) else None for k, v in asdict(self).items()}
