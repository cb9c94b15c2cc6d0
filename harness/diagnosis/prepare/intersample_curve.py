"""How a recorded force runs between its samples where it is not held: straight, or smooth if that predicts better."""

import math
from itertools import pairwise

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.prepare.intersample_kinks import STENCIL, kinks_of, polynomials, smooth_stencils, value
from harness.kernels.solve import Drive

_SAME_TIME = 1e-9
"""Sampling intervals: rounding alone parts times that are nearer."""
_FINER = 4
"""Straight pieces by which a smooth interval is followed."""
_FEWEST = 20
"""Samples below which a force is not asked how it goes between them."""


def between_samples(t: FloatArray, u: FloatArray, longest: float = math.inf) -> Drive:
    """The drive of a force u (n,) at t (n,), s; straight over intervals beyond ``longest`` (s), where none is known."""
    edges = [0, *(np.flatnonzero(np.diff(t) > longest) + 1), t.size]
    parts = [_without_gap(t[a:b], u[a:b]) for a, b in pairwise(edges)]
    return Drive(np.concatenate([p.t for p in parts]), np.concatenate([p.u for p in parts]))


def _without_gap(t: FloatArray, u: FloatArray) -> Drive:
    """The drive over a stretch without a gap.

    Every second sample is left out and predicted from the others, by straight lines and by a curve with kinks; noise
    is better predicted by the former, a smooth force and a loop's by the latter.
    """
    if t.size < _FEWEST:
        return Drive(t, u)
    left_out = slice(1, (t.size - 1) // 2 * 2, 2)
    knots, values = t[::2], u[::2]
    straight = np.interp(t[left_out], knots, values) - u[left_out]
    coarse = curve(knots, values)
    curved = np.interp(t[left_out], coarse.t, coarse.u) - u[left_out]
    # kinks are missed by either: what is usual decides
    if float(np.median(np.abs(curved))) >= float(np.median(np.abs(straight))):
        return Drive(t, u)
    return curve(t, u)


def curve(t: FloatArray, u: FloatArray) -> Drive:
    """A force u (n,), n > STENCIL, at t (n,), s, smooth but for kinks, in straight pieces that keep its momentum."""
    kinks, cell = kinks_of(t, u), np.arange(t.size - 1)
    first = smooth_stencils(t.size, kinks)
    smooth = np.flatnonzero(first >= 0)
    lost = np.setdiff1d(cell[first < 0], kinks.cell)
    parts = [
        _pieces(t[smooth], t[smooth + 1], polynomials(t, u, first[smooth]), t[first[smooth]]),
        _pieces(t[kinks.cell], kinks.t, kinks.left, t[kinks.cell - STENCIL + 1]),
        _pieces(kinks.t, t[kinks.cell + 1], kinks.right, t[kinks.cell + 1]),
        (t[lost], u[lost]),
        _knots(t[-1:, None], t[-1:] - t[-2:-1], polynomials(t, u, first[-1:]), t[first[-1:]]),
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
    force = value(law, since) - width**2 / 12.0 * value(law, since, 2)
    return at.ravel(), force.ravel()
