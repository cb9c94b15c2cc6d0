"""How a recorded force acts between its samples: held as a controller's, straight, or smooth but for kinks.

Which of straight and smooth predicts better, samples left out say; held is taken where the motion is followed better
so. The force of a loop kinks between samples whenever its slider turns. Without a spring nothing forgets: what one
kink's interval is misread by, as momentum, moves the position ever after. Each side of a kink is continued by its own
polynomial, and the kink lies where the two meet (Harten 1989, subcell resolution of essentially non-oscillatory
schemes).
"""

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.errors import SimulationError
from harness.diagnosis.baseline.base_fit import driven_scales, own_scales
from harness.diagnosis.fit.model_fit import Fit, fit, whitened
from harness.diagnosis.fit.rmse import motion_followed
from harness.diagnosis.input_noise.noisy_base_fit import in_turn
from harness.diagnosis.parameters import free_of
from harness.diagnosis.prepare.band_limited import band_limited, ends
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.rules import FORCE_HELD, NEARLY_FOLLOWED
from harness.diagnosis.starts import Windows
from harness.kernels.solve import Drive
from harness.model.model import Model, ModelTerm
from harness.model.terms.static_friction import TERM as STATIC_FRICTION

ACTS_HELD = "the force acts as a sampled controller's, held from each sample to the next"
_ITERATIONS = 8
"""Of a first fit."""
_SAMPLES = 20_000
"""That tell whether a force is held, more than enough for a share of chi-square of 2 %."""
FAR_OFF = 300.0
"""Standard deviations of the sensors' noise by which a base model misses on average, as an encoder shows of a drive."""


@dataclass(frozen=True, slots=True)
class Acting:
    """How a force acts. otherwise : the other ways. held : until the next sample. follows : whether the base model,
    fitted to a first part, does so from one start. chi2 : that it leaves there.
    """

    drive: Drive
    otherwise: tuple[Drive, ...]
    held: bool
    follows: bool
    model: Model
    chi2: float


def held(t: FloatArray, u: FloatArray) -> Drive:
    """The drive of u (n,) at t (n,), s, when each value is held until the next."""
    return Drive(t, u, held=True)


def acting(problem: Driven, u: FloatArray, told: bool | None = None) -> Acting:
    """How the force u (n,) acts, and whether the base model then follows the recording.

    told : whether it is held, where the motion between reversals says so; it stands if the base model then follows.
    Else it acts as the samples themselves say where no other way lets the base model follow the recording better. Where
    the model shows another motion, as of many a real drive, and where it cannot be simulated, no law says the force
    well enough, and the force itself is what can be compared.
    """
    first, part, stepped = problem.first, problem.part(slice(0, _SAMPLES)), held(problem.t, u)
    if told is not None:
        # half a step's delay is as a little more mass: which of the two it is is asked again beside each law
        way, other = (stepped, problem.drive) if told else (problem.drive, stepped)
        if (found := _followed(part, way)) is not None and _follows(found, part):
            return Acting(way, (other,), told, follows=True, model=found.model, chi2=found.chi2)
    usual, ways = _followed(part, problem.drive), [stepped]
    if usual is None:
        return Acting(problem.drive, (), held=False, follows=False, model=first, chi2=math.inf)
    ways += [way for way in problem.otherwise if _seen(way, usual, part)]
    fits = [(one, way) for way in ways if (one := _followed(part, way)) is not None]
    nearest, drive = min(fits, key=lambda pair: pair[0].chi2, default=(usual, problem.drive))
    if nearest.chi2 >= FORCE_HELD.value * usual.chi2:
        nearest, drive = usual, problem.drive
    others = tuple(way for way in (problem.drive, *(way for _, way in fits)) if way is not drive)
    return Acting(drive, others, drive.held, _follows(nearest, part), nearest.model, nearest.chi2)


def _followed(part: Driven, drive: Drive) -> Fit | None:
    """The base model, fitted to a part in which the force acts in a way; None where it cannot be simulated."""
    scales, free = driven_scales(part, part.first), free_of(part.first, part.base_names)

    def again(problem: Driven, found: Fit) -> tuple[Driven, Fit]:
        return problem, fit(found.model, problem, free, scales, _ITERATIONS, COARSE, thorough=False)

    with suppress(SimulationError):
        seen = replace(part, drive=drive)
        found = fit(part.first, seen, free, scales, _ITERATIONS, COARSE, thorough=False)
        # over gaps from starts of which nothing counts as known
        return in_turn(seen, found, scales, again)[1] if isinstance(seen.starts, Windows) else found
    return None


def nearly(problem: Driven) -> Fit | None:
    """The base model, fitted to a first part of the motion; None where it does not follow that."""
    part = problem.part(slice(0, _SAMPLES))
    found = _followed(part, problem.drive)
    return found if found is not None and _follows(found, part) else None


def breaks_away(problem: Driven, force: Acting, f_s: float) -> bool:
    """Whether the recording is followed by a model that f_s, N, holds where it stands, and not its sliding friction.

    One without that moves at another time, and strays whatever it says of how the slider slides.
    """
    model = replace(problem.first, terms=(ModelTerm(STATIC_FRICTION, (f_s,)),))
    seen, scales = replace(problem.part(slice(0, _SAMPLES)), drive=force.drive), driven_scales(problem, model)
    with suppress(SimulationError):
        found = fit(model, seen, free_of(model, problem.base_names), scales, effort=COARSE, thorough=False)
        return _follows(found, seen)
    return False


def _follows(found: Fit, problem: Driven) -> bool:
    """Whether a model shows the motion that was recorded, within reach of its sensors' noise or nearly as a whole."""
    return found.chi2 < FAR_OFF**2 * found.points or motion_followed(found.shown.y, problem) >= NEARLY_FOLLOWED.value


def _seen(lines: Drive, usual: Fit, problem: Driven) -> bool:
    """Whether the noise lets the motion tell straight lines from what is usual, by as much as decides."""
    straight = replace(problem, drive=lines)
    try:
        shown = observe(usual.model, straight, (), own_scales(straight, usual.model), COARSE)
    except SimulationError:
        return False
    apart = whitened(problem, {c: y - usual.shown.y[c] for c, y in shown.y.items()})
    return float(apart @ apart) > (1.0 - FORCE_HELD.value) * usual.points


_SAME_TIME = 1e-9
"""Sampling intervals: rounding alone parts times that are nearer."""
_FINER = 4
"""Straight pieces by which a smooth interval is followed."""
_FEWEST = 20
"""Samples below which a force is not asked how it goes between them."""


def between_samples(t: FloatArray, u: FloatArray, longest: float = math.inf) -> tuple[Drive, Drive]:
    """The drive of a force u (n,) at t (n,), s, as its samples say, and the other one of straight and smooth.

    Straight over intervals beyond ``longest`` (s), where none is known. In a stretch without a gap every second sample
    is left out and predicted from the others, by straight lines and by a curve with kinks; noise is better predicted by
    the former, a smooth force and a loop's by the latter. One whose spectrum ends is known, with however few samples a
    period.
    """
    edges, parts = [0, *(np.flatnonzero(np.diff(t) > longest) + 1), t.size], []
    for a, b in pairwise(edges):
        lines = Drive(t[a:b], u[a:b])
        if ends(t[a:b], u[a:b]):
            parts.append((band_limited(t[a:b], u[a:b]), lines))
        elif b - a >= _FEWEST:
            out, coarse = slice(a + 1, a + (b - a - 1) // 2 * 2, 2), curve(t[a:b:2], u[a:b:2])
            # kinks are missed by either: what is usual decides
            straight, curved = (
                float(np.median(np.abs(np.interp(t[out], at, force) - u[out])))
                for at, force in ((t[a:b:2], u[a:b:2]), (coarse.t, coarse.u))
            )
            smooth = curve(t[a:b], u[a:b])
            parts.append((lines, smooth) if curved >= straight else (smooth, lines))
        else:
            parts.append((lines, lines))
    usual, other = (
        Drive(np.concatenate([p.t for p in way]), np.concatenate([p.u for p in way]))
        for way in zip(*parts, strict=True)
    )
    return usual, other


def curve(t: FloatArray, u: FloatArray) -> Drive:
    """A force u (n,), n > STENCIL, at t (n,), s, smooth but for kinks, in straight pieces that keep its momentum."""
    kinks, cell = kinks_of(t, u), np.arange(t.size - 1)
    first = _smooth_stencils(t.size, kinks)
    smooth = np.flatnonzero(first >= 0)
    lost = np.setdiff1d(cell[first < 0], kinks.cell)
    parts = [
        _pieces(t[smooth], t[smooth + 1], _polynomials(t, u, first[smooth]), t[first[smooth]]),
        _pieces(t[kinks.cell], kinks.t, kinks.left, t[kinks.cell - STENCIL + 1]),
        _pieces(kinks.t, t[kinks.cell + 1], kinks.right, t[kinks.cell + 1]),
        (t[lost], u[lost]),
        _knots(t[-1:, None], t[-1:] - t[-2:-1], _polynomials(t, u, first[-1:]), t[first[-1:]]),
    ]
    at, force = (np.concatenate(part) for part in zip(*parts, strict=True))
    order = np.argsort(at, kind="stable")
    at, force = at[order], force[order]
    keep = np.concatenate(([True], np.diff(at) > _SAME_TIME * float(np.median(np.diff(t)))))
    return Drive(at[keep], force[keep])


def _pieces(begin: FloatArray, end: FloatArray, law: FloatArray, origin: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Knots of straight pieces from begin to before end (k,), s, that follow polynomials law (k, STENCIL)."""
    some = end > begin
    begin, length = begin[some], (end - begin)[some]
    return _knots(begin[:, None] + length[:, None] / _FINER * np.arange(_FINER), length, law[some], origin[some])


def _knots(at: FloatArray, length: FloatArray, law: FloatArray, origin: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Knots at (k, j), s, in intervals of a length (k,), s, that is cut into pieces."""
    since, width = at - origin[:, None], length[:, None] / _FINER
    # a chord misses width^3 curvature / 12 of the force's integral
    force = _value(law, since) - width**2 / 12.0 * _value(law, since, 2)
    return at.ravel(), force.ravel()


_NORMAL = 1.4826
"""A standard deviation over the median size of normal noise."""
STENCIL = 5
"""Samples of a polynomial: fourth degree, so that a loop's transient of a few samples is followed."""
_STANDS_OUT = 8.0
"""Times the usual change of slope from which one is a kink's."""
_ALONE, _BESIDE = 3, 2
"""Samples within which only the strongest change of slope counts; intervals to either side in which a kink that is seen
may lie."""
_SLACK, _LOOKED_AT = 0.02, 53
"""How far past an interval's ends, in intervals, its sides may meet, and at how many places that is looked for."""
_EDGE, _DOUBTED = 0.05, 4.0
"""Sides that meet this near to a sample, in intervals, are believed only if they are so many times smoother."""
_OFF = 2.0
"""Times its roughness by which a side may miss a sample that it would continue to."""


@dataclass(frozen=True, slots=True)
class Kinks:
    """Kinks of a sampled force, one at most in an interval.

    cell (k,) : the interval after this sample. t (k,) : s. left, right (k, STENCIL) : polynomials of either side, by
    powers of the time since the first of their samples.
    """

    cell: IntArray
    t: FloatArray
    left: FloatArray
    right: FloatArray


def kinks_of(t: FloatArray, u: FloatArray) -> Kinks:
    """Kinks of a force u (n,) at t (n,), s, in order of time.

    Of the intervals in which a kink may lie it is the one whose sides are the smoothest: a polynomial across a kink is
    rough.
    """
    n = t.size
    seen = _suspects(t, u) if n > 2 * (STENCIL + _ALONE) else np.empty(0, np.int64)
    best = Kinks(seen.copy(), np.full(seen.size, np.nan), *np.zeros((2, seen.size, STENCIL)))
    smoothest = np.full(seen.size, np.inf)
    for shift in range(-_BESIDE, _BESIDE + 1):
        cell = np.clip(seen + shift, STENCIL - 1, n - STENCIL - 1)
        met, left, right = _meeting(t, u, cell)
        rough = _roughness(t, u, cell - STENCIL + 1) + _roughness(t, u, cell + 1)
        # next to the true interval a side that holds one sample of the other meets it at that sample
        inside = (met - t[cell]) / (t[cell + 1] - t[cell])
        rough = np.where((inside > _EDGE) & (inside < 1.0 - _EDGE), rough, _DOUBTED * rough)
        better = np.isfinite(met) & (rough < smoothest)
        smoothest[better] = rough[better]
        _put(best, better, (cell, met, left, right), better)
    found = np.isfinite(best.t)
    best = Kinks(best.cell[found], best.t[found], best.left[found], best.right[found])
    # those that seem to lie at a sample go into the interval that they lie in
    inside = (best.t - t[best.cell]) / (t[best.cell + 1] - t[best.cell])
    sample = best.cell + np.rint(inside).astype(np.int64)
    fits = (sample >= STENCIL) & (sample + STENCIL < n)
    near = np.flatnonzero(fits & (np.minimum(inside, 1.0 - inside) < _EDGE))
    cell = _whose(t, u, sample[near])
    met, left, right = _meeting(t, u, cell)
    _put(best, near[np.isfinite(met)], (cell, met, left, right), np.isfinite(met))
    cells, once = np.unique(best.cell, return_index=True)
    return Kinks(cells, best.t[once], best.left[once], best.right[once])


def _put(
    kinks: Kinks, to: IntArray | BoolArray, new: tuple[IntArray, FloatArray, FloatArray, FloatArray], of: BoolArray
) -> None:
    for old, one in zip((kinks.cell, kinks.t, kinks.left, kinks.right), new, strict=True):
        old[to] = one[of]


def _suspects(t: FloatArray, u: FloatArray) -> IntArray:
    """Samples next to which the slope changes by far more than it does elsewhere."""
    n = t.size
    bend = np.zeros(n)
    bend[1:-1] = np.diff(np.diff(u) / np.diff(t))
    i = np.arange(_ALONE, n - _ALONE - 1)
    both = bend[i] + bend[i + 1]
    level = both - (bend[i - 1] + bend[i + 2])
    slanted = both - (2.0 * bend[i - 1] - bend[i - 2] + 2.0 * bend[i + 2] - bend[i + 3])
    jump = np.minimum(np.abs(level), np.abs(slanted))
    keep: BoolArray = jump > _STANDS_OUT * _NORMAL * float(np.median(jump))
    peak = np.where(keep, jump, 0.0)
    for shift in range(1, _ALONE + 1):
        keep[shift:] &= peak[shift:] > peak[:-shift]
        keep[:-shift] &= peak[:-shift] >= peak[shift:]
    return i[keep]


def _meeting(t: FloatArray, u: FloatArray, cell: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Where (k,) the sides of intervals meet, NaN where not once, and the polynomials of the left and of the right."""
    left, right = _polynomials(t, u, cell - STENCIL + 1), _polynomials(t, u, cell + 1)
    width, place = t[cell + 1] - t[cell], np.linspace(-_SLACK, 1.0 + _SLACK, _LOOKED_AT)
    at = t[cell][:, None] + width[:, None] * place
    apart = _value(left, at - t[cell - STENCIL + 1][:, None]) - _value(right, at - t[cell + 1][:, None])
    crosses = apart[:, :-1] * apart[:, 1:] <= 0.0
    i, row = np.argmax(crosses, axis=1), np.arange(cell.size)
    before, after = apart[row, i], apart[row, i + 1]
    share = before / np.where(before == after, 1.0, before - after)
    met = np.clip(at[row, i] + share * (at[row, i + 1] - at[row, i]), t[cell], t[cell + 1])
    return np.where(np.count_nonzero(crosses, axis=1) == 1, met, np.nan), left, right


def _whose(t: FloatArray, u: FloatArray, sample: IntArray) -> IntArray:
    """The interval (k,) that a kink beside a sample lies in: after it if the sample continues the left side.

    The smoother of the two sides decides, which misses its own next sample by less.
    """
    width = 0.5 * (t[sample + 1] - t[sample - 1])
    off, rough = [], []
    for first in (sample - STENCIL, sample + 1):
        missed = _value(_polynomials(t, u, first), (t[sample] - t[first])[:, None])[:, 0] - u[sample]
        off.append(np.abs(missed) / width)
        rough.append(_roughness(t, u, first))
    is_lefts = np.where(rough[0] <= rough[1], off[0] <= _OFF * rough[0], off[1] > _OFF * rough[1])
    return np.where(is_lefts, sample, sample - 1)


def _polynomials(t: FloatArray, u: FloatArray, first: IntArray) -> FloatArray:
    """Coefficients (k, STENCIL) through the samples from ``first`` (k,) on, by powers of the time since the first."""
    at = first[:, None] + np.arange(STENCIL)
    since = t[at] - t[first][:, None]
    length = since[:, -1:]
    powers = (since / length)[:, :, None] ** np.arange(STENCIL)
    found: FloatArray = np.linalg.solve(powers, u[at][:, :, None])[:, :, 0] / length ** np.arange(STENCIL)
    return found


def _value(coefficients: FloatArray, since: FloatArray, derivative: int = 0) -> FloatArray:
    """Polynomials (k, STENCIL), or a derivative of them, at (k, j) times since their first samples."""
    return np.asarray(polyval(since.T, polyder(coefficients.T, derivative), tensor=False), dtype=np.float64).T


def _roughness(t: FloatArray, u: FloatArray, first: IntArray) -> FloatArray:
    """The most (k,) by which the bend changes from sample to sample of a stencil: a kink within shows."""
    at = first[:, None] + np.arange(STENCIL)
    bend = np.diff(np.diff(u[at]) / np.diff(t[at]))
    most: FloatArray = np.max(np.abs(np.diff(bend)), axis=1)
    return most


def _smooth_stencils(n: int, kinks: Kinks) -> IntArray:
    """First sample (n - 1,) of the stencil of each interval that no kink lies in; -1 where none fits.

    The most central one: a kink within is the only reason for another.
    """
    broken = np.zeros(n - 1, dtype=np.bool_)
    broken[kinks.cell] = True
    count = np.concatenate(([0], np.cumsum(broken)))
    first, cell = np.full(n - 1, -1, dtype=np.int64), np.arange(n - 1)
    for shift in sorted(range(2 - STENCIL, 1), key=lambda s: abs(s + (STENCIL - 2) / 2.0)):
        start = cell + shift
        inside = (first < 0) & (start >= 0) & (start + STENCIL <= n)
        begin = start[inside]
        clean = count[begin + STENCIL - 1] == count[begin]
        first[cell[inside][clean]] = begin[clean]
    return first
