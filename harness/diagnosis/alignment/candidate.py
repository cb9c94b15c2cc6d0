"""One way in which two traces may lie over each other: refined, and what it leaves.

Clocks may run at different rates: seconds of one trace for one of the other.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.quantity import Quantity
from harness.diagnosis.alignment.pair import EVERYWHERE, Clock, Pair
from harness.diagnosis.rules import CLOCK_RATE
from harness.fit.least_squares import Bounds, Residual, Until, least_squares

_FEWEST = 8
"""Samples of a channel that traces must share."""
_TURNS, _MOVED = 12, 1e-6
"""Steps of a refinement; it ends sooner where a shift moves by no more than so many standard errors."""
_SAME, _ALIKE = 1.5, 1e-3
"""Mean square over the noise's up to which a channel is that of the same motion, or, for traces without noise, its
share of the mean square of strangers."""


@dataclass(frozen=True)
class Candidate:
    """A clock of the first trace. names : channels it was refined with. within : span of the second's clock, s, that it
    was refined in. shares : mean square difference by channel, offset apart, over that of strangers. loud : over the
    noise's. count : samples by channel.
    """

    pair: Pair
    clock: Clock
    keep: Mapping[str, BoolArray]
    within: tuple[float, float]
    shares: Mapping[str, float]
    loud: Mapping[str, float]
    count: Mapping[str, int]

    @property
    def names(self) -> tuple[str, ...]:
        """Channels that tell of the shift: the force alone where it is the same and the motion is not."""
        return ("u",) if self.alike("u") and not all(self.alike(c) for c in self.loud) else tuple(self.loud)

    def alike(self, c: str) -> bool:
        """Whether a channel is the same in both, to within the noise."""
        return c in self.loud and (self.loud[c] < _SAME or self.shares[c] < _ALIKE)

    @property
    def same(self) -> bool:
        """Whether the two show the same motion, or are driven by the same force."""
        return self.alike("u") or all(self.alike(c) for c in self.loud)

    @property
    def within_noise(self) -> bool:
        """Whether noise is all that is left of every channel."""
        return all(power < _SAME for power in self.loud.values())

    @property
    def saved(self) -> float:
        """Sum of n log(share) over the channels; the lower, the more of both is explained."""
        return sum(n * math.log(self.shares[c]) for c, n in self.count.items())

    @property
    def mean_log(self) -> float:
        """Mean over the channels of log(share)."""
        return float(np.mean([math.log(share) for share in self.shares.values()]))

    @property
    def reach(self) -> float:
        """How far a shift found with fewer samples may be off, s."""
        return 0.25 * (self.within[1] - self.within[0]) if math.isfinite(self.within[0]) else 0.0

    @property
    def inflation(self) -> float:
        """Variance of a mean over that of as many independent samples: colour of the noise, or a mismatch that says one
        thing for about a quarter of a period.
        """
        period, interval = self.pair.period, self.pair.interval
        colour = max(self.pair.noise[c].inflation(2.0 * math.pi / period, interval) for c in self.names)
        loud = float(np.mean([self.loud[c] for c in self.names]))
        return max(colour, loud * 0.25 * period / interval) if loud > _SAME else max(colour, 1.0)

    def ahead(self, other: "Candidate") -> float:
        """Twice the logarithm of this one's likelihood over that of another, for as many independent pieces as there
        are: samples of noise, or quarters of a period where more than noise is left.
        """
        pieces = max(self.inflation / max(float(np.mean(list(self.loud.values()))), 1.0), 1.0)
        return sum(n / pieces * math.log(other.shares[c] / self.shares[c]) for c, n in self.count.items())

    def on(self, pair: Pair) -> "Candidate":
        """The same, refined further on traces that were not thinned."""
        return refined(pair, self.clock, self.within, self.clock.scale != 1.0, self.names) or self

    def covariance(self, rate: bool) -> FloatArray:
        """Of the shift (s), and of the scale where ``rate``: (1, 1) or (2, 2); infinite where nothing moves."""
        partials = self.pair.residual(self.clock, self.keep, self.names).partials[:, : 2 if rate else 1]
        normal = partials.T @ partials / self.inflation
        if not np.all(np.diag(normal) > 0.0):
            return np.full(normal.shape, math.inf)
        size = np.sqrt(np.diag(normal))
        return np.asarray(np.linalg.pinv(normal / np.outer(size, size)) / np.outer(size, size))

    @property
    def scale(self) -> Quantity:
        """Of the clock, with its error."""
        return Quantity(self.clock.scale, math.sqrt(float(self.covariance(True)[1, 1])), "1")


def refined(
    pair: Pair,
    start: Clock,
    within: tuple[float, float] = EVERYWHERE,
    rate: bool = False,
    names: tuple[str, ...] | None = None,
) -> Candidate | None:
    """The least squares of a shift, of the scale too where ``rate``, and the samples that it sets aside, in turn until
    they stay; None where the two hardly overlap.

    within : span of the second's clock, s, to look at. names : channels, None for all, or the force alone where it is
    the same in both and the motion is not.
    """
    free, clock, period, used = 2 if rate else 1, start, pair.period, names or tuple(pair.noise)
    low, high = (start.shift - 0.5 * period, 0.5), (start.shift + 0.5 * period, 2.0)
    bounds = Bounds(*(np.array(one)[:free] for one in (low, high, (0.2 * period, 0.05))))

    def clock_of(at: FloatArray) -> Clock:
        return pair.clock(float(at[0]), float(at[1]) if rate else start.scale)

    for _ in range(_TURNS):
        keep = pair.kept(clock, within)
        if any(np.count_nonzero(k) < _FEWEST for k in keep.values()):
            return None

        def left(at: FloatArray, keep: Mapping[str, BoolArray] = keep) -> Residual:
            found = pair.residual(clock_of(at), keep, used)
            return Residual(found.residual, found.partials[:, :free])

        found = least_squares(left, np.array([clock.shift, clock.scale])[:free], Until(_MOVED**2), bounds)
        moved, clock = abs(float(found.coordinates[0]) - clock.shift), clock_of(found.coordinates)
        if moved**2 * float(np.sum(found.point.partials[:, 0] ** 2)) < _MOVED**2:
            break
    keep, seen = pair.kept(clock, within), pair.kept(clock)
    if any(np.count_nonzero(k) < _FEWEST for k in keep.values()):
        return None
    # what the clock leaves, over all samples
    shares, loud, count = {}, {}, {}
    for c, noise in pair.noise.items():
        second, first, _, _ = pair.left(clock, c, seen[c])
        floor = noise.sigma**2
        # an offset is no mistake of the clock
        apart, strangers = float(np.var(second - first)), float(np.var(second) + np.var(first))
        shares[c], loud[c] = (apart + floor) / (strangers + floor), apart / floor
        count[c] = int(np.count_nonzero(seen[c]))
    one = Candidate(pair, clock, keep, within, shares, loud, count)
    if names is not None or one.names == used:
        return one
    return refined(pair, one.clock, within, rate, one.names) or one


_SHOWS = 4.0
"""Standard errors from which clocks run differently: once in 16000 by chance."""
_MOST = 0.03
"""Largest difference of rate that is looked for; more is another motion."""
_STEP, _MOST_TRIED = 0.25, 41
"""Periods by which the ends of the traces move between two rates that are tried, and how many are: bounds the work."""
CLEARLY = 0.25
"""Share of the mean square that another rate must leave at most, and another shift than the releases'. Of two decays of
slightly different rate, moving one takes off half: with weight e^(-2s) the variance of s over its mean square."""
_DIFFER = (
    "the two differ by more than clocks do, and a clock that is fast cannot be distinguished from a stiffer spring"
)


def rated(pair: Pair, taken: Candidate) -> tuple[Quantity, Candidate]:
    """The scale that lays the two over each other, and the candidate to compare with: with that scale only where it is
    significant and a clock's.

    Where the two show one motion the scale is fitted from 1 on. Where they differ, rates up to 3 % are tried, and one
    is told that leaves nothing but noise. A motion's own frequency looks the same as the rate of a clock: beyond what
    clocks differ by, a scale is applied only where a force that drives both proves it.
    """
    fits = [refined(pair, clock, rate=True) for clock in ([taken.clock] if taken.same else _starts(pair, taken))]
    found = [one for one in fits if one is not None and one.same]
    if not found:
        return Quantity.refused("1", _DIFFER), taken
    best = min(found, key=lambda one: one.saved)
    scale = best.scale
    if not math.isfinite(scale.stderr or 0.0):
        return Quantity.refused("1", "the overlap is too short for it"), taken
    better = taken.same or best.mean_log < taken.mean_log + math.log(CLEARLY)
    clocks = not beyond_clocks(scale) or _by_force(pair, best)
    return scale, best if _differs(scale) and better and clocks else taken


def _differs(scale: Quantity) -> bool:
    """Whether two traces run at different rates, by more than chance."""
    return scale.value is not None and abs(scale.value - 1.0) > _SHOWS * (scale.stderr or 0.0)


def beyond_clocks(scale: Quantity) -> bool:
    """Whether the rates differ by more than two clocks do."""
    return _differs(scale) and scale.value is not None and abs(scale.value - 1.0) > CLOCK_RATE.value


def _by_force(pair: Pair, best: Candidate) -> bool:
    """Whether the force alone, which no parameter of the motion changes, runs at the same other rate."""
    alone = refined(pair, best.clock, rate=True, names=("u",)) if best.alike("u") else None
    if alone is None or not alone.alike("u"):
        return False
    errors = math.hypot(alone.scale.stderr or 0.0, best.scale.stderr or 0.0)
    return beyond_clocks(alone.scale) and abs(alone.clock.scale - best.clock.scale) < _SHOWS * errors


def _starts(pair: Pair, taken: Candidate) -> list[Clock]:
    """The few clocks that leave least, of all rates tried; the beginning of the overlap stays where it is."""
    t = pair.by_second(taken.clock)[pair.inside(pair.since(taken.clock))]
    step = max(_STEP * pair.period / float(t[-1] - t[0]), 2.0 * _MOST / (_MOST_TRIED - 1))
    rates = 1.0 + step * np.arange(-math.floor(_MOST / step), math.floor(_MOST / step) + 1)
    begin = float(t[0]) - taken.clock.shift - pair.origin

    def apart(clock: Clock) -> float:
        keep, total = pair.inside(pair.since(clock)), 0.0
        for c, noise in pair.noise.items():
            second, first, _, _ = pair.left(clock, c, keep)
            total += float(np.mean((second - first) ** 2)) / noise.sigma**2 if second.size else math.inf
        return total

    return sorted((pair.clock(taken.clock.shift + (1.0 - rate) * begin, float(rate)) for rate in rates), key=apart)[:3]
