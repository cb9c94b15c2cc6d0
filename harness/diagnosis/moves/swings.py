"""Turning points of a channel, and which of the half-swings between them are decays."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.moves.series import Series

FEWEST_HALF_CYCLES = 3
"""Of a free decay: its damping and its friction are two numbers, which take three amplitudes."""
_SWING, _NOISE = 0.03, 6.0
"""Smallest half-swing, as a share of the channel's range and in its noise after smoothing."""
_RISES, _GROWS = 1.35, 1.08
"""Times the half-swing before, from which another release is told; and times the first, that none of a decay is."""
_ANOTHER = 0.3
"""Of the usual time of a half-swing, by which one differs that is none."""
_EVEN, _DRIFTS = 0.15, 1.6
"""How far times between turning points may scatter about their median, and by which factor they may change from first
to last."""
_PARTS, _FALLS, _LOST = 8, 0.8, 0.93
"""Parts of a decay, the share of them that are smaller than the one before, and the last of the first."""
_STEADILY, _FEWEST_STEADY = 0.95, 6
"""Share of the scatter of half-swings that a line takes which falls, of as many at least, where they lose less than
that: what keeps something going keeps its size about a level. Of 2,000 draws of noise about one 1 falls so.
"""


@dataclass(frozen=True, slots=True)
class Swings:
    """Half-swings, k of them: sizes (k,), and times (k+1,), s, of the turning points that bound them."""

    t: FloatArray
    size: FloatArray

    def __len__(self) -> int:
        return int(self.size.size)

    @classmethod
    def of(cls, series: Series, least: float = _SWING, part: slice = slice(None)) -> "Swings":
        """least : smallest half-swing, of the channel's range. part : of the samples."""
        t, y = series.t[part], series.y[part]
        at = _turning(y, max(least * series.span, _NOISE * series.left))
        return cls(t[at], np.abs(np.diff(y[at])))

    @property
    def path(self) -> float:
        return float(np.sum(self.size))

    @property
    def broken(self) -> int:
        """How many of them take another time than the usual: it is brought back for another release, and held."""
        gaps = np.diff(self.t)[1:-1]
        return int(np.count_nonzero(np.abs(gaps / np.median(gaps) - 1.0) > _ANOTHER))

    @property
    def even(self) -> bool:
        """Whether they follow one another as those of a swing do, faster or slower with its size at most."""
        # before the first and after the last it may rest
        gaps = np.diff(self.t)[1 if len(self) > FEWEST_HALF_CYCLES else 0 : -1]
        usual = float(np.median(gaps))
        part = max(gaps.size // 4, 1)
        drift = float(np.median(gaps[-part:]) / np.median(gaps[:part]))
        return float(np.median(np.abs(gaps - usual))) < _EVEN * usual and 1.0 / _DRIFTS < drift < _DRIFTS

    def decays(self) -> list["Swings"]:
        """Runs of half-swings that become smaller, three or more each."""
        starts = [0, *(np.flatnonzero(self.size[1:] > _RISES * self.size[:-1]) + 1).tolist(), len(self)]
        runs = [Swings(self.t[i : j + 1], self.size[i:j]) for i, j in pairwise(starts)]
        return [one for one in runs if len(one) >= FEWEST_HALF_CYCLES and one.falls and one.even]

    @property
    def falls(self) -> bool:
        """Whether they become smaller, and none is much larger than the first whole one.

        Of many the medians of neighbours are compared, where noise and a second motion even out.
        """
        size = np.array([np.median(part) for part in np.array_split(self.size, min(len(self), _PARTS))])
        smaller = bool(np.mean(size[1:] < size[:-1]) >= _FALLS) and (size[-1] < _LOST * size[0] or self._falls_steadily)
        return bool(smaller) and bool(np.max(self.size) <= _GROWS * np.max(self.size[: max(2, len(self) // _PARTS)]))

    @property
    def _falls_steadily(self) -> bool:
        """Whether they lose little, and that along a line."""
        if len(self) < _FEWEST_STEADY:
            return False
        along = float(np.corrcoef(np.arange(len(self)), self.size)[0, 1])
        return along < 0.0 and along**2 > _STEADILY


def _turning(y: FloatArray, least: float) -> IntArray:
    """Turning points of y (n,), each ``least`` from the one before; the last is where it is furthest since."""
    at, way, low, high, values = list[int](), 0, 0, 0, y.tolist()
    for i, value in enumerate(values):
        low, high = (i if value < values[low] else low), (i if value > values[high] else high)
        if way <= 0 and value > values[low] + least:
            at.append(low)
            way, high = 1, i
        elif way >= 0 and value < values[high] - least:
            at.append(high)
            way, low = -1, i
    found: IntArray = np.array([*at, high if way > 0 else low][: None if at else 0], dtype=np.int64)
    return found
