"""Residuals made ready for tests of structure: what a fit took is known, single samples beside a jump are set aside."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.fft import dct

from harness.core.arrays import BoolArray, FloatArray

BANDS = (0.5, 1.5, 3.5, 8.5, 16.5)
"""Upper ends of the bands tested, in units of the motion's frequency."""
_WIDEST = 0.4
"""Share of all coefficients below which the bands stay, so that a floor is left above them."""
_FLOOR_RATIO = 4.0
"""The floor reaches so many times as far as the bands: further up a sensor's own filter shows."""
_FEWEST_FLOOR = 60
"""Coefficients of a floor: it is then known to 18 % (sqrt(2/60))."""
_ISOLATED = 3.5
"""Standard deviations from which a sample is far out: one in two thousand by chance."""
_NEIGHBOUR = 1.7
"""Standard deviations that its neighbours must stay below for it to stand alone: nine in a hundred do not by chance."""
_OF_ITSELF = 0.4
"""Or share of its own size: beside a jump that is smeared the neighbour has more."""
_TAIL = 2.8
"""Standard deviations at which values are cut: of normal noise one in two hundred is, and its power falls by 1 %."""
_STILL = 5
"""Samples in a row that say the same, so that they are one."""
_SAID_AGAIN = 1e-6
"""Share of a value within which another is the same: rounding of a simulation."""
_LOWEST_FLOOR = 0.5
"""Of the claimed power: one that lies further above what is seen is believed."""
_TOLD = 1e-10
"""Share of the largest below which a fitted direction is none."""
_NORMAL = 1.4826
"""A standard deviation over the median size of normal noise."""


@dataclass(frozen=True, slots=True)
class Channel:
    """A cleaned residual r (n,) in units of its floor and the fitted directions (n, q), both with cosine coefficients.

    kept : which samples of the recording these are. per_omega : coefficients per multiple of the swing's frequency.
    freedom : of the floor. top : coefficients below the floor's band.
    """

    r: FloatArray
    basis: FloatArray
    c: FloatArray
    q: FloatArray
    kept: BoolArray
    per_omega: float
    freedom: int
    top: int


def isolated(r: FloatArray) -> BoolArray:
    """Which samples of a residual (n,) stand alone far out: misplaced next to a jump, or stray."""
    level = _NORMAL * float(np.median(np.abs(r)))
    if level <= 0.0:
        return np.zeros(r.size, dtype=np.bool_)
    padded = np.concatenate(([0.0], r, [0.0]))
    beside = np.maximum(padded[:-2] * np.sign(r), padded[2:] * np.sign(r))
    found: BoolArray = (np.abs(r) > _ISOLATED * level) & (
        beside < np.maximum(_NEIGHBOUR * level, _OF_ITSELF * np.abs(r))
    )
    return found


def _repeats(r: FloatArray) -> BoolArray:
    """Samples that repeat the one before in a run of at least five: a quantised sensor at rest says one thing once."""
    same = np.concatenate(([False], np.abs(np.diff(r)) <= _SAID_AGAIN * (np.abs(r[1:]) + 1e-12)))
    edges = np.diff(np.concatenate(([0], same.astype(np.int8), [0])))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    found = np.zeros(r.size, dtype=np.bool_)
    for lo, hi in zip(starts, ends, strict=True):
        if hi - lo >= _STILL:
            found[lo:hi] = True
    return found


def channels_of(
    residuals: Mapping[str, FloatArray], jacobian: Mapping[str, FloatArray], t: FloatArray, omega: float
) -> dict[str, Channel]:
    """Channels without samples that stand alone, in units of their floors, orthogonal once more to what was fitted."""
    clean = {}
    for c, residual in residuals.items():
        kept = (residual != 0.0) & ~_repeats(residual)
        y, partial = residual[kept].copy(), jacobian[c][kept].copy()
        away = isolated(y)
        # heavier tails than normal ones are cut: what they hold is no structure, but would count as much
        level = _TAIL * _NORMAL * float(np.median(np.abs(y))) if y.size else 0.0
        if level > 0.0:
            np.clip(y, -level, level, out=y)
        y[away], partial[away] = 0.0, 0.0
        n = y.size
        per_omega = n * float(np.median(np.diff(t))) * omega / math.pi
        top = int(min(BANDS[-1] * per_omega, _WIDEST * n))
        last = min(n, max(int(_FLOOR_RATIO * top), top + _FEWEST_FLOOR))
        above = dct(y, norm="ortho")[top:last] ** 2 if n else y
        # a claimed level far above what is seen is believed: numbers have other errors than noise
        floor = math.sqrt(max(float(np.mean(above)) if above.size else 1.0, _LOWEST_FLOOR))
        if top >= 1:
            clean[c] = Channel(y / floor, partial / floor, y, y, kept, per_omega, max(above.size, 1), top)
    if not clean:
        return {}
    sizes = np.cumsum([one.r.size for one in clean.values()])[:-1]
    q = _orthonormal(np.concatenate([one.basis for one in clean.values()]))
    r = np.concatenate([one.r for one in clean.values()])
    r -= q @ (q.T @ r)
    out = {}
    for (c, one), part, basis in zip(clean.items(), np.split(r, sizes), np.split(q, sizes), strict=True):
        of_basis = dct(basis, norm="ortho", axis=0) if basis.shape[1] else basis
        out[c] = replace(one, r=part, basis=basis, c=dct(part, norm="ortho"), q=of_basis)
    return out


def _orthonormal(j: FloatArray) -> FloatArray:
    """An orthonormal basis of the columns of j (N, q); directions that cannot be told from others are dropped."""
    scale = np.sqrt(np.einsum("ij,ij->j", j, j))
    j = j[:, scale > 0.0] / scale[scale > 0.0]
    if not j.shape[1]:
        return j
    values, vectors = np.linalg.eigh(j.T @ j)
    good = values > _TOLD * float(values[-1])
    basis: FloatArray = j @ (vectors[:, good] / np.sqrt(values[good]))
    return basis
