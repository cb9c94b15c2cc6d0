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
from harness.diagnosis.driven.measured import Measured
from harness.diagnosis.fit import Fit
from harness.diagnosis.observe import COARSE, Observation, observe
from harness.diagnosis.parameters import Free, values_of, with_values
from harness.diagnosis.problem import Problem
from harness.kernels.solve import Scales
from harness.model.model import Model

_STEP = 1e-6
_FIRST_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-6, 1e-12, 1e6
_ITERATIONS = 25
_DONE = 1e-7
"""Share of the sum of squares below which a step is the last."""
_LONGEST = 0.1
"""Share of the values over which colour is looked for."""
_REACH = 2.0
"""Correlation times over which partials and residual may go together."""


@dataclass(frozen=True, slots=True)
class ForceFit:
    """residual (m,), N: force measured minus asked for. jacobian (m, q): partials of the latter by the free numbers."""

    model: Model
    free: tuple[Free, ...]
    residual: FloatArray
    jacobian: FloatArray

    @property
    def squares(self) -> float:
        """Sum of squares of the residual, N^2."""
        return float(self.residual @ self.residual)

    def independent(self) -> float:
        """How many independent values the residual counts as: its number over its correlation time."""
        return self.residual.size / correlation_time(self.residual)

    def bic(self, independent: float, spare: float = 0.0) -> float:
        """Bayesian information criterion for noise of unknown level and so many independent values.

        spare : N^2 a value, taken off by chance alone, which does not count.
        """
        squares = self.squares + spare * self.residual.size
        return independent * math.log(squares) + len(self.free) * math.log(independent)

    def covariance(self) -> FloatArray:
        """Covariance (q, q) of the free numbers, colour and uneven size of the residual allowed for."""
        scale = np.sqrt(np.sum(self.jacobian**2, axis=0))
        scale[scale == 0.0] = 1.0
        j = self.jacobian / scale
        inverse = np.linalg.pinv(j.T @ j, rcond=1e-12, hermitian=True)
        moments = j * self.residual[:, None]
        lags = min(math.ceil(_REACH * correlation_time(self.residual)), self.residual.size - 1)
        middle = moments.T @ moments
        for lag in range(1, lags + 1):
            across = moments[lag:].T @ moments[:-lag]
            middle += (1.0 - lag / (lags + 1.0)) * (across + across.T)
        size = self.residual.size
        middle *= size / max(size - len(self.free), 1)
        return np.asarray(inverse @ middle @ inverse / np.outer(scale, scale), dtype=np.float64)


def correlation_time(residual: FloatArray) -> float:
    """Integrated correlation time of a residual (m,), in values, at least 1; up to the first lags without any."""
    size = residual.size
    spectrum = np.abs(np.fft.rfft(residual, 2 * size)) ** 2
    lagged = np.fft.irfft(spectrum)[: max(int(_LONGEST * size), 2)]
    if lagged[0] <= 0.0:
        return 1.0
    share = lagged / lagged[0]
    # pairs of lags, as a noisy correlation swings about zero (Geyer 1992)
    pairs = share[1 : 2 * ((share.size - 1) // 2) + 1].reshape(-1, 2).sum(axis=1)
    ends = np.flatnonzero(pairs <= 0.0)
    return max(1.0, 1.0 + 2.0 * float(np.sum(pairs[: ends[0] if ends.size else pairs.size])))


def partials(model: Model, measured: Measured, free: tuple[Free, ...], asked: FloatArray) -> FloatArray:
    """Partials (m, q) of the force asked for, (m,), by differences: most laws are linear, none has an event here."""
    values = values_of(model, free)
    columns = []
    for i, f in enumerate(free):
        moved = values.copy()
        step = _STEP * (abs(values[i]) or 1.0)
        moved[i] += step if values[i] + step <= f.upper else -step
        columns.append((measured.asked(with_values(model, free, moved)) - asked) / (moved[i] - values[i]))
    return np.column_stack(columns)


def fit_force(model: Model, measured: Measured, free: tuple[Free, ...]) -> ForceFit:
    """Fit the free numbers of a model to the force, from its own values, by Levenberg and Marquardt within bounds."""
    force = measured.blocks(measured.u)
    best = _seen(model, measured, free, force)
    damping = _FIRST_DAMPING
    for _ in range(_ITERATIONS):
        values = values_of(best.model, free)
        slopes = np.array([f.slope(v) for f, v in zip(free, values, strict=True)])
        j = best.jacobian * slopes
        scale = np.sqrt(np.sum(j**2, axis=0))
        scale[scale == 0.0] = 1.0
        j = j / scale
        normal, gradient = j.T @ j, j.T @ best.residual
        better: ForceFit | None = None
        while better is None and damping < _MOST_DAMPING:
            try:
                step = np.linalg.solve(normal + damping * np.eye(len(free)), gradient) / scale
            except np.linalg.LinAlgError:
                # numbers of one effect, told apart by rounding alone
                damping *= 10.0
                continue
            moved = [
                f.outward(f.inward(v) + float(s)) for f, v, s in zip(free, values, _limited(step, free), strict=True)
            ]
            trial = with_values(best.model, free, np.array(moved))
            left = force - measured.asked(trial)
            if np.all(np.isfinite(left)) and float(left @ left) < best.squares:
                better = _seen(trial, measured, free, force)
                damping = max(0.1 * damping, _LEAST_DAMPING)
            else:
                damping *= 10.0
        if better is None:
            break
        gained, best = 1.0 - better.squares / best.squares, better
        if gained < _DONE:
            break
    return best


def _limited(step: FloatArray, free: tuple[Free, ...]) -> FloatArray:
    """A step in the coordinates that are fitted, logarithms by no more than two."""
    limit = np.array([2.0 if f.log else math.inf for f in free])
    return np.clip(step, -limit, limit)


def _seen(model: Model, measured: Measured, free: tuple[Free, ...], force: FloatArray) -> ForceFit:
    left = force - measured.asked(model)
    if not np.all(np.isfinite(left)):
        raise SimulationError("a law's force overflows")
    jacobian = partials(model, measured, free, force - left)
    if not np.all(np.isfinite(jacobian)):
        raise SimulationError("a law's partials overflow")
    return ForceFit(model, free, left, jacobian)


def simulated(found: ForceFit, problem: Problem, scales: Scales) -> Observation:
    """The model's motion over the windows."""
    return observe(found.model, problem, (), scales, COARSE)


def as_fit(found: ForceFit, problem: Problem, measured: Measured, reference: ForceFit, shown: Observation) -> Fit:
    """A fit of the force as a fit: chi-square in units of what the reference leaves, its independent values counted.

    residual : of the force at the problem's samples, zero where it was not fitted, in the first channel's place.
    jacobian : any that has the covariance of the fit. shown : what the model shows over
    the windows.
    """
    independent, size = reference.independent(), found.residual.size
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
        True,
    )


def _root_of_inverse(covariance: FloatArray) -> FloatArray:
    """A matrix whose square is the inverse of a covariance (q, q); directions without variance count as unknown."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    scale[scale == 0.0] = 1.0
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    inverse = np.where(values > 1e-12, 1.0 / np.sqrt(np.maximum(values, 1e-12)), 0.0)
    root: FloatArray = (inverse[:, None] * vectors.T) / scale
    return root


def refitted(found: Fit, measured: Measured) -> Model:
    """The model of a fit, fitted to the blocks that count in ``measured``."""
    return fit_force(found.model, measured, found.free).model
