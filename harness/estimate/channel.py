"""One channel of a free decay, from samples to a fit: reversals, guard, half-cycles apart, all of them tied."""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.estimate.halfcycles import SeparateFit, fit_separately, moved_edges, windows
from harness.estimate.means import ENOUGH, FINISHED, means
from harness.estimate.noise import Noise, channel_noise
from harness.estimate.reversals import MINIMUM_HALF_CYCLES, HalfCycles, Kind, NoDecay, find_half_cycles, period_of
from harness.estimate.sequence import powers
from harness.estimate.tied import OFFSET, OMEGA, P0, SIGMA, T0, D, TiedFit, fit_tied, value_at

WIDEST = 0.15
"""The guard is at most this share of a half-cycle on each side."""


def find_guard(t: FloatArray, y: FloatArray, fit: SeparateFit, variance: float) -> float:
    """Guard in s for a channel y (n,) from a fit made with the widest guard; 0 when the jumps are sharp.

    Squares of residual over predicted deviation are summed by distance from the nearest inner edge, both sides
    together. variance : of one sample, the larger of the noise's and the fit's own.
    """
    edges = fit.edges
    half = float(np.median(np.diff(edges)))  # the fitted frequency can be far off in much noise
    reach = WIDEST * half
    # bins of a sample, but few enough for each to hold several half-cycles' worth
    width = max(float(np.median(np.diff(t))), reach / 60.0)
    bins = max(int(np.ceil(reach / width)), 1)
    within = (t >= edges[0]) & (t < edges[-1])
    time, value = t[within], y[within]
    k = np.searchsorted(edges, time, side="right") - 1
    since, rest = time - edges[k], edges[k + 1] - time
    # the outermost edges are a release, a stop or the record's end: no jump between two forms
    before, after = (k < len(fit) - 1) & (rest <= reach), (k > 0) & (since < reach)
    distance = np.where(before, rest, since)
    near = before | after
    k, distance, basis = k[near], distance[near], fit.basis(k, time)[near]
    left = value[near] - np.sum(basis * fit.c[k], axis=1)
    spread = variance * (1.0 + np.einsum("ni,nij,nj->n", basis, fit.inverse[k], basis))
    place = np.minimum((distance / width).astype(np.int64), bins - 1)
    square, count = np.bincount(place, left**2 / spread, bins), np.bincount(place, minlength=bins)
    bad = np.flatnonzero(square - count - 4.5 * np.sqrt(2.0 * count) - 8.0 * (count > 0) > 0.0)
    return float(min((bad[-1] + 1) * width, reach)) if bad.size else 0.0


_EXPLORED = 256
"""Samples a half-cycle that a first look needs."""
_PIECE = 1 << 17
"""Samples whose forms are evaluated at a time."""


@dataclass(frozen=True, slots=True)
class ChannelFit:
    """What the closed forms say about one channel.

    separate : half-cycles apart. tied : all as one motion. holds : the tied form explains the channel as well as the
    separate ones do; when it does not, friction acts at other times or other ways than the base model's.
    offset : constant found in the channel and taken away. inflation : variance of smooth combinations over what white
    noise would give. y : the channel less the offset, of very many samples means; noise, variance : of one of these.
    recorded : noise of a sample as it was recorded. dropped : the first period was left out.
    """

    kind: Kind
    t: FloatArray
    y: FloatArray
    noise: Noise
    recorded: Noise
    cycles: HalfCycles
    separate: SeparateFit
    tied: TiedFit
    holds: bool
    offset: float
    inflation: float
    dropped: bool

    @property
    def sigma(self) -> float:
        """zeta omega_n in 1/s, from whichever form holds."""
        return float(self.tied.theta[SIGMA]) if self.holds else self.separate.sigma

    @property
    def omega(self) -> float:
        """Damped frequency in rad/s, from whichever form holds."""
        return float(self.tied.theta[OMEGA]) if self.holds else self.separate.omega

    @property
    def edges(self) -> FloatArray:
        """Times of release, reversals and stop, (K+1,) s."""
        return self.tied.edges if self.holds else self.separate.edges

    @property
    def variance(self) -> float:
        """Variance of one sample, coloured noise counted as it acts on smooth combinations."""
        return (self.tied if self.holds else self.separate).variance * self.inflation

    @property
    def guard(self) -> float:
        """Time left out on each side of a reversal, s."""
        return self.separate.guard


def _tied_start(fit: SeparateFit) -> FloatArray:
    """Start of the tied fit (6,): half-cycle time by regression, swings by linear least squares on the separate
    ones.
    """
    edges = fit.edges
    inner = edges[1:-1] if edges.size > 4 else edges
    index = np.arange(edges.size)[1:-1] if edges.size > 4 else np.arange(edges.size)
    slope, at_zero = np.polyfit(index, inner, 1)
    omega = math.pi / float(slope)
    sigma = float(np.clip(fit.sigma, -0.02 * omega, 1.5 * omega))
    every = np.arange(len(fit))
    first, last = fit.value(every, edges[:-1]), fit.value(every, edges[1:])
    if fit.kind is Kind.ACCELERATION:
        begin, finish = np.abs(first), np.abs(last)
    elif fit.kind is Kind.VELOCITY:
        begin = omega * np.hypot(fit.c[:, 0], fit.c[:, 1])
        finish = begin * math.exp(-math.pi * sigma / omega)
    else:
        begin, finish = (np.abs(end - fit.c[:, 2]) * (sigma**2 + omega**2) for end in (first, last))
    # begin_k = q^k P_0 - 2 D (1 + q + .. + q^(k-1)) and finish_k = q begin_k, both linear once q is known
    q = math.exp(-math.pi * sigma / omega)
    power, _, total, _ = powers(q, begin.size)
    use = slice(1, -1) if begin.size > 4 else slice(None)
    rows = np.stack([power, -2.0 * total], 1)[use]
    swing, drop = np.linalg.lstsq(np.concatenate([rows, q * rows]), np.concatenate([begin[use], finish[use]]))[0]
    theta = np.zeros(6)
    theta[[SIGMA, OMEGA, D, P0, T0]] = sigma, omega, drop, swing, at_zero
    return theta


def _half_cycles_moving(fit: TiedFit, t: FloatArray, y: FloatArray, start: int) -> int:
    """How many half-cycles there are: up to where resting explains the samples better than moving on (>= start)."""
    ahead = int(min((t[-1] - fit.theta[T0]) / fit.half_time + 1.0, fit.count + 400))
    swings = fit.swings(max(ahead, fit.count) + 1)
    gain, best, count = 0.0, 0.0, start
    for k in range(start, ahead):
        if not 0.0 < swings[k] < 1e6 * swings[0]:
            break
        first = fit.theta[T0] + k * fit.half_time
        part = slice(*np.searchsorted(t, [first + fit.guard, first + fit.half_time - fit.guard]))
        if part.stop - part.start < 2:
            break
        move = y[part] - value_at(t[part], fit.kind, fit.theta, fit.side, k + 1)
        rest = y[part] - y[part].mean()
        gain += float(rest @ rest - move @ move)
        if gain > best:
            best, count = gain, k + 1
    return count


def _fit_tied(
    t: FloatArray,
    y: FloatArray,
    separate: SeparateFit,
    cycles: HalfCycles,
    begin: float,
    noisy: bool,
    offset: bool,
    seed: TiedFit | None,
) -> TiedFit:
    """The tied fit with as many half-cycles as the samples support."""
    kind, guard = separate.kind, separate.guard
    count = len(separate) if seed is None else seed.count
    theta, span = _tied_start(separate) if seed is None else seed.theta, (begin, float(t[-1]))
    fit = fit_tied(t, y, kind, theta, cycles.side, count, guard, span, offset)
    if seed is not None:
        return fit
    for _ in range(4):
        supported = max(_half_cycles_moving(fit, t, y, max(count - 2, 2)), 2)
        if supported == fit.count:
            break
        fit = fit_tied(t, y, kind, fit.theta, cycles.side, supported, guard, span, offset)
    # near the noise the fit that stops early and the fit that goes on differ: try both, keep the likelier
    for further in range(fit.count + 1, fit.count + 3):
        if fit.theta[T0] + (further - 0.5) * fit.half_time > t[-1] or not noisy:
            break
        longer = fit_tied(t, y, kind, fit.theta, cycles.side, further, guard, span, offset)
        if longer.swings(further)[-1] > 0.0 and longer.squares < fit.squares + _rest_squares(fit, longer, t, y):
            fit = longer
    return fit


def _rest_squares(fit: TiedFit, longer: TiedFit, t: FloatArray, y: FloatArray) -> float:
    """Sum of squares about rest over the half-cycles that ``longer`` has and ``fit`` has not."""
    total = 0.0
    for k in range(fit.count, longer.count):
        first = longer.theta[T0] + k * longer.half_time
        part = y[slice(*np.searchsorted(t, [first + fit.guard, first + longer.half_time - fit.guard]))]
        total += float(np.sum((part - part.mean()) ** 2)) if part.size else 0.0
    return total


def _tie_holds(
    t: FloatArray, y: FloatArray, tied: TiedFit, separate: SeparateFit, floor: float, inflation: float
) -> bool:
    """Whether freeing every half-cycle explains no more than chance would (an F test at about 1e-4)."""
    free = fit_separately(t, y, tied.kind, tied.edges, tied.guard, (float(tied.theta[SIGMA]), float(tied.theta[OMEGA])))
    extra = tied.freedom - free.freedom
    if extra <= 0:
        return True
    level = max(min(free.variance, separate.variance), floor) * inflation
    return (tied.squares - free.variance * free.freedom) / extra < level * (1.0 + 6.0 * math.sqrt(2.0 / extra))


def fit_channel(t: FloatArray, y: FloatArray, kind: Kind, drop_first: bool = False) -> ChannelFit:
    """Fit the free decay in a channel ``y`` (n,) sampled at ``t`` (n,) in s.

    drop_first : leave out the first period, which a release by hand distorts. It is also left out when the rest is one
    motion of the base model and the whole is not; ``dropped`` then says so. Raises NoDecay with the reason when there
    is no free decay of three half-cycles or more.
    """
    spread = float(np.std(y))
    if spread == 0.0:
        raise NoDecay("the channel is constant")
    noise = channel_noise(t, y)
    noise = channel_noise(t, y, period_of(t, y, kind, noise))
    cycles = find_half_cycles(t, y, kind, noise)
    if drop_first:
        if len(cycles) < MINIMUM_HALF_CYCLES + 2:
            raise NoDecay(
                f"{len(cycles)} half-cycles found: without the first period fewer than {MINIMUM_HALF_CYCLES} are left"
            )
        return _fit(t, y, kind, noise, _later(cycles), True)
    fit = _fit(t, y, kind, noise, cycles, False)
    if noise.found and not fit.holds and len(cycles) >= MINIMUM_HALF_CYCLES + 2:
        later = _fit(t, y, kind, noise, _later(cycles), True)
        if later.holds and later.tied.variance < 0.5 * fit.separate.variance:
            return later
    return fit


def _later(cycles: HalfCycles) -> HalfCycles:
    """The half-cycles after the first period."""
    return HalfCycles(cycles.edges[2:], cycles.side, False)


def _fit(t: FloatArray, y: FloatArray, kind: Kind, noise: Noise, cycles: HalfCycles, dropped: bool) -> ChannelFit:
    centre = float(y.mean()) if kind is Kind.DISPLACEMENT else 0.0
    # one layout, writable and dense: a kernel is compiled once for each
    t, y = np.array(t), y - centre
    # explored on fewer samples, finished on all of them, or on means where they are very many
    many = cycles.half_time / float(np.median(np.diff(t)))
    stride, size = int(many / _EXPLORED), min(int(many / FINISHED), t.size // ENOUGH)
    few = np.array((t[:: max(stride, 1)], y[:: max(stride, 1)]))
    seed = _fit_once(few[0], few[1], kind, noise, cycles, dropped, None) if stride > 1 else None
    if seed is not None and size > 1:
        t, y = _in_means(t, y, seed.separate, size)
    fit = _fit_once(t, y, kind, noise.of_means(max(size, 1)), cycles, dropped, seed)
    return replace(fit if centre == 0.0 else _shifted(fit, centre), recorded=noise)


def _in_means(t: FloatArray, y: FloatArray, fit: SeparateFit, size: int) -> tuple[FloatArray, FloatArray]:
    """Times and values of each ``size`` neighbours: means of what a first fit leaves, on its form at their mean time.

    What it leaves does not bend within them as the motion does.
    """

    def form(time: FloatArray) -> FloatArray:
        k = np.clip(np.searchsorted(fit.edges, time, side="right") - 1, 0, len(fit) - 1)
        inside = (time >= fit.edges[0]) & (time <= fit.edges[-1])
        return np.where(inside, fit.value(k, np.where(inside, time, fit.edges[0])), 0.0)

    piece = max(_PIECE // size, 1) * size
    left = [means(y[at : at + piece] - form(t[at : at + piece]), size) for at in range(0, t.size, piece)]
    time = means(t, size)
    return time, np.concatenate(left) + form(time)


def _shifted(fit: ChannelFit, centre: float) -> ChannelFit:
    """Put back the mean that was taken away for the sake of rounding."""
    fit.separate.c[:, 2] += centre
    fit.tied.theta[OFFSET] += centre
    return replace(fit, y=fit.y + centre)


def _refuse_driven(t: FloatArray, y: FloatArray, separate: SeparateFit, floor: float) -> None:
    """Raise NoDecay for a motion that goes back and forth without decaying and without being a sine between
    reversals.
    """
    at, cycle = windows(t, separate.edges, separate.guard)
    begin = np.flatnonzero(np.diff(cycle, prepend=-1))
    swing = np.maximum.reduceat(y[at], begin) - np.minimum.reduceat(y[at], begin)
    lasting = float(np.median(swing[-3:])) > 0.9 * float(np.median(swing[:3]))
    odd = separate.variance > 1e-4 * float(np.var(y[at[0] : at[-1] + 1])) + 9.0 * floor
    if odd and lasting:
        raise NoDecay(
            "the motion goes to and fro without decaying and is no oscillation of a spring: driven, no free decay"
        )


def _fit_once(
    t: FloatArray, y: FloatArray, kind: Kind, noise: Noise, cycles: HalfCycles, dropped: bool, seed: ChannelFit | None
) -> ChannelFit:
    interval = float(np.median(np.diff(t)))
    half = cycles.half_time
    floor = noise.sigma**2
    edges, start = cycles.edges, (0.05 * math.pi / half, math.pi / half)
    # a last piece that is too short to be fitted by itself goes
    edges = edges[:-1] if edges.size > 3 and edges[-1] - edges[-2] < 0.4 * half else edges
    if seed is not None:
        edges, start = seed.separate.edges, (seed.separate.sigma, seed.separate.omega)
    separate = fit_separately(t, y, kind, edges, WIDEST * half, start)
    for _ in range(3 if seed is None else 0):
        moved = moved_edges(separate, cycles, t)
        shift = float(np.max(np.abs(moved - separate.edges)))
        separate = fit_separately(t, y, kind, moved, WIDEST * half, (separate.sigma, separate.omega))
        if shift < 0.02 * interval:
            break
    if separate.variance > max(0.25 * float(np.var(y)), 3.0 * floor):
        raise NoDecay("the motion between reversals is no damped oscillation: no free decay")
    _refuse_driven(t, y, separate, floor)
    guard = 0.5 * interval  # a sample at the reversal itself belongs to neither side
    if kind is not Kind.DISPLACEMENT:  # the displacement itself has no jump
        guard = max(guard, find_guard(t, y, separate, max(separate.variance, floor)))
    separate = fit_separately(t, y, kind, separate.edges, guard, (separate.sigma, separate.omega))
    separate = fit_separately(t, y, kind, moved_edges(separate, cycles, t), guard, (separate.sigma, separate.omega))

    begin = float(separate.edges[0]) if dropped else float(t[0])
    inflation = noise.inflation(math.pi / half, interval)
    offset, before = 0.0, None if seed is None else seed.tied
    tied = _fit_tied(t, y, separate, cycles, begin, noise.found, kind is Kind.DISPLACEMENT, before)
    holds = _tie_holds(t, y, tied, separate, floor, inflation)
    if kind is not Kind.DISPLACEMENT:
        shifted = _fit_tied(t, y, separate, cycles, begin, noise.found, True, before)
        gain = tied.squares - shifted.squares
        if gain > 16.0 * max(shifted.variance, floor) * inflation and shifted.count >= tied.count:
            offset = float(shifted.theta[OFFSET])
            cleared = fit_separately(t, y - offset, kind, separate.edges, guard, (separate.sigma, separate.omega))
            if _tie_holds(t, y, shifted, cleared, floor, inflation):
                tied, separate, holds, y = shifted, cleared, True, y - offset
            else:
                offset = 0.0
    count = tied.count if holds else len(separate)
    if count < MINIMUM_HALF_CYCLES:
        raise NoDecay(f"{count} half-cycles found, at least {MINIMUM_HALF_CYCLES} are needed")
    if holds:
        found = (float(tied.theta[SIGMA]), float(tied.theta[OMEGA]))
        separate = fit_separately(t, y, kind, _inside(tied.edges, t), guard, found, fixed=True)
    if len(separate) < 2:
        raise NoDecay("no two half-cycles in a row look like a damped oscillation: no free decay")
    return ChannelFit(kind, t, y, noise, noise, cycles, separate, tied, holds, offset, inflation, dropped)


def _inside(edges: FloatArray, t: FloatArray) -> FloatArray:
    """The same edges; the outermost ones stay where they are though samples may lie on one side alone."""
    return edges[: int(np.searchsorted(edges, t[-1], side="left")) + 1]
