"""Time alignment: global first, then fine; the shift that lays one trace over another, with its error.

Every shift is looked at (coarse), the best few are refined, and so are their neighbours a period away. Two traces of
the same motion lie over each other to within the noise at one of them. Two that differ are laid release on release,
since a motion that decays too fast looks like a later piece of the other.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.diagnosis.alignment.candidate import Candidate, refined
from harness.diagnosis.alignment.coarse import candidates
from harness.diagnosis.alignment.pair import Clock, Pair, Signals
from harness.diagnosis.alignment.rate import beyond_clocks, rated
from harness.diagnosis.alignment.release import release
from harness.estimate.noise import Noise

GIVEN = "given"
"""Why a shift has no error."""
_SHOWS = 3.0
"""Standard errors below which a shift is none."""
_CLEARLY = 0.25
"""A shift other than the releases' is taken when it leaves at most this share of the mean square. Of two decays of
slightly different rate, moving one takes off half: with weight e^(-2s) the variance of s over its mean square."""
_EVIDENCE = 25.0
"""Or, where nothing but noise is left, when twice the logarithm of its likelihood ratio is this: five sigma."""
_TOLD = 4
"""Other shifts that are told."""
_THIN = 20_000
"""Samples with which candidates are refined."""
LEAST_SHARED = 0.5
"""Share of a trace of which more than half should be shown to speak of it as a whole."""
_ELSEWHERE = 0.3
"""Periods from which another shift is another one: candidates are looked for as far apart (coarse)."""
_NUDGES = (-2.0, -1.5, -1.0, -0.5, 0.5, 1.0, 1.5, 2.0)
"""Sampling intervals by which a shift is pushed, to see whether it falls deeper."""
_SAME_CLOCK = 0.6
"""Periods by which traces of one clock may be apart, where neither shows its release."""


@dataclass(frozen=True, slots=True)
class Alternative:
    """A shift that was tried as well, s. worse_by : mean square difference over that of the shift taken, as a share of
    what two strangers would differ by; below 1 where it was closer and yet not taken.
    """

    shift: float
    worse_by: float


@dataclass(frozen=True, slots=True)
class Alignment:
    """shift : s, to be added to the first trace's time at its first sample; its error knows of the cycles that cannot
    be told apart, local is that within its cycle. scale : seconds of the second for one of the first, applied in clock
    only as far as it is a clock's. covered : samples (n,) of the second where the first then has something to show, to
    within a sampling interval.
    """

    shift: Quantity
    scale: Quantity
    clock: Clock
    covered: BoolArray
    alternatives: tuple[Alternative, ...] = ()

    @property
    def used(self) -> float:
        """The shift applied, s; 0 where that found is none: samples at the same instants need no interpolation then."""
        return self.clock.shift

    @property
    def faster(self) -> bool:
        """Whether one runs faster than the other by more than clocks do: in frequency or by its clock, nothing says."""
        return beyond_clocks(self.scale) and self.clock.scale == 1.0


def align(
    first: Signals, second: Signals, noise: Mapping[str, Noise], period: float, given: float | None = None
) -> Alignment:
    """Shift the first trace in time so that it differs least from the second, in units of the noise.

    noise : of the difference, for each channel to look at; u counts like any other. period : of the motion, s. given :
    a shift, s, that is taken as it is. Raises InputError when the two are too long for the period, or never overlap.
    """
    if given is not None:
        why = GIVEN
        clock = Clock(given)
        return Alignment(
            Quantity(given, None, "s", why), Quantity(1.0, None, "1", why), clock, _covered(first, second, clock)
        )
    pair = Pair(first, second, noise, period, _THIN)
    looked = candidates(first, second, noise, period)
    # a motion that differs would pull the clock off the force that is the same
    sets = (None, ("u",)) if "u" in noise else (None,)
    tried = [refined(pair, Clock(shift, 1.0, pair.origin), period, names=names) for shift in looked for names in sets]
    found = [one for one in tried if one is not None]
    preferred = _preferred(first, second, pair, noise, period)
    if not found and preferred is None:
        raise InputError("time alignment", "traces that overlap nowhere", "two traces of one motion are accepted")
    taken = _taken(found, preferred, period)
    by_release = preferred is taken
    taken = _deepest(pair, taken, period)
    scale, taken = rated(pair, taken, period)
    beside = [replace(taken.clock, shift=taken.clock.shift + k * period) for k in (-1, 1)]
    around = [refined(pair, clock, period) for clock in beside]
    others = _distinct([one for one in (*around, *found) if one is not None], taken, period)
    final = taken.on(Pair(first, second, noise, period), period)
    shift = final.clock.shift
    local = final.error(period)
    clock = final.clock if abs(shift) >= _SHOWS * local else replace(final.clock, shift=0.0)
    error = local if by_release else math.hypot(local, _cycles(taken, others, period))
    told = tuple(Alternative(one.clock.shift, _share(one, taken)) for one in others[:_TOLD])
    return Alignment(Quantity(shift, error, "s"), scale, clock, _covered(first, second, clock), told)


def _preferred(
    first: Signals, second: Signals, pair: Pair, noise: Mapping[str, Noise], period: float
) -> Candidate | None:
    """Release on release where both show one; else one clock for both where they overlap by half by their clocks."""
    begins = release(first, noise, period), release(second, noise, period)
    if begins[0] is not None and begins[1] is not None:
        # only the first half swing: what follows differs by more than the shift
        span = (begins[1].time - period, begins[1].time + 0.5 * period)
        return refined(pair, Clock(begins[1].time - begins[0].time, 1.0, pair.origin), period, span)
    overlap = min(first.t[-1], second.t[-1]) - max(first.t[0], second.t[0])
    if overlap < LEAST_SHARED * min(first.t[-1] - first.t[0], second.t[-1] - second.t[0]):
        return None
    found = refined(pair, Clock(0.0, 1.0, pair.origin), period)
    return found if found is not None and abs(found.clock.shift) < _SAME_CLOCK * period else None


def _taken(found: list[Candidate], preferred: Candidate | None, period: float) -> Candidate:
    """The candidate that saves most, unless the two differ there and are known to begin together elsewhere."""
    if not found:
        assert preferred is not None
        return preferred
    best = min(found, key=lambda one: one.saved)
    if preferred is None:
        return best
    by_noise = best.within_noise and best.ahead(preferred, period) > _EVIDENCE
    if best.same and (by_noise or _share(best, preferred) < _CLEARLY):
        return best
    near = min(found, key=lambda one: abs(one.clock.shift - preferred.clock.shift))
    # the same dip: refined over all samples if they agree there
    if near.same and abs(near.clock.shift - preferred.clock.shift) < preferred.reach:
        return near
    return preferred


def _deepest(pair: Pair, taken: Candidate, period: float) -> Candidate:
    """The lowest of the dips within some samples of a candidate: what two traces have of noise in common, and what a
    curve between noisy samples has less of it, makes small ones beside the true one.
    """
    starts = (replace(taken.clock, shift=taken.clock.shift + k * pair.interval) for k in _NUDGES)
    around = [refined(pair, clock, period, taken.within, names=taken.names) for clock in starts]
    return min((taken, *(one for one in around if one is not None)), key=lambda one: one.saved)


def _share(one: Candidate, other: Candidate) -> float:
    """Mean square difference of one over that of the other, each against strangers; the geometric mean of channels."""
    return math.exp(min(one.mean_log - other.mean_log, 700.0))


def _distinct(found: list[Candidate], taken: Candidate, period: float) -> list[Candidate]:
    """Other shifts, each once, the closest match first."""
    kept: list[Candidate] = []
    for one in sorted(found, key=lambda one: one.mean_log):
        if all(abs(one.clock.shift - other.clock.shift) > _ELSEWHERE * period for other in (taken, *kept)):
            kept.append(one)
    return kept


def _cycles(taken: Candidate, others: list[Candidate], period: float) -> float:
    """Standard deviation, s, of a shift that may be one of the others, each as likely as its match says."""
    weights = np.array([math.exp(-0.5 * min(max(taken.ahead(one, period), 0.0), 1400.0)) for one in others])
    away = np.array([one.clock.shift - taken.clock.shift for one in others])
    return math.sqrt(float(weights @ away**2) / (1.0 + float(weights.sum()))) if others else 0.0


def _covered(first: Signals, second: Signals, clock: Clock) -> BoolArray:
    interval = float(np.median(np.diff(first.t)))
    since: FloatArray = clock.back(second.t)
    covered: BoolArray = (since >= first.t[0] - interval) & (since <= first.t[-1] + interval)
    return covered
