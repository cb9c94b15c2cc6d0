"""Where a residual stands out: conditions on time, speed and displacement that part loud from quiet stretches.

The residual is averaged over short blocks, so that noise falls and structure stays. Every regime is a quantity and a
side of a threshold; the threshold that best parts two levels of power is found on a fixed grid, and its gain in
log-likelihood is judged against the number of all comparisons made (Bonferroni) and of independent blocks.

How much of what the base model leaves lies where a named effect acts.

The regimes a mismatch may belong to, as conditions with thresholds on a fixed grid.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import chdtrc

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.motion import Motion
from harness.diagnosis.problem import Problem
from harness.fit.autocorrelation import memory
from harness.model import term as acting
from harness.model.term import Spans


def share_within(place: acting.Place, base: Fit, problem: Problem) -> float | None:
    """Share of the base's mean square mismatch, in units of the noise, within a place; None where nothing is left."""
    t = problem.t
    inside = np.zeros(t.size, dtype=np.bool_)
    for low, high in place.spans:
        inside |= (t >= low) & (t <= high)
    squares = base.residual.reshape(-1, t.size) ** 2
    total = float(squares.sum())
    return float(squares[:, inside].sum()) / total if total > 0.0 else None


_SHARES = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)
_TIMES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
_WINDOWS = (8, 16)
_REVERSAL = (0.02, 0.04, 0.08)
"""Edges at which regimes are tried: shares of the largest speed or displacement, of the time, equal windows of it, and
swings around a reversal. ``locate`` pays for each that is tried."""


@dataclass(frozen=True, slots=True)
class Split:
    """One condition: its regime, its words, and where it holds, (m,)."""

    regime: str
    condition: str
    inside: BoolArray


def splits(t: FloatArray, motion: Motion, unit: str = "m") -> list[Split]:
    """Every condition that is compared, at times t (m,), s; one number of them for every recording of one kind."""
    return [*_time(t), *_speed(motion, unit), *_displacement(motion, unit), *_turning(t, motion)]


def _time(t: FloatArray) -> Iterator[Split]:
    start, span = float(t[0]), float(t[-1] - t[0])
    for share in _TIMES:
        edge = start + share * span
        yield Split("early", f"t < {edge:.4g} s", t < edge)
        yield Split("late", f"t > {edge:.4g} s", t > edge)
    for count in _WINDOWS:
        for i in range(2 * count - 1):
            lo, hi = start + 0.5 * i * span / count, start + (0.5 * i + 1.0) * span / count
            regime = "early" if lo + hi < 2.0 * start + span else "late"
            yield Split(regime, f"{lo:.4g} s < t < {hi:.4g} s", (t >= lo) & (t <= hi))


def _speed(motion: Motion, unit: str) -> Iterator[Split]:
    v = motion.v
    speed, moving = np.abs(v), ~motion.stuck
    levels = speed[moving] if np.any(moving) else speed
    for share in _SHARES:
        low, high = (float(q) for q in np.quantile(levels, (share, 1.0 - share)))
        yield Split("low-speed", f"|v| < {low:.3g} {unit}/s", moving & (speed < low))
        yield Split("high-speed", f"|v| > {high:.3g} {unit}/s", speed > high)
    yield Split("one-direction", "v > 0", moving & (v > 0.0))
    yield Split("one-direction", "v < 0", moving & (v < 0.0))
    if np.any(motion.stuck):
        yield Split("stick", "v = 0 (at rest)", motion.stuck)


def _displacement(motion: Motion, unit: str) -> Iterator[Split]:
    x = motion.x
    size = np.abs(x)
    for share in _SHARES:
        edge = float(np.quantile(size, 1.0 - share))
        yield Split("large-displacement", f"|x| > {edge:.3g} {unit}", size > edge)
        top, bottom = float(np.quantile(x, 1.0 - share)), float(np.quantile(x, share))
        yield Split("one-side", f"x > {top:.3g} {unit}", x > top)
        yield Split("one-side", f"x < {bottom:.3g} {unit}", x < bottom)


def _turning(t: FloatArray, motion: Motion) -> Iterator[Split]:
    """Within a share of a period after, or on both sides of, each change of direction."""
    sign = np.sign(motion.v)
    turns = t[1:][(sign[1:] * sign[:-1] < 0.0) & ~motion.stuck[1:]]
    if not turns.size:
        return
    period = 2.0 * math.pi / motion.omega
    after = np.searchsorted(turns, t, side="right")
    since = t - turns[np.maximum(after - 1, 0)]
    until = turns[np.minimum(after, turns.size - 1)] - t
    since, until = np.where(since < 0.0, np.inf, since), np.where(until < 0.0, np.inf, until)
    for share in _REVERSAL:
        reach = share * period
        text = f"within {reach:.3g} s of a reversal"
        yield Split("reversal", text, np.minimum(since, until) < reach)
        yield Split("reversal", f"less than {2.0 * reach:.3g} s after a reversal", since < 2.0 * reach)


_BLOCKS_PER_SWING = 48
"""Blocks a swing, whose power counts as one value."""
_ALPHA = 0.01
"""Level at which a place is said, over all places looked at; it moves no verdict."""
_MOST = 3
"""Places said."""
_LONGEST_MEMORY = 0.5
"""Swings over which the power of blocks may go together."""
_MOST_SPANS = 60
"""Spans said one by one; more are said by their condition alone."""
_NOTHING_MORE = 0.02
"""Share of the mismatch that a further place must add."""
_FEWEST_BLOCKS, _FEWEST_IN_ALL = 6, 24
"""Blocks on either side of a regime's edge, and of a recording, below which a share says nothing."""


@dataclass(frozen=True, slots=True)
class Place:
    """A place in a recording where the mismatch lies.

    spans : s. regime, condition : as in results. share : of the mean square mismatch above noise, None when there is
    none. p_value : chance that noise alone parts so clearly, all comparisons counted.
    """

    spans: Spans
    regime: str
    condition: str
    share: float | None
    p_value: float


@dataclass(frozen=True, slots=True)
class _Blocks:
    """Blocks: power of their means in units of white noise (m, channels), and how many are independent."""

    power: FloatArray
    width: int
    independent: float


def _blocks(residuals: Sequence[FloatArray], width: int, longest: int) -> _Blocks:
    count = residuals[0].size // width
    means = [r[: count * width].reshape(count, width).sum(axis=1) / math.sqrt(width) for r in residuals]
    power = np.column_stack([m * m for m in means])
    # ranks, so that a few large values do not hide what the many do
    ranks = np.argsort(np.argsort(power.mean(axis=1), kind="stable"), kind="stable").astype(np.float64)
    return _Blocks(power, width, memory(ranks - ranks.mean(), min(longest, count // 4)).independent)


def _gain(power: FloatArray, inside: BoolArray) -> float:
    """Twice the log-likelihood ratio of two levels of variance, loud inside, against one; 0 when it is not louder."""
    n1 = int(np.count_nonzero(inside))
    n0 = power.size - n1
    if n1 < _FEWEST_BLOCKS or n0 < _FEWEST_BLOCKS:
        return 0.0
    s, s1, s0 = float(power.mean()), float(power[inside].mean()), float(power[~inside].mean())
    # a mean of its own each: a difference of sums loses a quiet side beside a loud one
    if s1 <= s0 or min(s, s0) <= 0.0:
        return 0.0
    return power.size * math.log(s) - n1 * math.log(s1) - n0 * math.log(s0)


def _spread(power: FloatArray) -> float:
    """Variance of the power over that of a squared normal, at least 1: heavy tails are no place."""
    mean = float(power.mean())
    return max(1.0, float(np.minimum(power, 12.0 * mean).var()) / (2.0 * mean * mean)) if mean > 0.0 else 1.0


def locate(
    residuals: Mapping[str, FloatArray], t: FloatArray, motion: Motion, alpha: float = _ALPHA, unit: str = "m"
) -> tuple[Place, ...]:
    """Up to three places that hold the structure of whitened residuals (n,) at t (n,), s; none where it is even.

    alpha : chance of naming a place in noise, white or coloured, all comparisons together. unit : of x, m or rad.
    Linear in samples, deterministic.
    """
    names = [c for c, r in residuals.items() if np.any(r)]
    per_swing = 2.0 * math.pi / motion.omega / float(np.median(np.diff(t)))
    width = max(1, int(per_swing / _BLOCKS_PER_SWING))
    if not names or t.size // width < _FEWEST_IN_ALL:
        return ()
    blocks = _blocks([residuals[c] for c in names], width, int(_LONGEST_MEMORY * per_swing / width))
    power, found = blocks.power.mean(axis=1), []
    middle = np.minimum(np.arange(power.size) * width + width // 2, t.size - 1)
    at = replace(motion, x=motion.x[middle], v=motion.v[middle], stuck=motion.stuck[middle])
    candidates = splits(t[middle], at, unit)
    quiet = _level(residuals, names)
    excess = np.maximum(power - quiet, 0.0)
    weighted = power.copy()
    taken = np.zeros(power.size, dtype=np.bool_)
    for _ in range(_MOST):
        scale = blocks.independent / power.size / _spread_of(weighted, len(names))
        best = max(candidates, key=lambda c: _gain(weighted, c.inside), default=None)
        if best is None:
            break
        gain = _gain(weighted, best.inside) * scale
        p = min(1.0, float(chdtrc(1.0, gain)) * len(candidates))
        if p > alpha:
            break
        total = float(excess.sum())
        share = float(excess[best.inside].sum()) / total if total > 0.0 else None
        fresh = float(excess[best.inside & ~taken].sum()) / total if total > 0.0 else 0.0
        if fresh > _NOTHING_MORE:
            found.append(_place(best, t, middle, width, share, p))
        taken |= best.inside
        # what this place explains is taken out before the next is looked for
        inside = best.inside
        weighted = weighted / np.where(inside, weighted[inside].mean(), weighted[~inside].mean())
    return tuple(found)


def _spread_of(power: FloatArray, channels: int) -> float:
    # a mean over channels varies less than one squared normal; never counted for more than it shows
    return max(_spread(power), 1.0 / channels)


def _level(residuals: Mapping[str, FloatArray], names: Sequence[str]) -> float:
    """Power of the noise, from differences of neighbours, never above what was claimed."""
    levels = [0.5 * float(np.median(np.diff(residuals[c]) ** 2)) / 0.4549 for c in names]
    return min(1.0, float(np.mean(levels)))


def _place(split: Split, t: FloatArray, middle: np.ndarray, width: int, share: float | None, p: float) -> Place:
    edges = np.diff(np.concatenate(([0], split.inside.astype(np.int8), [0])))
    first, last = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    lo = t[np.maximum(middle[first] - width // 2, 0)]
    hi = t[np.minimum(middle[last] + (width + 1) // 2, t.size - 1)]
    spans = [(float(a), float(b)) for a, b in zip(lo, hi, strict=True)]
    if len(spans) > _MOST_SPANS:
        # a list nobody reads helps nobody: the stretch that holds them all, the condition says the rest
        spans = [(spans[0][0], spans[-1][1])]
    return Place(tuple(spans), split.regime, split.condition, share, p)
