"""Tables as they were fitted, and the one way of fitting them: least squares with a penalty on roughness.

The penalty stands as rows below the recording's own (Craven and Wahba 1979, Numer. Math. 31, 377). How smooth tables
are inner blocks say, each left out in turn and predicted: the model is linear about a fit, so that no block needs a
simulation of its own (Stone 1974, J. R. Stat. Soc. B 36, 111).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.parameters import Free, bounds_of, coordinates_of, with_coordinates
from harness.diagnosis.problem import Observation
from harness.diagnosis.tables.basis import Basis
from harness.fit.least_squares import Bounds, Until, inverse_of, least_squares
from harness.model.model import Model

FIRST = 1e-2
"""Penalty of a first fit."""
_DONE = 1e-3
"""What a step must promise: the units are those of a misfit, thirty a word."""
_STRENGTHS = tuple(10.0**power for power in range(-5, 4))
"""Penalties tried, in units at which the penalty weighs as much as the recording."""
_HALVINGS = 5
"""Of the step between two penalties, towards the one that uses all the freedom there is."""


@dataclass(frozen=True, slots=True)
class Look:
    """A model with tables beside a recording.

    residual (N,). jacobian (N, b + K) : by the base parameters, then by the values of the tables. x (n,), v (n,) : the
    motion. shown : what it simulates, None where the force is fitted.
    """

    residual: FloatArray
    jacobian: FloatArray
    x: FloatArray
    v: FloatArray
    shown: Observation | None = None


@dataclass(frozen=True, slots=True)
class Curvature:
    """Of a fit with tables: seen (b + q, b + q) is J'J of its b base parameters and q coordinates, rough (q, q) the
    penalty at strength 1.
    """

    seen: FloatArray
    rough: FloatArray
    b: int

    def at(self, strength: float) -> FloatArray:
        """J'J plus the penalty, (b + q, b + q)."""
        h = self.seen.copy()
        h[self.b :, self.b :] += strength * self.rough
        return h

    def effective(self, strength: float) -> float:
        """Effective parameters of the tables: the trace of what the recording adds, base parameters taken off."""
        return float(np.trace(inverse_of(self.at(strength)) @ self.seen)) - self.b


@dataclass(frozen=True, slots=True)
class TableFit:
    """Tables fitted with the base parameters.

    free : base parameters. residual (N,), jacobian (N, b + q) : of the recording alone, by base parameters and then by
    the coordinates of the tables. at : coordinates (q,) of the tables. strength : of the penalty.
    penalty : (r, q), rows at strength 1. look : the model beside the recording.
    """

    basis: Basis
    model: Model
    free: tuple[Free, ...]
    at: FloatArray
    strength: float
    penalty: FloatArray
    residual: FloatArray
    jacobian: FloatArray
    look: Look

    @property
    def squares(self) -> float:
        """Chi-square of the recording alone."""
        return float(self.residual @ self.residual)

    @property
    def curvature(self) -> Curvature:
        """About the fit."""
        return Curvature(self.jacobian.T @ self.jacobian, self.penalty.T @ self.penalty, len(self.free))

    @property
    def effective(self) -> float:
        """Effective parameters of the tables."""
        return self.curvature.effective(self.strength)

    def beside(self, base: FloatArray, tables: FloatArray) -> FloatArray:
        """Partials by the base parameters (N, b) less what the tables (N, q) can take over within their penalty."""
        seen = float(np.sum(self.jacobian[:, len(self.free) :] ** 2))
        scale = float(np.sum(tables**2)) / max(seen, 1e-300)
        rough = self.strength * scale * (self.penalty.T @ self.penalty)
        return np.asarray(base - tables @ (inverse_of(tables.T @ tables + rough) @ (tables.T @ base)))


@dataclass(frozen=True, slots=True)
class _Point:
    """A model with tables seen with its recording; coordinates of the base parameters, then of the tables."""

    model: Model
    look: Look
    jacobian: FloatArray
    extra: FloatArray
    extra_by: FloatArray
    slopes: FloatArray

    @property
    def squares(self) -> float:
        """With the penalty."""
        return float(self.look.residual @ self.look.residual + self.extra @ self.extra)

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """By all coordinates."""
        j = self.jacobian * self.slopes
        normal, pull = j.T @ j, j.T @ self.look.residual
        b = self.jacobian.shape[1] - self.extra_by.shape[1]
        normal[b:, b:] += self.extra_by.T @ self.extra_by
        pull[b:] += self.extra_by.T @ self.extra
        return normal, pull


def minimised(
    basis: Basis,
    start: Model,
    at: FloatArray,
    free: tuple[Free, ...],
    seen: Callable[[Model], Look],
    strength: float,
    penalty: FloatArray | None = None,
    iterations: int = 12,
) -> TableFit:
    """Fit base parameters and tables from a start.

    at : coordinates (q,) of the tables. seen : a model beside the recording. penalty : rows (r, q), scaled to the
    recording where None is given. Raises SimulationError when the start cannot be seen.
    """
    b, inner, endless = len(free), bounds_of(free), np.full(at.size, np.inf)

    def by_coordinates(look: Look) -> FloatArray:
        return np.hstack((look.jacobian[:, :b], look.jacobian[:, b:] @ basis.free))

    if penalty is None:
        # in the units in which the recording sees the tables' coordinates
        penalty, tables = (
            basis.rough @ basis.free,
            by_coordinates(seen(basis.with_values(start, basis.free @ at)))[:, b:],
        )
        weight = float(np.trace(tables.T @ tables)) / max(float(np.trace(penalty.T @ penalty)), 1e-300)
        penalty = np.sqrt(weight) * penalty
    rows = np.sqrt(strength) * penalty

    def evaluated(z: FloatArray) -> _Point:
        model = basis.with_values(with_coordinates(start, free, z[:b]), basis.free @ z[b:])
        look = seen(model)
        slopes = [f.slope(f.outward(c)) for f, c in zip(free, z[:b].tolist(), strict=True)]
        return _Point(model, look, by_coordinates(look), -rows @ z[b:], rows, np.array(slopes + [1.0] * at.size))

    bounds = Bounds(
        np.concatenate((inner.lower, -endless)),
        np.concatenate((inner.upper, endless)),
        np.concatenate((inner.longest, endless)),
    )
    begin = np.concatenate((coordinates_of(start, free), at))
    found = least_squares(evaluated, begin, Until(_DONE, 1e-5, iterations), bounds)
    p = found.point
    return TableFit(basis, p.model, free, found.coordinates[b:], strength, penalty, p.look.residual, p.jacobian, p.look)


@dataclass(frozen=True, slots=True)
class Blocks:
    """What each block of a recording says of a linear model about a fit: J'J (m, p, p), J'y (m, p), y'y (m,).

    Number 0 is what is in no block, the largest swings, and is never left out.
    """

    normal: FloatArray
    pull: FloatArray
    size: FloatArray

    @classmethod
    def of(cls, found: TableFit, block: FloatArray) -> "Blocks":
        """block (n,) : number of each sample's block, -1 for those in none."""
        number = np.tile(block.astype(np.int64) + 1, found.residual.size // block.size)
        # about the fit: base parameters by what they move, tables by their coordinates
        y = found.residual + found.jacobian @ np.concatenate((np.zeros(len(found.free)), found.at))
        parts = [(found.jacobian[p], y[p]) for p in (number == i for i in range(int(number.max()) + 1))]
        return cls(
            np.array([j.T @ j for j, _ in parts]),
            np.array([j.T @ r for j, r in parts]),
            np.array([r @ r for _, r in parts]),
        )

    def missed(self, keep: BoolArray, out: BoolArray, penalty: FloatArray) -> float:
        """Squares missed of the blocks ``out`` by a fit to the blocks ``keep``; penalty (p, p)."""
        p = inverse_of(self.normal[keep].sum(axis=0) + penalty) @ self.pull[keep].sum(axis=0)
        return float(self.size[out].sum() - 2.0 * p @ self.pull[out].sum(axis=0) + p @ self.normal[out].sum(axis=0) @ p)


def strength_by_blocks(found: TableFit, block: FloatArray, keep: Sequence[int], most: float) -> float:
    """The penalty at which blocks of ``keep``, left out one at a time, are predicted best.

    most : effective parameters that the tables may have; where none of the penalties tried keeps to it, the largest.
    """
    blocks, b, p = Blocks.of(found, block), len(found.free), found.jacobian.shape[1]
    rough, numbers = np.zeros((p, p)), np.arange(len(blocks.size))
    rough[b:, b:] = found.penalty.T @ found.penalty
    kept = np.isin(numbers, [0, *(i + 1 for i in keep)])
    best, least = _STRENGTHS[-1], np.inf
    for strength in _within(found, most):
        missed = sum(blocks.missed(kept & (numbers != i + 1), numbers == i + 1, strength * rough) for i in keep)
        if missed < least:
            best, least = strength, missed
    return best


def _within(found: TableFit, most: float) -> list[float]:
    """The penalties that keep to so many effective parameters, the strongest first, and last the one that uses all."""
    kept: list[float] = []
    curvature = found.curvature
    for strength in reversed(_STRENGTHS):
        if curvature.effective(strength) > most:
            if kept:
                low, high = math.log(strength), math.log(kept[-1])
                for _ in range(_HALVINGS):
                    middle = 0.5 * (low + high)
                    within = curvature.effective(math.exp(middle)) <= most
                    low, high = (low, middle) if within else (middle, high)
                kept.append(math.exp(high))
            break
        kept.append(strength)
    return kept


def rougher(found: TableFit, block: FloatArray) -> FloatArray:
    """Coordinates (q,) of the tables as rough as blocks alone would have them, however few words there are.

    Linear about the fit; those of the fit itself where the words do not bound it.
    """
    strength = strength_by_blocks(found, block, range(int(block.max()) + 1), np.inf)
    if strength >= found.strength:
        return found.at
    b = len(found.free)
    y = found.residual + found.jacobian[:, b:] @ found.at
    return np.asarray((inverse_of(found.curvature.at(strength)) @ (found.jacobian.T @ y))[b:])
