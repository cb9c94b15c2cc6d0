"""Intervals for what a proof counts and measures, and figures of them with what is asked."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Self

import numpy as np
from scipy.stats import beta

from harness.core.arrays import FloatArray
from harness.results.prove import RateResult

LEVEL = 0.95
RESAMPLES = 2000
TAILS = (0.5 * (1.0 - LEVEL), 0.5 * (1.0 + LEVEL))


class Rate(RateResult):
    """A share of cases with its exact (Clopper-Pearson) 95 % interval; all None when there was no case."""

    @classmethod
    def of(cls, outcomes: Sequence[bool]) -> Self:
        n, k = len(outcomes), sum(map(bool, outcomes))
        if n == 0:
            return cls(hits=0, cases=0, value=None, low=None, high=None)
        low = float(beta.ppf(TAILS[0], k, n - k + 1)) if k > 0 else 0.0
        high = float(beta.ppf(1.0 - TAILS[0], k + 1, n - k)) if k < n else 1.0
        return cls(hits=k, cases=n, value=k / n, low=low, high=high)

    @classmethod
    def over(cls, groups: Mapping[str, Sequence[bool]], seed: int = 0) -> Self:
        """A share whose interval is resampled over groups of like cases, and no narrower than that of unlike ones.

        Resampling alone would say of none wrong on three machines that none ever is.
        """
        exact = cls.of([hit for outcomes in groups.values() for hit in outcomes])
        if exact.low is None or exact.high is None:
            return exact
        counts = np.array([(sum(outcomes), len(outcomes)) for outcomes in groups.values()], dtype=np.float64)
        picks = np.random.default_rng(seed).integers(len(counts), size=(RESAMPLES, len(counts)))
        hits, cases = counts[picks].sum(axis=1).T
        low, high = np.quantile(hits / cases, TAILS)
        return exact.model_copy(update={"low": min(exact.low, float(low)), "high": max(exact.high, float(high))})

    def as_dict(self) -> dict[str, Any]:
        return self.model_dump()


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
        array = np.asarray(values, dtype=np.float64)
        # the upper of the two middle values: a mean of them would make infinity of one that was withheld
        middle = array.size // 2
        low, high = resampled(array, lambda picks: np.sort(picks, axis=1)[:, middle], seed, method="nearest")
        return cls(array.size, float(np.sort(array)[middle]), low, high)

    def as_dict(self) -> dict[str, float | int | None]:
        """For JSON; an infinite value becomes null."""
        return {k: v if v is not None and np.isfinite(v) else None for k, v in asdict(self).items()}


def resampled(
    values: FloatArray, statistic: Callable[[FloatArray], FloatArray], seed: int = 0, method: Any = "linear"
) -> tuple[float, float]:
    """Bootstrap interval of a statistic of each row of (resamples, n) values; the same whenever it is computed."""
    picks = values[np.random.default_rng(seed).integers(values.size, size=(RESAMPLES, values.size))]
    low, high = np.quantile(statistic(picks), TAILS, method=method)
    return float(low), float(high)


@dataclass(frozen=True, slots=True)
class Asked:
    """What a figure counts and what is asked of it: ``said``, the least and the largest value; "" for nothing.

    of_low : the lower bound of the interval is asked for, and not the value.
    """

    label: str
    said: str = ""
    least: float = 0.0
    most: float = 1.0
    of_low: bool = False


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure of the scores."""

    key: str
    asked: Asked
    found: Rate | Median

    @property
    def judged(self) -> float | None:
        """What is asked for."""
        return self.found.low if self.asked.of_low else self.found.value

    @property
    def met(self) -> bool | None:
        """Whether it is reached; None where nothing is asked."""
        if not self.asked.said:
            return None
        return self.judged is not None and self.asked.least <= self.judged <= self.asked.most

    @property
    def share(self) -> bool:
        """Whether it is a share of cases, and not a median."""
        return isinstance(self.found, Rate)

    @property
    def sentence(self) -> str:
        value = self.judged
        shown = "unknown" if value is None else f"{100.0 * value:.1f} %" if self.share else f"{value:.3g}"
        bound = "lower bound " if self.asked.of_low else ""
        return f"{self.asked.label}: {bound}{shown}, {self.asked.said} is asked"

    def as_dict(self) -> dict[str, Any]:
        said = {"key": self.key, "label": self.asked.label, "asked": self.asked.said, "met": self.met}
        return {**said, "share": self.share, "hits": None, **self.found.as_dict()}


def figures(found: Mapping[str, Rate | Median], asked: Mapping[str, Asked], prefix: str = "") -> list[Figure]:
    """Those that are shown, in the order of ``asked``."""
    return [Figure(prefix + key, one, found[key]) for key, one in asked.items()]
