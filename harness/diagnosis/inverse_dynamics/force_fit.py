"""Least squares of the force: inverse dynamics fitted to what was measured, with errors that allow for colour.

What a real drive leaves over is a force that no law of the model says (ripple, bending, heat), far above what its
encoder's noise makes of it; so the force is what is fitted. What is left is coloured: neighbouring values say the same
thing, so that a sum of squares counts as that of fewer values, and standard errors come from the residual's own
covariance with the partials (Newey and West 1987), not from a law of its noise.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.parameters import Free, bounds_of, coordinates_of, values_of, with_coordinates
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.measured import Measured
from harness.diagnosis.problems.simulated import COARSE, Observation, observe
from harness.fit.autocorrelation import Memory, memory
from harness.fit.covariance import covariance_of
from harness.fit.least_squares import Stop, Until, least_squares
from harness.kernels.solve import Scales
from harness.model.model import Model

_ITERATIONS = 25
"""Of a fit, bounds the work."""
_ALONE = 1e-12
"""Share of a direction's power below which the data does not see it."""
DONE = 1e-9
"""Share of the sum of squares below which a step is the last."""
ROUGHLY = 1e-5
"""The same where only the sum of squares is asked for: a fiftieth of a natural log for two thousand values."""
_REACH = 2.0
"""Correlation times over which partials and residual may go together."""


@dataclass(frozen=True, slots=True)
class ForceFit:
    """residual (m,), N: force measured minus asked for. jacobian (m, q): partials of the latter by the free numbers.

    begins : which values are the first of a further recording; of several, all are over the level of their recording.
    """

    model: Model
    free: tuple[Free, ...]
    residual: FloatArray
    jacobian: FloatArray
    begins: tuple[int, ...] = ()

    @property
    def squares(self) -> float:
        """Sum of squares of the residual, N^2."""
        return float(self.residual @ self.residual)

    @property
    def memory(self) -> Memory:
        """How long the residual remembers."""
        return memory(self.residual, begins=self.begins)

    def bic(self, independent: float, spare: float = 0.0) -> float:
        """Bayesian information criterion for noise of unknown level and so many independent values.

        spare : N^2 a value, taken off by chance alone, which does not count.
        """
        squares = self.squares + spare * self.residual.size
        return independent * math.log(squares) + len(self.free) * math.log(independent)

    def covariance(self) -> FloatArray:
        """Covariance (q, q) of the free numbers, colour and uneven size of the residual allowed for."""
        moments = self.jacobian * self.residual[:, None]
        lags = min(math.ceil(_REACH * self.memory.time), self.residual.size - 1)
        middle = moments.T @ moments
        for lag in range(1, lags + 1):
            for own in np.split(moments, self.begins):
                across = own[lag:].T @ own[:-lag]
                middle += (1.0 - lag / (lags + 1.0)) * (across + across.T)
        size = self.residual.size
        middle *= size / max(size - len(self.free), 1)
        bread = covariance_of(self.jacobian)
        return np.asarray(bread @ middle @ bread, dtype=np.float64)


@dataclass(frozen=True, slots=True)
class _Point:
    """A model beside a force (m,), N, that is measured. partials (m, q) : of the force that it asks for."""

    model: Model
    free: tuple[Free, ...]
    residual: FloatArray
    partials: FloatArray

    @property
    def squares(self) -> float:
        """Sum of squares of the force left over, N^2."""
        return float(self.residual @ self.residual)

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """By the coordinates that are fitted."""
        slopes = [f.slope(v) for f, v in zip(self.free, values_of(self.model, self.free), strict=True)]
        j = self.partials * slopes
        return j.T @ j, j.T @ self.residual


def fit_force(model: Model, measured: Measured, free: tuple[Free, ...], done: float = DONE) -> ForceFit:
    """Fit the free numbers of a model to the force, from its own values; SimulationError where a law overflows.

    done : share of the sum of squares below which a step is the last.
    """
    force = measured.blocks(measured.u)

    def evaluated(at: FloatArray) -> _Point:
        trial = with_coordinates(model, free, at)
        asked, by = measured.asked_by(trial, free)
        return _Point(trial, free, measured.even(force - asked), measured.even(by))

    found = least_squares(
        evaluated, coordinates_of(model, free), Until(share=done, iterations=_ITERATIONS), bounds_of(free)
    )
    at = found.point
    if not (math.isfinite(at.squares) and np.all(np.isfinite(at.partials))):
        raise SimulationError("a law's force overflows")
    return ForceFit(at.model, free, at.residual, at.partials, measured.begins)


def simulated(found: ForceFit, problem: Problem, scales: Scales) -> Observation:
    """The model's motion over the windows."""
    return observe(found.model, problem, (), scales, COARSE)


def as_fit(found: ForceFit, problem: Problem, measured: Measured, reference: ForceFit, shown: Observation) -> Fit:
    """A fit of the force as a fit: chi-square in units of what the reference leaves, its independent values counted.

    residual : of the force at the problem's samples, zero where it was not fitted, in the first channel's place.
    jacobian : any that has the covariance of the fit. shown : what the model shows over
    the windows.
    """
    independent, size = reference.memory.independent, found.residual.size
    level = math.sqrt(reference.squares / size)
    residual = np.zeros(problem.t.size * len(problem.channels))
    blocks = np.zeros(measured.moving.size)
    blocks[measured.moving] = found.residual / level
    residual[: measured.t.size] = np.repeat(blocks, measured.t.size // blocks.size)
    jacobian = np.zeros((residual.size, len(found.free)))
    jacobian[: len(found.free)] = _root_of_inverse(found.covariance())
    return Fit(
        found.model,
        found.free,
        independent * found.squares / reference.squares,
        max(round(independent), 1),
        residual,
        jacobian,
        shown,
        Stop.CONVERGED,
    )


def _root_of_inverse(covariance: FloatArray) -> FloatArray:
    """A matrix whose square is the inverse of a covariance (q, q); directions without variance count as unknown."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    scale[scale == 0.0] = 1.0
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    inverse = np.where(values > _ALONE, 1.0 / np.sqrt(np.maximum(values, _ALONE)), 0.0)
    root: FloatArray = (inverse[:, None] * vectors.T) / scale
    return root


def refitted(found: Fit, measured: Measured) -> Model:
    """The model of a fit, fitted to the blocks that count in ``measured``.

    Raises SimulationError where these are fewer than its numbers, or a law overflows.
    """
    if np.count_nonzero(measured.moving) <= len(found.free):
        raise SimulationError("the slider hardly moves")
    return fit_force(found.model, measured, found.free).model
