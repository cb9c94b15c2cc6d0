"""Tables fitted to a recording: Gauss and Newton with a penalty on roughness, as strong as inner blocks say.

The penalty stands as rows below the recording's own. How strong it is, is chosen by prediction of blocks that are left
out, with the model linear about the fit: no block needs a simulation of its own (Craven and Wahba 1979, Numer. Math.
31, 377, for the penalty; Stone 1974, J. R. Stat. Soc. B 36, 111, for the choice).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.fit.model_fit import evaluate
from harness.diagnosis.fit.observe import COARSE, Observation
from harness.diagnosis.fit.parameters import Free, bounds_of, coordinates_of, with_coordinates
from harness.diagnosis.problem import Problem
from harness.diagnosis.tables.basis import Basis
from harness.fit.covariance import inverse_of
from harness.fit.least_squares import Bounds, Until, least_squares
from harness.kernels.solve import Effort, Scales
from harness.model.model import Model

STRENGTHS = tuple(10.0**power for power in range(-5, 4))
"""Penalties tried, in units at which the penalty weighs as much as the recording."""
FIRST = 1e-2
"""Penalty of a first fit."""
_DONE = 1e-3
"""What a step must promise: the units are those of a misfit, thirty a word."""


@dataclass(frozen=True, slots=True)
class TableFit:
    """Tables fitted with the base parameters.

    free : base parameters. residual (N,), jacobian (N, b + q) : of the recording alone, by base parameters and then by
    the coordinates of the tables. at : coordinates (q,) of the tables. strength : of the penalty.
    penalty : (r, q), rows at strength 1.
    """

    basis: Basis
    model: Model
    free: tuple[Free, ...]
    at: FloatArray
    strength: float
    penalty: FloatArray
    residual: FloatArray
    jacobian: FloatArray
    shown: Observation

    @property
    def squares(self) -> float:
        """Chi-square of the recording alone."""
        return float(self.residual @ self.residual)

    def curvature(self) -> FloatArray:
        """J'J plus the penalty, (b + q, b + q)."""
        b = len(self.free)
        h = self.jacobian.T @ self.jacobian
        h[b:, b:] += self.strength * (self.penalty.T @ self.penalty)
        return h

    @property
    def effective(self) -> float:
        """Effective parameters of the tables: the trace of what the recording adds, base parameters taken off."""
        influence = inverse_of(self.curvature()) @ (self.jacobian.T @ self.jacobian)
        return float(np.trace(influence)) - len(self.free)


@dataclass(frozen=True, slots=True)
class _Point:
    """A model with tables seen with its recording; coordinates of the base parameters, then of the tables."""

    model: Model
    residual: FloatArray
    jacobian: FloatArray
    shown: Observation
    extra: FloatArray
    extra_by: FloatArray
    slopes: FloatArray

    @property
    def squares(self) -> float:
        """With the penalty."""
        return float(self.residual @ self.residual + self.extra @ self.extra)

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """By all coordinates."""
        j = self.jacobian * self.slopes
        normal, pull = j.T @ j, j.T @ self.residual
        b = self.jacobian.shape[1] - self.extra_by.shape[1]
        normal[b:, b:] += self.extra_by.T @ self.extra_by
        pull[b:] += self.extra_by.T @ self.extra
        return normal, pull


def fit_tables(
    basis: Basis,
    start: Model,
    at: FloatArray,
    free: tuple[Free, ...],
    problem: Problem,
    scales: Scales,
    strength: float,
    penalty: FloatArray | None = None,
    iterations: int = 12,
    effort: Effort = COARSE,
) -> TableFit:
    """Fit base parameters and tables from a start.

    at : coordinates (q,) of the tables. penalty : rows (r, q), scaled to the recording where None is given.
    Raises SimulationError when the start cannot be simulated.
    """
    b = len(free)
    tables = tuple(Free(place, f"table {i}", -np.inf, np.inf, False) for i, place in enumerate(basis.places))

    def seen(model: Model) -> tuple[FloatArray, FloatArray, Observation]:
        residual, jacobian, shown = evaluate(model, problem, (*free, *tables), scales, effort)
        return residual, np.hstack((jacobian[:, :b], jacobian[:, b:] @ basis.free)), shown

    if penalty is None:
        _, jacobian, _ = seen(basis.with_values(start, basis.free @ at))
        penalty = scaled_penalty(basis, jacobian[:, b:])
    rows = np.sqrt(strength) * penalty

    def evaluated(z: FloatArray) -> _Point:
        model = basis.with_values(with_coordinates(start, free, z[:b]), basis.free @ z[b:])
        residual, jacobian, shown = seen(model)
        values = np.array([f.outward(c) for f, c in zip(free, z[:b].tolist(), strict=True)])
        slopes = np.array([f.slope(v) for f, v in zip(free, values.tolist(), strict=True)] + [1.0] * at.size)
        return _Point(model, residual, jacobian, shown, -rows @ z[b:], rows, slopes)

    inner, q = bounds_of(free), at.size
    bounds = Bounds(
        np.concatenate((inner.lower, np.full(q, -np.inf))),
        np.concatenate((inner.upper, np.full(q, np.inf))),
        np.concatenate((inner.longest, np.full(q, np.inf))),
    )
    found = least_squares(
        evaluated, np.concatenate((coordinates_of(start, free), at)), Until(_DONE, 1e-5, iterations), bounds
    )
    p = found.point
    return TableFit(basis, p.model, free, found.coordinates[b:], strength, penalty, p.residual, p.jacobian, p.shown)


def scaled_penalty(basis: Basis, jacobian: FloatArray) -> FloatArray:
    """Rows of roughness (r, q), in the units in which the recording sees the tables' coordinates (N, q)."""
    rows = basis.rough @ basis.free
    weight = float(np.trace(jacobian.T @ jacobian)) / max(float(np.trace(rows.T @ rows)), 1e-300)
    return np.asarray(np.sqrt(weight) * rows, dtype=np.float64)


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
        b = len(found.free)
        offset = np.concatenate((np.zeros(b), found.at))
        # about the fit: base parameters by what they move, tables by their coordinates
        y = found.residual + found.jacobian @ offset
        parts = [number == i for i in range(int(number.max()) + 1)]
        return cls(
            np.array([found.jacobian[p].T @ found.jacobian[p] for p in parts]),
            np.array([found.jacobian[p].T @ y[p] for p in parts]),
            np.array([float(y[p] @ y[p]) for p in parts]),
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
    rough = np.zeros((p, p))
    rough[b:, b:] = found.penalty.T @ found.penalty
    best, least = STRENGTHS[-1], np.inf
    for strength in reversed(STRENGTHS):
        if replace(found, strength=strength).effective > most:
            break
        missed = 0.0
        for i in keep:
            rest = np.zeros(len(blocks.size), dtype=np.bool_)
            rest[[0, *(j + 1 for j in keep if j != i)]] = True
            out = np.zeros(len(blocks.size), dtype=np.bool_)
            out[i + 1] = True
            missed += blocks.missed(rest, out, strength * rough)
        if missed < least:
            best, least = strength, missed
    return best
