"""How much of a measured force a slider has felt, and how it acted between samples, whatever laws the slider has.

Over a window between two reversals what acts beside the force, damping and what pulls back is smooth; the motion is
their double integral, and that shows whether the force's scatter was felt (a controller's command, which its encoder
stirs) or is a sensor's noise: a component of variance, by restricted likelihood (Patterson and Thompson 1971). A law
that is missing bends long windows and can only make the noise seem larger; so the window that bounds it lowest tells.

A controller's command moreover is made of what its encoder has shown, and a sensor's noise is not: what the last
readings leave of the scatter bounds that noise, however coarse the encoder.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import eigh

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.rules import DECISIVE
from harness.diagnosis.smoothed_state.state import Course, in_motion
from harness.estimate.noise import Noise
from harness.kernels.solve import Drive
from harness.model.model import Model, Restoring

_WIDTHS = 16, 24, 40, 64
"""Samples of a window."""
_DEGREE = 3
"""Of the polynomial in time by which a position may depart within one: of all forces beside, a line."""
_FEWEST, _MOST = 8, 200
"""Windows that tell anything, and that are looked at."""
_CLEAR = 2
"""Samples that a window keeps from where the slider turns, rests or was not recorded."""
_MASS = 0.9, 1.1
"""Factors of the inertia that may be wrong: of one that is free more, a loop that hears its encoder's noise makes
much."""
_NOTHING = 1e-300
"""A power that is none, whose logarithm is taken."""
_RANK = 1e-12
"""Of what is free, below which one part of it is as another."""
_SHARES = np.concatenate(([0.0], 2.0 ** np.arange(-26.0, 40.0, 0.25)))
"""What noise of the force adds to a position within a window over the position's own, as variances."""


_ECHOED = 24
"""Samples of a window in which a force is held against the readings before it."""
_READINGS = range(-1, 8)
"""Samples by which these lie before it. One lies after it, as a command that is logged late has seen it."""
_MOST_OF = 0.75
"""Share of the windows that leave no more than what is taken for noise: where a loop turns or clips is none of it."""


@dataclass(frozen=True, slots=True)
class Felt:
    """level : standard deviation of the force's noise, N, the largest that is not decidedly less likely. held : whether
    the force acted as it was until the next sample; None where windows do not decide, or not all alike.
    """

    level: float
    held: bool | None


def felt(t: FloatArray, q: FloatArray, own: Noise, course: Course, base: Model, ways: Sequence[Drive]) -> Felt | None:
    """What a position q (n,) at t (n,), s, with noise ``own``, has felt of a force that acts in one of several ways.

    base : what pulls back and damps, and the inertia, nearly. None where there are too few samples between reversals.
    """
    levels, said = list[float](), set[bool]()
    for width in _WIDTHS:
        at = _windows(t, course, width)
        if len(at) < _FEWEST:
            continue
        each = [(*_of_way(t, q, own, base, way, at), way.held) for way in ways]
        unlikely, level, is_held = min(each)
        levels.append(level)
        if min((off for off, _, one in each if one is not is_held), default=math.inf) - unlikely > DECISIVE.value:
            said.add(is_held)
    return Felt(min(levels), said.pop() if len(said) == 1 else None) if levels else None


def unheard(t: FloatArray, u: FloatArray, q: FloatArray, course: Course) -> float | None:
    """Standard deviation, N, of what a force u (n,) at t (n,), s, has beside what its position q (n,) has shown.

    Of what is not smooth within a window, as a sum of the readings near by. None where there are too few samples
    between reversals.
    """
    at = _windows(t, course, _ECHOED)
    at = at[(at[:, 0] >= _READINGS[-1]) & (at[:, -1] < t.size + _READINGS[0])] if len(at) else at
    if len(at) < _FEWEST:
        return None
    full, _ = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, _ECHOED), _DEGREE + 1), mode="complete")
    rest = full[:, _DEGREE + 1 :]
    told = np.stack([(q[at - back] @ rest).ravel() for back in _READINGS], axis=1)
    scatter = u[at] @ rest
    size = np.maximum(np.linalg.norm(told, axis=0), _NOTHING)
    told = told / size @ np.linalg.lstsq(told / size, scatter.ravel(), rcond=_RANK)[0]
    left = np.mean((scatter - told.reshape(scatter.shape)) ** 2, axis=1)
    return math.sqrt(float(np.quantile(left, _MOST_OF)))


def _windows(t: FloatArray, course: Course, width: int) -> IntArray:
    """Samples (k, width) of windows in which a slider neither turns nor rests, and nothing is missing."""
    v = course.state[1]
    side = np.where(in_motion(v), np.sign(v), 0.0)
    cut = np.flatnonzero((side[1:] != side[:-1]) | (np.diff(t) > course.longest)) + 1
    edges = np.concatenate(([0], cut, [t.size]))
    runs = [(a + _CLEAR, b - _CLEAR) for a, b in pairwise(edges) if side[a] != 0.0]
    first = np.concatenate([np.arange(a, b - width + 1, width) for a, b in runs] or [np.empty(0, np.int64)])
    if first.size > _MOST:
        first = first[np.linspace(0, first.size - 1, _MOST).astype(np.int64)]
    return np.asarray(first[:, None] + np.arange(width), dtype=np.int64)


def _of_way(t: FloatArray, q: FloatArray, own: Noise, base: Model, way: Drive, at: IntArray) -> tuple[float, float]:
    """-2 log L at best, and the largest noise of the force, N, that is not decidedly less likely."""
    x, width = q[at], at.shape[1]
    pull = np.sin(x - base.offset) if base.restoring is Restoring.PENDULUM else x - x[:, :1]
    once, force = _summed(x - x[:, :1], t[at]), _twice(way, t)[at] / base.m
    columns = [x - x[:, :1], force - force[:, :1], once]
    if base.restoring is not Restoring.NONE:
        columns.append(_summed(_summed(pull, t[at]), t[at]))
    full, _ = np.linalg.qr(np.vander(np.linspace(-1.0, 1.0, width), _DEGREE + 1), mode="complete")
    rest, each = full[:, _DEGREE + 1 :], [np.asarray(one) for one in np.eye(width)]
    since: FloatArray = float(np.median(np.diff(t))) * np.arange(float(width))
    unit = np.column_stack([_twice(Drive(since, one, way.held), since) for one in each]) / base.m
    size = float(np.trace(unit @ unit.T)) / width
    colour = own.phi ** np.abs(np.subtract.outer(np.arange(width), np.arange(width))) if own.phi else np.eye(width)
    # in directions in which both noises are independent: one variance each, whatever their shares
    spread, turned = eigh(rest.T @ (unit @ unit.T / size) @ rest, rest.T @ colour @ rest)
    seen = np.stack([one @ rest @ turned for one in columns])
    count = seen[0].size
    variance = 1.0 + _SHARES[:, None] * np.maximum(spread, 0.0)
    products = np.einsum("se,ike,jke->sij", 1.0 / variance, seen, seen, optimize=True)
    off = np.array([_left(one) for one in products]) / count
    unlikely = count * np.log(np.maximum(off, _NOTHING)) + len(at) * np.sum(np.log(variance), axis=1)
    levels = np.sqrt(_SHARES / size * off)
    return float(np.min(unlikely)), float(np.max(levels[unlikely <= np.min(unlikely) + DECISIVE.value]))


def _left(products: FloatArray) -> float:
    """What is left of a position's power by the force, at nearly the base's inertia, and all that is free; of the
    products (k, k) of both and that.
    """
    size = np.sqrt(np.maximum(np.diag(products), _NOTHING))
    scaled = products / np.outer(size, size)
    found = np.linalg.lstsq(scaled[1:, 1:], scaled[1:, 0], rcond=_RANK)[0]
    factor = found[0] * size[0] / size[1]
    if not _MASS[0] <= factor <= _MASS[1]:
        found[0] = min(max(factor, _MASS[0]), _MASS[1]) * size[1] / size[0]
        found[1:] = np.linalg.lstsq(scaled[2:, 2:], scaled[2:, 0] - found[0] * scaled[2:, 1], rcond=_RANK)[0]
    left = np.concatenate(([1.0], -found))
    return float(left @ scaled @ left) * float(products[0, 0])


def _summed(y: FloatArray, t: FloatArray) -> FloatArray:
    """Integral over time from the first sample of each window, (k, width)."""
    steps = 0.5 * (y[:, 1:] + y[:, :-1]) * np.diff(t, axis=1)
    return np.concatenate((np.zeros((len(y), 1)), np.cumsum(steps, axis=1)), axis=1)


def _twice(drive: Drive, t: FloatArray) -> FloatArray:
    """Double integral (n,) of a force at t (n,), s, which rises, N s^2."""
    at = np.union1d(drive.t, t)
    u, h = drive.at(at), np.diff(at)
    begin, end = u[:-1], u[:-1] if drive.held else u[1:]
    v = np.concatenate(([0.0], np.cumsum(0.5 * (begin + end) * h)))
    x = np.concatenate(([0.0], np.cumsum(v[:-1] * h + (2.0 * begin + end) / 6.0 * h * h)))
    return np.asarray(x[np.searchsorted(at, t)], dtype=np.float64)
