"""One channel as a classifier looks at it: even in time, without spikes, its size and smoothness, its turning points.

What has a mass moves smoothly: over short times its places change in proportion to the time, those of noise not at all,
those of a walk, a switch or a phase that wraps with its root. Of the swings between turning points some are decays.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.diagnosis.motion import running
from harness.diagnosis.smoothed_state.local_cubics import longest_interval
from harness.estimate.means import in_means, is_dense
from harness.estimate.noise import channel_noise
from harness.estimate.stray import without_spikes

_MOST = 1_000_000
"""Samples that are looked at one by one, for what jumps or strays."""
_FAR = 0.5
"""Of the whole range, from which a change is a jump."""
_LOWEST, _BESIDE, _STANDS_OUT = 3, 48, 40.0
"""First frequency of a spectrum that is looked at, frequencies beside one, and times their median at which it is a
swing's: the largest of 50,000 of noise is 16."""
_STAY = 5
"""Samples before and after a jump that lie closer together than half of it."""
_QUARTERS = 4.0
"""Of a period, in one of which a swing changes one way."""
_WIDTHS, _LEAST = 3.0, 200
"""Means that it takes to smooth while a channel changes; samples that are left at least."""
_FEWEST, _NO_LONGER = 48, 0.5
"""Means that are compared, and the power from which on a change no longer grows with the time."""
SMOOTH = 0.76
"""Power of the time with which what has a mass moves at least: 1, and .79 at six samples a cycle; a walk has .5."""


@dataclass(frozen=True, slots=True)
class Series:
    """t, y (n,) : even in time, s, and smoothed over a part of a turn; lightly : less. left : noise that the former
    leaves.

    power : of the time with which the channel changes, at its largest. memory : share of the recording after which it
    has forgotten where it was. jumps : how often it goes from one place to another within a sample. line : whether it
    swings at a frequency, under noise that hides how it grows. holes : (h, 2) s, between which nothing was recorded.
    """

    t: FloatArray
    y: FloatArray
    lightly: FloatArray
    left: float
    power: float
    memory: float
    jumps: int
    line: bool
    holes: FloatArray

    @property
    def smooth(self) -> bool:
        """Whether it can be the motion of something that has a mass."""
        return self.power >= SMOOTH or self.line

    @property
    def span(self) -> float:
        """Range without the few samples furthest out."""
        low, high = np.quantile(self.y, (0.001, 0.999))
        return float(high - low)

    @classmethod
    def of(cls, t: FloatArray, y: FloatArray) -> "Series":
        """Of a channel y (n,) at t (n,), s."""
        y = without_spikes(y)
        noise = channel_noise(t, y)
        wide = np.flatnonzero(np.diff(t) > longest_interval(t))
        holes = np.column_stack((t[wide], t[wide + 1]))
        few = t.size // _MOST
        if few > 1 and is_dense(y, few):
            t, y = t[::few], y[::few]
        grid = np.linspace(t[0], t[-1], t.size)
        even = np.interp(grid, t, y)
        jumps = _jumps(even)
        grid, even, noise = in_means(grid, even, noise)
        power, lag = _grows(even)
        swing = None if power >= SMOOTH else _line(even)
        lag = lag if swing is None else swing / _QUARTERS
        width = max(int(lag / _WIDTHS), 1) | 1
        smooth = running(running(even, width), width)
        thin = max(min(width // 2, even.size // _LEAST), 1)
        left = noise.sigma / math.sqrt(1.5 * width)
        lightly = running(even, width // 4 | 1)
        return cls(
            grid[::thin], smooth[::thin], lightly[::thin], left, power, _memory(even), jumps, swing is not None, holes
        )


def _line(y: FloatArray) -> float | None:
    """The period, samples, at which y (n,) swings; None where no frequency stands out from those beside it."""
    steps = np.diff(y)
    power = np.abs(np.fft.rfft((steps - steps.mean()) * np.hanning(steps.size))) ** 2
    blocks = [np.median(part) for part in np.array_split(power[_LOWEST:], max(power.size // _BESIDE, 1))]
    about = np.interp(np.arange(power.size), (np.arange(len(blocks)) + 0.5) * _BESIDE + _LOWEST, blocks)
    over = power / np.maximum(about, 1e-300)
    best = _LOWEST + int(np.argmax(over[_LOWEST:]))
    return steps.size / best if over[best] > _STANDS_OUT else None


def _memory(y: FloatArray) -> float:
    """The time, as a share of the whole, after which y (n,) has changed by half of what it ever does, in squares."""
    lags = np.unique(np.geomspace(1, y.size // 4, 30).astype(np.int64))
    change = np.array([float(np.mean((y[k:] - y[:-k]) ** 2)) for k in lags])
    return float(lags[np.flatnonzero(change >= 0.5 * change.max())[0]]) / y.size


def _jumps(y: FloatArray) -> int:
    """How often neighbours of y (n,) lie half of its range apart, and what follows stays there."""
    change = np.abs(np.diff(y))
    far = np.flatnonzero(change > _FAR * np.ptp(y))
    far = far[(far >= _STAY) & (far < y.size - _STAY - 1)]
    after = [np.ptp(y[i + 1 : i + 1 + _STAY]) < _FAR * change[i] for i in far]
    before = [np.ptp(y[i + 1 - _STAY : i + 1]) < _FAR * change[i] for i in far]
    stays = np.logical_and(before, after).tolist()
    return sum(stays) if 2 * sum(stays) >= far.size else 0


def _grows(y: FloatArray) -> tuple[float, float]:
    """The largest power of the time with which changes of y (n,) grow, and the time, samples, up to which they do.

    By means of neighbours, in which noise is less: over two of them against over four.
    """
    powers, size = [], 1
    while y.size // size >= _FEWEST:
        means = y[: y.size // size * size].reshape(-1, size).mean(axis=1)
        over = [float(np.mean((means[k:] - means[:-k]) ** 2)) for k in ((1, 2, 4) if size == 1 else (2, 4))]
        powers += [0.5 * math.log2(max(b, 1e-300) / max(a, 1e-300)) for a, b in pairwise(over)]
        size *= 2
    best = int(np.argmax(powers))
    ends = [i for i in range(best, len(powers)) if powers[i] < _NO_LONGER]
    return powers[best], 2.0 ** (ends[0] if ends else len(powers))


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
    """Half-swings, k of them, that were recorded whole: begin, end (k,), s, of each, and its size (k,)."""

    begin: FloatArray
    end: FloatArray
    size: FloatArray

    def __len__(self) -> int:
        return int(self.size.size)

    def __getitem__(self, part: "slice | BoolArray") -> "Swings":
        return Swings(self.begin[part], self.end[part], self.size[part])

    @classmethod
    def of(cls, series: Series, least: float = _SWING, part: slice = slice(None)) -> "Swings":
        """least : smallest half-swing, of the channel's range. part : of the samples.

        One in which a hole is long enough to hide a turning point is left out: how far it went, nobody saw.
        """
        t, y = series.t[part], series.y[part]
        at = _turning(y, max(least * series.span, _NOISE * series.left))
        found = cls(t[at[:-1]], t[at[1:]], np.abs(np.diff(y[at])))
        if not (len(found) and len(series.holes)):
            return found
        first, last = series.holes[np.ptp(series.holes, axis=1) > _ANOTHER * np.median(found.lasts)].T
        # holes that begin before it ends are more than those that end before it begins
        return found[np.searchsorted(first, found.end) == np.searchsorted(last, found.begin, side="right")]

    @property
    def lasts(self) -> FloatArray:
        """Time of each, s."""
        return self.end - self.begin

    @property
    def path(self) -> float:
        return float(np.sum(self.size))

    @property
    def broken(self) -> int:
        """How many take another time than the usual, or follow on a hole: it is brought back for another release."""
        lasts = self.lasts[1:-1]
        other = np.abs(lasts / np.median(lasts) - 1.0) > _ANOTHER
        return int(np.count_nonzero(other) + np.count_nonzero(self.begin[1:] > self.end[:-1]))

    @property
    def even(self) -> bool:
        """Whether they follow one another as those of a swing do, faster or slower with its size at most."""
        # before the first and after the last it may rest
        lasts = self.lasts[1 if len(self) > FEWEST_HALF_CYCLES else 0 : -1]
        usual = float(np.median(lasts))
        part = max(lasts.size // 4, 1)
        drift = float(np.median(lasts[-part:]) / np.median(lasts[:part]))
        return float(np.median(np.abs(lasts - usual))) < _EVEN * usual and 1.0 / _DRIFTS < drift < _DRIFTS

    def decays(self) -> list["Swings"]:
        """Runs of half-swings that become smaller, three or more each."""
        starts = [0, *(np.flatnonzero(self.size[1:] > _RISES * self.size[:-1]) + 1).tolist(), len(self)]
        runs = [self[i:j] for i, j in pairwise(starts)]
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
