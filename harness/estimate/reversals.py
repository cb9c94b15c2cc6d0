"""Where the speed changes sign: half-cycles of a free decay, found in noise, in any one channel.

The channel is smoothed over an eighth of a period (which its spectrum gives) and followed with hysteresis. Times are
good to a few samples here; the fit that follows makes them sub-sample (harness.estimate.halfcycles).
"""

from dataclasses import dataclass
from enum import IntEnum
from itertools import pairwise

import numpy as np

from harness.core.arrays import FloatArray
from harness.estimate.means import in_means
from harness.estimate.noise import Noise

MINIMUM_HALF_CYCLES = 3
_QUIET = 2e-3
"""Crossings with less than this share of the largest swing are not followed."""
_STILL = 0.1
"""Share of the largest swing after a crossing below which the one before it is no half-cycle: a decay's is larger."""
_POINTS = 6
"""Fewest samples a half-cycle is fitted with."""


class Kind(IntEnum):
    """What a channel measures; the closed forms below are written for each."""

    ACCELERATION = 0
    VELOCITY = 1
    DISPLACEMENT = 2


@dataclass(frozen=True, slots=True)
class HalfCycles:
    """Half-cycles of a free decay, one after another.

    edges : (K+1,) s, times of the reversals that bound the half-cycles; the first is the release or the start of the
    record, the last the stop or its end. side : +1 when the first half-cycle starts at positive x (speed negative).
    held : the record shows the slider at rest before the first edge.
    """

    edges: FloatArray
    side: int
    held: bool

    def __len__(self) -> int:
        return int(self.edges.size - 1)

    @property
    def half_time(self) -> float:
        """Typical half-cycle time, s."""
        gaps = np.diff(self.edges)
        return float(np.median(gaps[1:-1] if gaps.size > 2 else gaps))


class NoDecay(Exception):  # noqa: N818  (an answer, caught in this room, and never an error for people)
    """The channel shows no free decay; the text is the reason."""


class Grows(NoDecay):
    """The swing is larger at the end than at the beginning."""


def _even(t: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The channel on an even grid at the median interval (at most four million points)."""
    gaps = np.diff(t)
    interval = float(np.median(gaps))
    if gaps.max() < 1.01 * interval and gaps.min() > 0.99 * interval:
        return t, y
    count = min(int((t[-1] - t[0]) / interval) + 1, 4_000_000)
    grid = np.linspace(t[0], t[-1], count)
    return grid, np.interp(grid, t, y)


def period_of(t: FloatArray, y: FloatArray, kind: Kind, noise: Noise) -> float:
    """Period of the motion in s, from the largest peak of the spectrum of the speed (or acceleration).

    Raises NoDecay when nothing stands above the noise.
    """
    t, y, noise = in_means(t, y, noise)
    grid, signal = _even(t, y)
    interval = float((grid[-1] - grid[0]) / (grid.size - 1))
    size = 1 << int(np.ceil(np.log2(2 * signal.size)))
    power = np.abs(np.fft.rfft(signal - signal.mean(), size)) ** 2
    frequency = np.fft.rfftfreq(size, interval)
    density = power / signal.size
    loud = density > 25.0 * noise.sigma**2 * noise.inflation(2 * np.pi * 4.0 / (grid[-1] - grid[0]), interval)
    loud &= frequency > 0.6 / (grid[-1] - grid[0])
    if not np.any(loud):
        raise NoDecay("no oscillation stands above the noise")
    weighted = np.where(loud, power * (frequency**2 if kind is Kind.DISPLACEMENT else 1.0), 0.0)
    return float(1.0 / frequency[int(np.argmax(weighted))])


def _boxcar(y: FloatArray, width: int) -> FloatArray:
    """Centred moving average of odd ``width``; the ends are averaged over what there is."""
    half = width // 2
    total = np.concatenate([[0.0], np.cumsum(y - y[0])])
    lo = np.maximum(np.arange(y.size) - half, 0)
    hi = np.minimum(np.arange(y.size) + half + 1, y.size)
    return np.asarray((total[hi] - total[lo]) / (hi - lo) + y[0], dtype=np.float64)


def _crossings(t: FloatArray, g: FloatArray, level: float) -> FloatArray:
    """Times at which g goes from beyond +-level to beyond the other; between, the middle of its zero crossings."""
    beyond = np.flatnonzero(np.abs(g) > level)
    if beyond.size == 0:
        return np.empty(0)
    turn = np.flatnonzero(np.sign(g[beyond[1:]]) != np.sign(g[beyond[:-1]]))
    times = []
    for i, j in zip(beyond[turn], beyond[turn + 1], strict=True):
        part = g[i : j + 1]
        at = np.flatnonzero(part[:-1] * part[1:] <= 0.0)
        first, last = int(i + at[0]), int(i + at[-1])
        root = [
            t[n] + (t[n + 1] - t[n]) * g[n] / (g[n] - g[n + 1]) if g[n] != g[n + 1] else t[n] for n in (first, last)
        ]
        times.append(0.5 * (root[0] + root[1]))
    return np.array(times)


def _swing(t: FloatArray, g: FloatArray, begin: float, end: float) -> float:
    """Largest value of g (n,) between two times, whatever its sign."""
    return float(np.max(np.abs(g[(t >= begin) & (t <= end)]), initial=0.0))


def _train(times: FloatArray, period: float, t: FloatArray, g: FloatArray) -> slice:
    """The run of crossings of g (n,) that follow each other like half-cycles do in which it swings most, all together.

    What trembles before a release and after a rest may cross as often.
    """
    gaps = np.diff(times)
    if gaps.size == 0:
        return slice(0, times.size)
    usual = gaps[(gaps > 0.25 * period) & (gaps < 0.9 * period)]
    half = float(np.median(usual)) if usual.size else 0.5 * period
    good = (gaps > 0.6 * half) & (gaps < 1.6 * half)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], good, [False]]).astype(np.int8)))
    if edges.size == 0:
        return slice(0, 0)
    runs = edges.reshape(-1, 2)
    most = [_swing(t, g, a, b) for a, b in pairwise(times)]
    begin, end = max(runs, key=lambda run: sum(most[run[0] : run[1]]))
    return slice(int(begin), int(end) + 1)


def find_half_cycles(t: FloatArray, y: FloatArray, kind: Kind, noise: Noise) -> HalfCycles:
    """Half-cycles of the free decay in channel ``y`` (n,) of the given kind, sampled at ``t`` (n,) in s.

    Half-cycles whose swing drowns in the noise at the end are left to the fit, which can add them. A rest before
    release and after the stop, irregular sampling and short gaps do no harm.

    Raises NoDecay with the reason when there are fewer than two reversals, when the swing grows, or when half-cycles
    hold too few samples.
    """
    t, y, noise = in_means(t, y, noise)
    period = period_of(t, y, kind, noise)
    grid, signal = _even(t, y)
    interval = float((grid[-1] - grid[0]) / (grid.size - 1))
    width = max(int(period / 8.0 / interval) | 1, 3)
    g = _boxcar(_boxcar(signal, width), width)
    sigma = noise.sigma * np.sqrt(noise.inflation(0.0, interval) / (1.5 * width))
    if kind is Kind.DISPLACEMENT:
        reach = width // 2
        slope = (g[2 * reach :] - g[: -2 * reach]) / (2 * reach * interval)
        g = np.concatenate([np.full(reach, slope[0]), slope, np.full(reach, slope[-1])])
        sigma *= np.sqrt(2.0) / (2 * reach * interval)
    level = max(3.5 * sigma, _QUIET * float(np.abs(g).max()))
    times = _crossings(grid, g, level)
    times = times[_train(times, period, grid, g)]
    if times.size < 2:
        raise NoDecay(f"{times.size} regular reversal{'' if times.size == 1 else 's'} found: no free decay")
    half = float(np.median(np.diff(times)))
    if half < _POINTS * interval:
        raise NoDecay(f"only {half / interval:.1f} samples a half-cycle, at least {_POINTS} are needed")
    while times.size > 2 and _swing(grid, g, times[0] - half, times[0]) < _STILL * _swing(grid, g, times[0], times[-1]):
        # a hand that holds it trembles
        times = times[1:]

    # swing of the smoothed channel about each crossing: it must not grow
    swing = np.array([np.abs(g[(grid > z - 0.55 * half) & (grid < z + 0.55 * half)]).max() for z in times])
    if swing[-1] > 1.15 * swing[0] + 4.0 * sigma:
        raise Grows("the swing grows: no free decay")

    middle = kind is Kind.ACCELERATION  # the acceleration crosses zero in the middle of a half-cycle
    inner = 0.5 * (times[1:] + times[:-1]) if middle else times
    first, last = inner[0] - half, inner[-1] + half
    after = g[np.searchsorted(grid, times[0] + 0.25 * half)]
    # after the first crossing the acceleration points against the first motion, the speed along the second
    side = 1 if after > 0.0 else -1
    early = signal[grid < first - 0.02 * half]
    held = early.size >= 3
    if middle and held:
        # a piece of the half-cycle before (its acceleration large), or a slider that is held
        window = early[-max(int(0.4 * half / interval), 3) :]
        if np.sqrt(np.mean(window**2)) > 0.35 * swing[0]:
            held, first, side = False, first - half, -side
            inner = np.concatenate([[first + half], inner])
    edges = np.concatenate([[first], inner, [last]])
    edges[0], edges[-1] = max(edges[0], t[0]), min(edges[-1], t[-1])
    return HalfCycles(edges, side, bool(held))
