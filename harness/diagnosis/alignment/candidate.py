"""One way in which two traces may lie over each other: refined, and what it leaves."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.alignment.pair import Clock, Pair
from harness.fit.least_squares import Bounds, Residual, Until, least_squares

_FEWEST = 8
"""Samples of a channel that traces must share."""
_TURNS = 12
"""Steps of a refinement; it ends sooner where a shift no longer moves."""
_MOVED = 1e-6
"""Standard errors by which a shift may still move when it is found."""
SAME = 1.5
"""Mean square over the noise's up to which a channel is that of the same motion."""
_ALIKE = 1e-3
"""Or: its share of the mean square of strangers, for traces without noise."""
EVERYWHERE = (-math.inf, math.inf)


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
        return c in self.loud and (self.loud[c] < SAME or self.shares[c] < _ALIKE)

    @property
    def same(self) -> bool:
        """Whether the two show the same motion, or are driven by the same force."""
        return self.alike("u") or all(self.alike(c) for c in self.loud)

    @property
    def within_noise(self) -> bool:
        """Whether noise is all that is left of every channel."""
        return all(power < SAME for power in self.loud.values())

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

    def inflation(self, period: float) -> float:
        """Variance of a mean over that of as many independent samples: colour of the noise, or a mismatch that says one
        thing for about a quarter of a period.
        """
        omega = 2.0 * math.pi / period
        colour = max(self.pair.noise[c].inflation(omega, self.pair.interval) for c in self.names)
        loud = float(np.mean([self.loud[c] for c in self.names]))
        return max(colour, loud * 0.25 * period / self.pair.interval) if loud > SAME else max(colour, 1.0)

    def ahead(self, other: "Candidate", period: float) -> float:
        """Twice the logarithm of this one's likelihood over that of another, for as many independent pieces as there
        are: samples of noise, or quarters of a period where more than noise is left.
        """
        pieces = max(self.inflation(period) / max(float(np.mean(list(self.loud.values()))), 1.0), 1.0)
        return sum(n / pieces * math.log(other.shares[c] / self.shares[c]) for c, n in self.count.items())

    def on(self, pair: Pair, period: float) -> "Candidate":
        """The same, refined further on traces that were not thinned."""
        return refined(pair, self.clock, period, self.within, self.clock.scale != 1.0, self.names) or self

    def covariance(self, period: float, rate: bool) -> FloatArray:
        """Of the shift (s), and of the scale where ``rate``: (1, 1) or (2, 2); infinite where nothing moves."""
        partials = self.pair.residual(self.clock, self.keep, self.names).partials[:, : 2 if rate else 1]
        normal = partials.T @ partials / self.inflation(period)
        if not np.all(np.diag(normal) > 0.0):
            return np.full(normal.shape, math.inf)
        size = np.sqrt(np.diag(normal))
        return np.asarray(np.linalg.pinv(normal / np.outer(size, size)) / np.outer(size, size))

    def error(self, period: float) -> float:
        """Standard error of the shift within its cycle, s."""
        return math.sqrt(float(self.covariance(period, self.clock.scale != 1.0)[0, 0]))


def refined(
    pair: Pair,
    start: Clock,
    period: float,
    within: tuple[float, float] = EVERYWHERE,
    rate: bool = False,
    names: tuple[str, ...] | None = None,
) -> Candidate | None:
    """The least squares of a shift, of the scale too where ``rate``, and the samples that it sets aside, in turn until
    they stay; None where the two hardly overlap.

    within : span of the second's clock, s, to look at. names : channels, None for all, or the force alone where it is
    the same in both and the motion is not.
    """
    free, clock = 2 if rate else 1, start
    used = names or tuple(pair.noise)
    bounds = Bounds(
        np.array([start.shift - 0.5 * period, 0.5])[:free],
        np.array([start.shift + 0.5 * period, 2.0])[:free],
        np.array([0.2 * period, 0.05])[:free],
    )

    def clock_of(at: FloatArray) -> Clock:
        return Clock(float(at[0]), float(at[1]) if rate else start.scale, pair.origin)

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
    one = _judged(pair, clock, within)
    if one is None or names is not None or one.names == used:
        return one
    return refined(pair, one.clock, period, within, rate, one.names) or one


def _judged(pair: Pair, clock: Clock, within: tuple[float, float]) -> Candidate | None:
    """What a clock leaves, over all samples; None where the two hardly overlap."""
    keep, seen = pair.kept(clock, within), pair.kept(clock)
    if any(np.count_nonzero(k) < _FEWEST for k in keep.values()):
        return None
    shares, loud, count = {}, {}, {}
    for c, noise in pair.noise.items():
        second, first, _, _ = pair.left(clock, c, seen[c])
        floor = noise.sigma**2
        # an offset is no mistake of the clock
        apart, strangers = float(np.var(second - first)), float(np.var(second) + np.var(first))
        shares[c], loud[c] = (apart + floor) / (strangers + floor), apart / floor
        count[c] = int(np.count_nonzero(seen[c]))
    return Candidate(pair, clock, keep, within, shares, loud, count)
