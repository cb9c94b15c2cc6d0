"""Time alignment: global first, then fine; the shift that lays one trace over another, with its error.

Every shift is looked at at once, by sums of products over bins of time; the best few are refined, and so are their
neighbours a period away. Two traces of the same motion lie over each other to within the noise at one of them. Two that
differ are laid release on release, the event that a simulation and a recording of a free decay have in common: a motion
that decays too fast looks like a later piece of the other.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.diagnosis.alignment.candidate import CLEARLY, Candidate, beyond_clocks, rated, refined
from harness.diagnosis.alignment.pair import Clock, Pair, Signals
from harness.estimate.noise import Noise

_BINS = 40
"""Bins a period: two curves half a bin apart differ by 0.3 % of their power."""
_MOST_BINS = 4_000_000
"""Bounds the memory of the transforms: 32 MB a channel."""
_LEAST_SHARED = 0.15
"""Share of the shorter trace that must lie over the other."""
_CANDIDATES, _APART = 9, 0.3
"""Shifts that are refined, which bounds the work, and the share of a period between two: nearer ones are one."""


def _candidates(pair: Pair, first: Signals, second: Signals) -> list[float]:
    """Shifts (s, of the first's times) at which the traces differ least, the best first.

    A shift saves n log((s^2 + e) / (s0^2 + e)) a channel: n bins overlap, s^2 is the mean square difference, offset
    apart, s0^2 that of two strangers with the variances seen there, e the noise of a bin. So a long overlap is worth as
    much as a close one, and two traces at rest, or hiding from each other, are worth nothing.
    Raises InputError for traces too long for their period.
    """
    traces, width = (first, second), pair.period / _BINS
    total = sum(float(one.t[-1] - one.t[0]) for one in traces) / width
    if total > _MOST_BINS:
        found = f"{total / _BINS:.3g} periods that the shift may be anywhere in"
        accepted = f"traces of at most {_MOST_BINS / _BINS:.0e} periods together"
        raise InputError("time alignment", found, accepted)
    from scipy.signal import correlate

    sizes = [max(int((one.t[-1] - one.t[0]) / width), 1) for one in traces]
    lags = np.arange(1 - sizes[0], sizes[1])
    low, high = np.maximum(0, -lags), np.minimum(sizes[0], sizes[1] - lags)
    count = (high - low).astype(np.float64)
    saved = np.zeros(lags.size)

    def summed(values: FloatArray, delay: np.ndarray | int) -> FloatArray:
        """Over what overlaps, by lag."""
        so_far = np.concatenate([[0.0], np.cumsum(values)])
        return np.asarray(so_far[high + delay] - so_far[low + delay])

    for c, level in pair.noise.items():
        f, y = (_binned(one.t, one.channels[c], width, n) for one, n in zip(traces, sizes, strict=True))
        middle, size = 0.5 * (f.mean() + y.mean()), math.sqrt(0.5 * (f.var() + y.var())) or 1.0
        f, y = (f - middle) / size, (y - middle) / size
        sums = [summed(values, d) for values, d in ((f, 0), (y, lags), (f * f, 0), (y * y, lags))]
        product = correlate(y, f, method="fft")
        strangers = sums[2] + sums[3] - (sums[0] ** 2 + sums[1] ** 2) / count
        apart = sums[2] + sums[3] - 2.0 * product - (sums[0] - sums[1]) ** 2 / count
        interval = max(float(np.median(np.diff(one.t))) for one in traces)
        e = count * ((level.sigma / size) ** 2 * min(1.0, interval / width) + 1e-6)
        saved += count * np.log((np.maximum(apart, 0.0) + e) / (np.maximum(strangers, 0.0) + e))
    saved[count < max(_LEAST_SHARED * min(sizes), min(_BINS, *sizes))] = math.inf
    shifts = np.asarray(float(second.t[0] - first.t[0]) + lags * width, dtype=np.float64)
    padded = np.concatenate([[math.inf], saved, [math.inf]])
    dips = np.flatnonzero((saved <= padded[:-2]) & (saved <= padded[2:]) & np.isfinite(saved))
    lowest: list[float] = []
    for i in dips[np.argsort(saved[dips], kind="stable")]:
        if all(abs(shifts[i] - one) > _APART * pair.period for one in lowest):
            lowest.append(float(shifts[i]))
            if len(lowest) == _CANDIDATES:
                break
    return lowest


def _binned(t: FloatArray, y: FloatArray, width: float, count: int) -> FloatArray:
    """Means (count,) of a channel over bins, from its first sample on."""
    area = np.concatenate([[0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(t))])
    return np.asarray(np.diff(np.interp(t[0] + width * np.arange(count + 1), t, area)) / width)


_LEAVES, _SIGMAS, _IN_A_ROW = 0.02, 6.0, 3
"""A channel has left its first value when it is this share of its range, and so many sigma, away, for so many samples
in a row: a stray one is none."""
_HELD = 0.15
"""Periods after which a channel that has not left its first value was held: from a turning point it leaves by 2 % of
the range within arccos(0.96) / (2 pi) = 0.045 of a period."""
_SLOW = 0.02
"""In full motion it leaves within 0.006 of a period; a trace that takes longer began at a turning point."""


def _release(trace: Signals, noise: Mapping[str, Noise], period: float) -> float | None:
    """When a trace is let go, s; None for one that begins in full motion; period in s."""
    t, leaves = trace.t, []
    for c in (c for c in ("x", "v", "a") if c in noise):
        y = trace.channels[c]
        begin = max(int(np.searchsorted(t, t[0] + period / 40.0)), 1)
        away = np.abs(y - np.median(y[:begin])) > max(_SIGMAS * noise[c].sigma, _LEAVES * float(np.ptp(y)))
        run = np.convolve(away.astype(np.int64), np.ones(_IN_A_ROW, dtype=np.int64), "valid") == _IN_A_ROW
        found = np.flatnonzero(run)
        # the last time at which the channel still is where it began
        leaves.append(float(t[max(int(found[0]) - 1, 0)] if found.size else t[-1]))
    if not leaves:
        return None
    start, first, last = float(t[0]), min(leaves), max(leaves)
    return first if first - start > _HELD * period else start if last - start > _SLOW * period else None


GIVEN = "given"
"""Why a shift has no error."""
_SHOWS = 3.0
"""Standard errors below which a shift is none."""
_EVIDENCE = 25.0
"""A shift other than the releases' is taken where nothing but noise is left, too, when twice the logarithm of its
likelihood ratio is this: five sigma."""
_TOLD = 4
"""Other shifts that are told."""
_THIN = 20_000
"""Samples with which candidates are refined."""
LEAST_SHARED = 0.5
"""Share of a trace of which more than half should be shown to speak of it as a whole."""
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
        shift, scale, clock = Quantity(given, None, "s", GIVEN), Quantity(1.0, None, "1", GIVEN), Clock(given)
        return Alignment(shift, scale, clock, _covered(first, second, clock))
    pair = Pair(first, second, noise, period, _THIN)
    looked = _candidates(pair, first, second)
    # a motion that differs would pull the clock off the force that is the same
    sets = (None, ("u",)) if "u" in noise else (None,)
    tried = [refined(pair, pair.clock(shift), names=names) for shift in looked for names in sets]
    found = [one for one in tried if one is not None]
    preferred = _preferred(first, second, pair)
    if not found and preferred is None:
        raise InputError("time alignment", "traces that overlap nowhere", "two traces of one motion")
    taken = _taken(found, preferred)
    by_release = preferred is taken
    # what two traces have of noise in common, and what a curve between noisy samples has less of it, makes small dips
    # beside the true one: the lowest of those within some samples
    starts = (pair.clock(taken.clock.shift + k * pair.interval, taken.clock.scale) for k in _NUDGES)
    around = [refined(pair, clock, taken.within, names=taken.names) for clock in starts]
    taken = min((taken, *(one for one in around if one is not None)), key=lambda one: one.saved)
    scale, taken = rated(pair, taken)
    around = [refined(pair, replace(taken.clock, shift=taken.clock.shift + k * period)) for k in (-1, 1)]
    others: list[Candidate] = []
    for one in sorted((one for one in (*around, *found) if one is not None), key=lambda one: one.mean_log):
        # each once, the closest match first
        if all(abs(one.clock.shift - other.clock.shift) > _APART * period for other in (taken, *others)):
            others.append(one)
    final = taken.on(Pair(first, second, noise, period))
    shift_found, local = final.clock.shift, math.sqrt(float(final.covariance(final.clock.scale != 1.0)[0, 0]))
    clock = final.clock if abs(shift_found) >= _SHOWS * local else replace(final.clock, shift=0.0)
    # it may be one of the others, each as likely as its match says
    weights = np.array([math.exp(-0.5 * min(max(taken.ahead(one), 0.0), 1400.0)) for one in others])
    away = np.array([one.clock.shift - taken.clock.shift for one in others])
    cycles = math.sqrt(float(weights @ away**2) / (1.0 + float(weights.sum()))) if others else 0.0
    shift = Quantity(shift_found, local if by_release else math.hypot(local, cycles), "s")
    told = tuple(Alternative(one.clock.shift, _share(one, taken)) for one in others[:_TOLD])
    return Alignment(shift, scale, clock, _covered(first, second, clock), told)


def _preferred(first: Signals, second: Signals, pair: Pair) -> Candidate | None:
    """Release on release where both show one; else one clock for both where they overlap by half by their clocks."""
    begins = [_release(one, pair.noise, pair.period) for one in (first, second)]
    if begins[0] is not None and begins[1] is not None:
        # only the first half swing: what follows differs by more than the shift
        span = (begins[1] - pair.period, begins[1] + 0.5 * pair.period)
        return refined(pair, pair.clock(begins[1] - begins[0]), span)
    overlap = min(first.t[-1], second.t[-1]) - max(first.t[0], second.t[0])
    if overlap < LEAST_SHARED * min(first.t[-1] - first.t[0], second.t[-1] - second.t[0]):
        return None
    found = refined(pair, pair.clock(0.0))
    return found if found is not None and abs(found.clock.shift) < _SAME_CLOCK * pair.period else None


def _taken(found: list[Candidate], preferred: Candidate | None) -> Candidate:
    """The candidate that saves most, unless the two differ there and are known to begin together elsewhere."""
    if not found:
        assert preferred is not None
        return preferred
    best = min(found, key=lambda one: one.saved)
    if preferred is None:
        return best
    by_noise = best.within_noise and best.ahead(preferred) > _EVIDENCE
    if best.same and (by_noise or _share(best, preferred) < CLEARLY):
        return best
    near = min(found, key=lambda one: abs(one.clock.shift - preferred.clock.shift))
    # the same dip: refined over all samples if they agree there
    if near.same and abs(near.clock.shift - preferred.clock.shift) < preferred.reach:
        return near
    return preferred


def _share(one: Candidate, other: Candidate) -> float:
    """Mean square difference of one over that of the other, each against strangers; the geometric mean of channels."""
    return math.exp(min(one.mean_log - other.mean_log, 700.0))


def _covered(first: Signals, second: Signals, clock: Clock) -> BoolArray:
    interval = float(np.median(np.diff(first.t)))
    since: FloatArray = clock.back(second.t)
    covered: BoolArray = (since >= first.t[0] - interval) & (since <= first.t[-1] + interval)
    return covered
