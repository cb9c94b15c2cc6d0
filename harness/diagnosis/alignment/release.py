"""Where a trace begins to move: the event that a simulation and a recording of a free decay have in common."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.diagnosis.alignment.pair import Signals
from harness.estimate.noise import Noise

_LEAVES, _SIGMAS = 0.02, 6.0
"""A channel has left its first value when it is this share of its range, and so many sigma, away."""
_IN_A_ROW = 3
"""Samples in a row that must be away: a stray one is none."""
_HELD = 0.15
"""Periods after which a channel that has not left its first value was held: from a turning point it leaves by 2 % of
the range within arccos(0.96) / (2 pi) = 0.045 of a period."""
_SLOW = 0.02
"""In full motion it leaves within 0.006 of a period; a trace that takes longer began at a turning point."""


@dataclass(frozen=True, slots=True)
class Release:
    """time : s. held : the trace rests before it, so that the event is seen and not taken to be the first sample."""

    time: float
    held: bool


def release(trace: Signals, noise: Mapping[str, Noise], period: float) -> Release | None:
    """The release, None for a trace that begins in full motion; period in s."""
    leaves = [_leaves(trace, c, noise[c], period) for c in ("x", "v", "a") if c in noise]
    if not leaves:
        return None
    start = float(trace.t[0])
    first, last = min(leaves), max(leaves)
    if first - start > _HELD * period:
        return Release(first, True)
    return Release(start, False) if last - start > _SLOW * period else None


def _leaves(trace: Signals, c: str, noise: Noise, period: float) -> float:
    """Last time, s, at which a channel still is where it began."""
    y = trace.channels[c]
    begin = max(int(np.searchsorted(trace.t, trace.t[0] + period / 40.0)), 1)
    away = np.abs(y - np.median(y[:begin])) > max(_SIGMAS * noise.sigma, _LEAVES * float(np.ptp(y)))
    run = np.convolve(away.astype(np.int64), np.ones(_IN_A_ROW, dtype=np.int64), "valid") == _IN_A_ROW
    found = np.flatnonzero(run)
    return float(trace.t[max(int(found[0]) - 1, 0)] if found.size else trace.t[-1])
