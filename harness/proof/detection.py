"""Where naming stops: the same case under growing noise, against the limit that the likelihood sets.

What a recording holds of an effect is the likelihood loss of the best model without it: chi-square of the base fitted
to the motion without noise, in units of the noise. It falls with the square of the noise. A model with k numbers more
pays k ln N for them in BIC: well below that loss nobody who goes by BIC can name the effect, however clever.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.proof.plant.base_fit import Seen, fit_decay
from harness.proof.plant.cases import Case, draw, fitted, measured, truth
from harness.proof.plant.effects import FAMILY
from harness.proof.score import Answer, Result, Truth
from harness.proof.statistics import RESAMPLES, TAILS, Rate
from harness.results.prove import Detection, DetectionLevel

LOSSES = (1e4, 2000.0, 400.0, 80.0, 16.0, 3.0)
KINDS = (
    "stribeck",
    "position-dependent-friction",
    "friction-drift",
    "quadratic-drag",
    "asymmetric-viscous",
    "viscoelastic",
    "cubic-stiffness",
    "quadratic-stiffness",
    "end-stop",
    "constant-force",
    "harmonic-force",
    "sensor-lag",
)
"""One case of each makes the curve: all families, laws of one number and of several."""

DRAWS = 4
"""Of so many draws the faintest is taken, lest the noise that hides it drown the motion."""


@dataclass(frozen=True, slots=True)
class Step:
    """A case at one level of noise. series : which case it is. loss : likelihood loss without noise. price : k ln N."""

    case: Case
    series: int
    loss: float
    price: float

    def answer(self) -> dict[str, Any]:
        """As ``truth`` of the case says it, with series, loss and price."""
        return {**truth(self.case), "series": self.series, "loss": self.loss, "price": self.price}


def draw_series(kind: str, seed: int, series: int = 0, losses: Sequence[float] = LOSSES) -> list[Step]:
    """One case at noise that gives the losses, in their order; slider, effect, sampling and unit noise stay the same.

    Raises InputError for a kind that is not a single effect of a free decay, SimulationError when nothing came out.
    """
    if kind not in FAMILY or kind == "static-friction":
        raise InputError("kind", kind, "a name of the catalogue that shows in a free decay")
    case, loss = _faintest(kind, seed, series)
    # numbers that a model with the effect has more than the base; a law without parameters has none
    more = sum(isinstance(value, float) for values in case.effects.values() for value in values.values())
    price = more * math.log(case.base.samples * len(case.channels))
    steps = []
    for wanted in losses:
        scale = math.sqrt(loss / wanted)
        noise = replace(case.noise, sigma={c: scale * s for c, s in case.noise.sigma.items()})
        unit = np.random.default_rng([seed, 3, series])
        spoiled = measured(case.base, case.effects, case.setting, case.channels, noise, unit)
        steps.append(Step(fitted(spoiled), series, wanted, price))
    return steps


@lru_cache(maxsize=16)
def _faintest(kind: str, seed: int, series: int) -> tuple[Case, float]:
    """The case of a series and its loss; its levels are drawn one by one, and this is the same for all."""
    rng = np.random.default_rng([seed, 2, series])
    drawn = [draw(kind, rng) for _ in range(DRAWS)]
    return min(((case, clean_loss(case)) for case in drawn), key=lambda pair: pair[1])


def clean_loss(case: Case) -> float:
    """Chi-square of the base fitted to the motion without noise, in units of the noise."""
    base, noise = case.base, case.noise
    if noise.correlation != 0.0 or noise.step is not None:
        raise InputError("noise", "coloured or quantised", "white")
    seen = Seen({c: case.clean[c] for c in case.channels}, noise.sigma)
    return fit_decay(base.times, seen, (base.omega_n, base.zeta, base.x_k, base.x0, base.v0)).chi2


def curve(answers: Mapping[str, Truth], results: Mapping[str, Result]) -> Detection:
    """The curve from answers of steps and verdicts by file; a file without verdict is one that was not named."""
    losses = sorted({float(a["loss"]) for a in answers.values()}, reverse=True)
    series = sorted({int(a["series"]) for a in answers.values()})
    named = np.full((len(series), len(losses)), np.nan)
    price = np.full(len(series), np.nan)
    for file, answer in answers.items():
        i, j = series.index(int(answer["series"])), losses.index(float(answer["loss"]))
        said = Answer.of(results.get(file)).said
        named[i, j] = sorted(said) == sorted(answer["mechanisms"])
        price[i] = float(answer["price"])
    levels = []
    for j, loss in enumerate(losses):
        seen = np.isfinite(named[:, j])
        rate = Rate.of([bool(x) for x in named[seen, j]])
        payable = int(np.count_nonzero(price[seen] < loss))
        levels.append(DetectionLevel(loss=loss, named=rate, payable=payable))
    half = _half(named, losses)
    low, high = _interval(named, losses) if half is not None else (None, None)
    limit = float(np.median(price)) if series else None
    return Detection(levels=levels, half=half, low=low, high=high, limit=limit)


def _half(named: FloatArray, losses: Sequence[float]) -> float | None:
    """Loss at which half are named, straight between levels in its logarithm; None without a crossing."""
    if named.size == 0:
        return None
    seen = np.isfinite(named)
    share = np.sum(np.where(seen, named, 0.0), axis=0) / np.maximum(np.sum(seen, axis=0), 1)
    # more loss is never harder to name: what is not monotone is chance
    share = 0.5 * (np.minimum.accumulate(share) + np.maximum.accumulate(share[::-1])[::-1])
    below = np.flatnonzero(share < 0.5)
    if below.size == 0 or below[0] == 0:
        return None
    j = int(below[0])
    part = (share[j - 1] - 0.5) / (share[j - 1] - share[j])
    return math.exp((1.0 - part) * math.log(losses[j - 1]) + part * math.log(losses[j]))


def _interval(named: FloatArray, losses: Sequence[float]) -> tuple[float | None, float | None]:
    """Bootstrap over cases; draws without a crossing count as the end they lie beyond."""
    rng = np.random.default_rng(0)
    found = []
    for _ in range(RESAMPLES // 4):
        picked = named[rng.integers(named.shape[0], size=named.shape[0])]
        half = _half(picked, losses)
        ends = losses[0] if np.nanmean(picked[:, 0]) < 0.5 else losses[-1]
        found.append(ends if half is None else half)
    low, high = np.quantile(found, TAILS)
    return float(low), float(high)
