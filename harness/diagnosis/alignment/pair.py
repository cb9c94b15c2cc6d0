"""Two traces read at the same times, whatever the clock of the first."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.residual_tests.cleaned import isolated
from harness.estimate.noise import Noise
from harness.fit.least_squares import Residual

_EVEN = 1.0001
"""Ratio of intervals up to which they are the same: times are written with few digits."""
_ACROSS = 0.1
"""Share of a period across which a slope is taken: that of a sine comes out 1.6 % low."""
EVERYWHERE = (-math.inf, math.inf)


class Signals(Protocol):
    """What can be aligned: channels (n,) by name, SI units, at times t (n,), s."""

    @property
    def t(self) -> FloatArray:
        """Times, s."""

    @property
    def channels(self) -> Mapping[str, FloatArray]:
        """By name."""


@dataclass(frozen=True, slots=True)
class Clock:
    """The first trace's clock in that of the second: origin + scale (t - origin) + shift, all in s."""

    shift: float
    scale: float = 1.0
    origin: float = 0.0

    def onto(self, t: FloatArray) -> FloatArray:
        """Times (n,) of the first trace, by the second's clock."""
        return t + self.shift if self.scale == 1.0 else self.origin + self.scale * (t - self.origin) + self.shift

    def back(self, t: FloatArray) -> FloatArray:
        """Times (n,) of the second trace, by the first's clock."""
        return t - self.shift if self.scale == 1.0 else self.origin + (t - self.shift - self.origin) / self.scale


class Pair:
    """Two traces read at the times of the one that is sampled less densely; the other is interpolated.

    noise : of the difference, for each channel to look at. period : of the motion, s. most : samples of the coarse one
    to look at, evenly thinned. origin of clocks: the first sample of the first trace.
    """

    def __init__(
        self, first: Signals, second: Signals, noise: Mapping[str, Noise], period: float, most: int | None = None
    ) -> None:
        # imported when it is needed: it brings half of its library along
        from scipy.interpolate import Akima1DInterpolator

        intervals = [float(np.median(np.diff(one.t))) for one in (first, second)]
        self.noise, self.period, self.origin = noise, period, float(first.t[0])
        self.onto_second = intervals[0] <= intervals[1] * _EVEN
        self.fine, coarse = (first, second) if self.onto_second else (second, first)
        thin = slice(None, None, 1 if most is None else max(1, coarse.t.size // most))
        self.interval = max(intervals) * thin.step
        self.t, self.coarse = coarse.t[thin], {c: coarse.channels[c][thin] for c in noise}
        # Akima's curve keeps a jump where it is, and is of third order elsewhere
        self.curves = {c: Akima1DInterpolator(self.fine.t, self.fine.channels[c]) for c in noise}
        self.reach = max(0.5 * _ACROSS * period, 0.5 * min(intervals))

    def clock(self, shift: float, scale: float = 1.0) -> Clock:
        """A clock of the first trace."""
        return Clock(shift, scale, self.origin)

    def at(self, clock: Clock) -> tuple[FloatArray, dict[str, FloatArray], dict[str, FloatArray]]:
        """Shared times of the second's clock (n,), and the channels of both there, the first's moved by ``clock``."""
        since = self.since(clock)
        inside = self.inside(since)
        t, since = self.t[inside], since[inside]
        exact = np.array_equal(since, self.fine.t)
        fine = {c: self.fine.channels[c] if exact else np.asarray(self.curves[c](since)) for c in self.noise}
        coarse = {c: self.coarse[c][inside] for c in self.noise}
        return (t, fine, coarse) if self.onto_second else (since, coarse, fine)

    def since(self, clock: Clock) -> FloatArray:
        """Times of the coarse trace (n,) by the clock of the fine one."""
        return clock.back(self.t) if self.onto_second else clock.onto(self.t)

    def inside(self, since: FloatArray) -> BoolArray:
        """Which of these times (n,) the fine trace has something to show at."""
        found: BoolArray = (since >= self.fine.t[0]) & (since <= self.fine.t[-1])
        return found

    def by_second(self, clock: Clock) -> FloatArray:
        """Times of the coarse trace (n,) by the second's clock."""
        return self.t if self.onto_second else clock.onto(self.t)

    def kept(self, clock: Clock, within: tuple[float, float] = EVERYWHERE) -> dict[str, BoolArray]:
        """Samples (n,) of the coarse trace over the other one, in a span of the second's clock, that do not stand alone
        far off.

        A jump between two samples, seen on the wrong side of one, would pull harder than all the rest.
        """
        since, t = self.since(clock), self.by_second(clock)
        inside = self.inside(since) & (t >= within[0]) & (t <= within[1])
        kept = {c: inside.copy() for c in self.curves}
        for c, curve in self.curves.items() if inside.any() else ():
            kept[c][inside] = ~isolated(self.coarse[c][inside] - curve(since[inside]))
        return kept

    def left(self, clock: Clock, c: str, keep: BoolArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Of the kept samples of one channel: second, first, slope of the fine one, its times by its own clock.

        The slope is that of the motion, and not that of its noise, which would pull a shift into dips of its own and
        promise it sharper than it is.
        """
        curve = self.curves[c]
        since = np.clip(self.since(clock)[keep], self.fine.t[0], self.fine.t[-1])
        shown, own = np.asarray(curve(since)), self.coarse[c][keep]
        low, high = np.maximum(since - self.reach, self.fine.t[0]), np.minimum(since + self.reach, self.fine.t[-1])
        slope = np.asarray((curve(high) - curve(low)) / (high - low))
        return (own, shown, slope, since) if self.onto_second else (shown, own, slope, since)

    def residual(self, clock: Clock, keep: Mapping[str, BoolArray], names: tuple[str, ...]) -> Residual:
        """Second minus first in units of the noise, with partials (n, 2) by the clock's shift and scale."""
        left, partials = [], []
        for c in names:
            second, first, slope, since = self.left(clock, c, keep[c])
            far = since if self.onto_second else self.t[keep[c]]
            by_shift = -slope / self.noise[c].sigma / (clock.scale if self.onto_second else 1.0)
            left.append((second - first) / self.noise[c].sigma)
            partials.append(np.column_stack([by_shift, by_shift * (far - self.origin)]))
        return Residual(np.concatenate(left), np.concatenate(partials))
