"""The regimes a mismatch may belong to, as conditions with thresholds on a fixed grid."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.motion import Motion

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
