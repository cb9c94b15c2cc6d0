"""Where a motion stays, how it goes from place to place, and whether it does so at a steady speed."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.moves.series import Series
from harness.diagnosis.moves.swings import Swings

_BAND, _LONG = 0.1, 0.04
"""Of the range, within which something stays, and of the time, from which it does."""
_CREEPS = 0.25
"""Of that band, by which its last two thirds may differ: those of what passes through differ by a third of it."""
_AWAY, _TURNS = 0.15, 0.08
"""Of the range: how far apart two places are at least, and half-swings on the way between."""
_SLOW, _STEADY, _MOVING = 0.2, 0.27, 0.25
"""Of a usual speed, below which it turns or rests; how far speeds scatter; share of the time in which it moves."""
_TAUS = np.geomspace(0.03, 3.0, 40)
"""Of the time, in which something forgets where it came from."""
_LEFT = 0.012
"""Of the range, that an exponential leaves where it is what moved."""


@dataclass(frozen=True, slots=True)
class Places:
    """levels (k,) : where it stays, in turn. share : of the time.

    detour : way over distance, at its largest, of what lies between.
    """

    levels: tuple[float, ...]
    share: float
    detour: float

    @classmethod
    def of(cls, series: Series) -> "Places":
        """Of x."""
        y, span = series.y, series.span
        stays = _stays(series.lightly, _BAND * span, max(int(_LONG * y.size), 3))
        levels = [float(np.median(y[i:j])) for i, j in stays]
        share = sum(j - i for i, j in stays) / y.size
        # where it is first and last are places too
        first = [] if stays and stays[0][0] == 0 else [(0, 1)]
        last = [] if stays and stays[-1][1] == y.size else [(y.size - 1, y.size)]
        detour = 0.0
        for (_, j), (k, _) in pairwise([*first, *stays, *last]):
            way = float(np.ptp(y[j - 1 : k + 1]))
            if way >= _AWAY * span:
                detour = max(detour, Swings.of(series, _TURNS, slice(j - 1, k + 1)).path / way)
        return cls(tuple(levels), share, detour)


def _stays(y: FloatArray, band: float, least: int) -> list[tuple[int, int]]:
    """Stretches of y (n,) of ``least`` samples and more that stay within a band; those side by side at one place are
    one."""
    found, begin, low, high = list[tuple[int, int]](), 0, float(y[0]), float(y[0])
    for i, value in enumerate([*y.tolist(), np.inf]):
        lowest, highest = min(low, value), max(high, value)
        if highest - lowest <= band:
            low, high = lowest, highest
            continue
        third = (i - begin) // 3
        comes = abs(np.median(y[i - third : i]) - np.median(y[i - 2 * third : i - third])) if i > begin + 2 else band
        if i - begin >= least and comes < _CREEPS * band:
            before = found[-1] if found else (0, 0)
            alike = found and abs(np.median(y[slice(*before)]) - np.median(y[begin:i])) <= band
            near = alike and np.ptp(y[before[1] : begin + 1]) <= 2.0 * band
            found = [*found[:-1], (before[0], i)] if near else [*found, (begin, i)]
        begin, low, high = i, value, value
    return found


def steady(series: Series) -> bool:
    """Whether a place changes at one speed wherever it does, in both directions."""
    v = np.abs(np.gradient(series.lightly, series.t))
    usual = float(np.quantile(v, 0.9))
    moving = v > _SLOW * usual
    seen = v[moving]
    return bool(np.mean(moving) >= _MOVING and np.std(seen) <= _STEADY * np.mean(seen))


def relaxes(series: Series) -> bool:
    """Whether it is an exponential towards a level, from first to last."""
    s = (series.t - series.t[0]) / (series.t[-1] - series.t[0])
    y, least = series.y, np.inf
    for tau in _TAUS:
        table = np.column_stack((np.ones(s.size), np.exp(-s / tau)))
        least = min(least, float(np.std(y - table @ np.linalg.lstsq(table, y, rcond=None)[0])))
    return least < max(_LEFT * series.span, 2.0 * series.left)
