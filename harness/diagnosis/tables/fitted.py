"""Tables as they were fitted, and the one way of fitting them: least squares with a penalty on roughness.

The penalty stands as rows below the recording's own (Craven and Wahba 1979, Numer. Math. 31, 377).

Tables fitted to a motion that is followed: each step of the fit is a simulation with its partials.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.fit.model_fit import evaluate
from harness.diagnosis.fit.observe import COARSE, Observation
from harness.diagnosis.fit.parameters import Free, bounds_of, coordinates_of, with_coordinates
from harness.diagnosis.problem import Problem
from harness.diagnosis.tables.basis import Basis
from harness.fit.covariance import inverse_of
from harness.fit.least_squares import Bounds, Until, least_squares
from harness.kernels.solve import Effort, Scales
from harness.model.model import Model

FIRST = 1e-2
"""Penalty of a first fit."""
_DONE = 1e-3
"""What a step must promise: the units are those of a misfit, thirty a word."""


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
    def curvature(self) -> "Curvature":
        """About the fit."""
        seen = self.jacobian.T @ self.jacobian
        return Curvature(seen, self.penalty.T @ self.penalty, len(self.free))

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
    b = len(free)

    def by_coordinates(look: Look) -> FloatArray:
        return np.hstack((look.jacobian[:, :b], look.jacobian[:, b:] @ basis.free))

    if penalty is None:
        first = by_coordinates(seen(basis.with_values(start, basis.free @ at)))
        penalty = scaled_penalty(basis, first[:, b:])
    rows = np.sqrt(strength) * penalty

    def evaluated(z: FloatArray) -> _Point:
        model = basis.with_values(with_coordinates(start, free, z[:b]), basis.free @ z[b:])
        look = seen(model)
        values = [f.outward(c) for f, c in zip(free, z[:b].tolist(), strict=True)]
        slopes = np.array([f.slope(v) for f, v in zip(free, values, strict=True)] + [1.0] * at.size)
        return _Point(model, look, by_coordinates(look), -rows @ z[b:], rows, slopes)

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
    return TableFit(basis, p.model, free, found.coordinates[b:], strength, penalty, p.look.residual, p.jacobian, p.look)


def scaled_penalty(basis: Basis, jacobian: FloatArray) -> FloatArray:
    """Rows of roughness (r, q), in the units in which the recording sees the tables' coordinates (N, q)."""
    rows = basis.rough @ basis.free
    weight = float(np.trace(jacobian.T @ jacobian)) / max(float(np.trace(rows.T @ rows)), 1e-300)
    return np.asarray(np.sqrt(weight) * rows, dtype=np.float64)


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
    """Fit base parameters and tables from a start; see ``minimised``.

    Raises SimulationError when the start cannot be simulated.
    """
    tables = tuple(Free(place, f"table {i}", -np.inf, np.inf, False) for i, place in enumerate(basis.places))

    def seen(model: Model) -> Look:
        residual, jacobian, shown = evaluate(model, problem, (*free, *tables), scales, effort)
        return Look(residual, jacobian, shown.x, shown.v, shown)

    return minimised(basis, start, at, free, seen, strength, penalty, iterations)
