"""Where a residual stands out: conditions on time, speed and displacement that part loud from quiet stretches.

The residual is averaged over short blocks, so that noise falls and structure stays. Every regime is a quantity and a
side of a threshold; the threshold that best parts two levels of power is found on a fixed grid, and its gain in
log-likelihood is judged against the number of all comparisons made (Bonferroni) and of independent blocks.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.motion import Motion
from harness.diagnosis.problem import Problem
from harness.fit.series import memory
from harness.model import term as acting
from harness.model.term import Spans

_SHARES = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5)
_TIMES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
_WINDOWS = (8, 16)
_REVERSAL = (0.02, 0.04, 0.08)
"""Edges at which regimes are tried: shares of the largest speed or displacement, of the time, equal windows of it, and
swings around a reversal. ``locate`` pays for each that is tried."""
_BLOCKS_PER_SWING = 48
"""Blocks a swing, whose power counts as one value."""
_ALPHA = 0.01
"""Chance of naming a place in noise, white or coloured, all comparisons together; it moves no verdict."""
_MOST, _MOST_SPANS = 3, 60
"""Places said, and spans said one by one; more are said by their condition alone."""
_LONGEST_MEMORY = 0.5
"""Swings over which the power of blocks may go together."""
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


def share_within(place: acting.Place, base: Fit, problem: Problem) -> float | None:
    """Share of the base's mean square mismatch, in units of the noise, where a named effect acts; None of nothing."""
    t = problem.t
    inside = np.zeros(t.size, dtype=np.bool_)
    for low, high in place.spans:
        inside |= (t >= low) & (t <= high)
    squares = sum(np.square(row) for row in problem.by_sample(base.residual).values())
    total = float(np.sum(squares))
    return float(np.sum(squares, where=inside)) / total if total > 0.0 else None


class _Split(NamedTuple):
    """One condition: its regime, its words, and where it holds, (m,)."""

    regime: str
    condition: str
    inside: BoolArray


def _splits(t: FloatArray, motion: Motion, unit: str) -> Iterator[_Split]:
    """Every condition that is compared, at times t (m,), s; one number of them for every recording of one kind."""
    start, span = float(t[0]), float(t[-1] - t[0])
    for share in _TIMES:
        edge = start + share * span
        yield _Split("early", f"t < {edge:.4g} s", t < edge)
        yield _Split("late", f"t > {edge:.4g} s", t > edge)
    for count in _WINDOWS:
        for i in range(2 * count - 1):
            lo, hi = start + 0.5 * i * span / count, start + (0.5 * i + 1.0) * span / count
            regime = "early" if lo + hi < 2.0 * start + span else "late"
            yield _Split(regime, f"{lo:.4g} s < t < {hi:.4g} s", (t >= lo) & (t <= hi))
    x, v, size, speed, moving = motion.x, motion.v, np.abs(motion.x), np.abs(motion.v), ~motion.stuck
    for share in _SHARES:
        low, high = (float(q) for q in np.quantile(speed[moving] if moving.any() else speed, (share, 1.0 - share)))
        yield _Split("low-speed", f"|v| < {low:.3g} {unit}/s", moving & (speed < low))
        yield _Split("high-speed", f"|v| > {high:.3g} {unit}/s", speed > high)
    yield _Split("one-direction", "v > 0", moving & (v > 0.0))
    yield _Split("one-direction", "v < 0", moving & (v < 0.0))
    if motion.stuck.any():
        yield _Split("stick", "v = 0 (at rest)", motion.stuck)
    for share in _SHARES:
        edge, top, bottom = (float(np.quantile(y, q)) for y, q in ((size, 1.0 - share), (x, 1.0 - share), (x, share)))
        yield _Split("large-displacement", f"|x| > {edge:.3g} {unit}", size > edge)
        yield _Split("one-side", f"x > {top:.3g} {unit}", x > top)
        yield _Split("one-side", f"x < {bottom:.3g} {unit}", x < bottom)
    # within a share of a period after, or on both sides of, each change of direction
    sign = np.sign(v)
    turns = t[1:][(sign[1:] * sign[:-1] < 0.0) & moving[1:]]
    if turns.size:
        after = np.searchsorted(turns, t, side="right")
        since, until = t - turns[np.maximum(after - 1, 0)], turns[np.minimum(after, turns.size - 1)] - t
        since, until = np.where(since < 0.0, np.inf, since), np.where(until < 0.0, np.inf, until)
        for reach in (share * 2.0 * math.pi / motion.omega for share in _REVERSAL):
            yield _Split("reversal", f"within {reach:.3g} s of a reversal", np.minimum(since, until) < reach)
            yield _Split("reversal", f"less than {2.0 * reach:.3g} s after a reversal", since < 2.0 * reach)


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


def _spread(power: FloatArray, channels: int) -> float:
    """Variance of the power over that of a squared normal, at least 1: heavy tails are no place."""
    mean, spread = float(power.mean()), 1.0
    if mean > 0.0:
        spread = max(1.0, float(np.minimum(power, 12.0 * mean).var()) / (2.0 * mean * mean))
    # a mean over channels varies less than one squared normal; never counted for more than it shows
    return max(spread, 1.0 / channels)


def locate(residuals: Mapping[str, FloatArray], t: FloatArray, motion: Motion, unit: str = "m") -> tuple[Place, ...]:
    """Up to three places that hold the structure of whitened residuals (n,) at t (n,), s; none where it is even.

    unit : of x, m or rad. Linear in samples, deterministic.
    """
    used = [r for r in residuals.values() if np.any(r)]
    per_swing = 2.0 * math.pi / motion.omega / float(np.median(np.diff(t)))
    width = max(1, int(per_swing / _BLOCKS_PER_SWING))
    count = t.size // width
    if not used or count < _FEWEST_IN_ALL:
        return ()
    # power of the means of blocks, in units of white noise
    means = [r[: count * width].reshape(count, width).sum(axis=1) / math.sqrt(width) for r in used]
    power = np.column_stack([m * m for m in means]).mean(axis=1)
    # ranks, so that a few large values do not hide what the many do
    ranks = np.argsort(np.argsort(power, kind="stable"), kind="stable").astype(np.float64)
    longest = int(_LONGEST_MEMORY * per_swing / width)
    independent = memory(ranks - ranks.mean(), min(longest, count // 4)).independent
    middle = np.minimum(np.arange(count) * width + width // 2, t.size - 1)
    at = replace(motion, x=motion.x[middle], v=motion.v[middle], stuck=motion.stuck[middle])
    candidates = list(_splits(t[middle], at, unit))
    # the noise, from differences of neighbours, never above what was claimed
    quiet = min(1.0, float(np.mean([0.5 * float(np.median(np.diff(r) ** 2)) / 0.4549 for r in used])))
    excess, weighted = np.maximum(power - quiet, 0.0), power.copy()
    taken, total, found = np.zeros(count, dtype=np.bool_), float(excess.sum()), []
    for _ in range(_MOST):
        scale = independent / count / _spread(weighted, len(used))
        best = max(candidates, key=lambda c: _gain(weighted, c.inside))
        inside = best.inside
        p = min(1.0, float(chdtrc(1.0, _gain(weighted, inside) * scale)) * len(candidates))
        if p > _ALPHA:
            break
        share = float(excess[inside].sum()) / total if total > 0.0 else None
        fresh = float(excess[inside & ~taken].sum()) / total if total > 0.0 else 0.0
        if fresh > _NOTHING_MORE:
            found.append(Place(_spans(inside, t, middle, width), best.regime, best.condition, share, p))
        taken |= inside
        # what this place explains is taken out before the next is looked for
        weighted = weighted / np.where(inside, weighted[inside].mean(), weighted[~inside].mean())
    return tuple(found)


def _spans(inside: BoolArray, t: FloatArray, middle: np.ndarray, width: int) -> Spans:
    edges = np.diff(np.concatenate(([0], inside.astype(np.int8), [0])))
    first, last = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1
    lo = t[np.maximum(middle[first] - width // 2, 0)]
    hi = t[np.minimum(middle[last] + (width + 1) // 2, t.size - 1)]
    spans = [(float(a), float(b)) for a, b in zip(lo, hi, strict=True)]
    # a list nobody reads helps nobody: the stretch that holds them all, the condition says the rest
    return tuple(spans) if len(spans) <= _MOST_SPANS else ((spans[0][0], spans[-1][1]),)
