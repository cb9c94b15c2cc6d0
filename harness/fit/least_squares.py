"""Least squares by Levenberg and Marquardt, within bounds: one loop, one damping, stops with names, and covariances.

Coordinates are scaled to unit columns of the Jacobian, and the damping follows how much of a promised fall a step keeps
(Marquardt 1963; More 1978). A coordinate that a bound holds takes no part in a step. The covariance of what was fitted
follows from the curvature of its sum of squares.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Generic, Protocol, TypeVar

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import SimulationError

_FIRST, _LEAST = 1e-3, 1e-12
"""Damping, in units of the scaled normal matrix's diagonal."""
_KEPT_MOST, _KEPT_SOME = 0.75, 0.25
"""Shares of the promised fall from which a step was a good one, and from which it was a fair one."""
_AFTER_GOOD, _AFTER_FAIR, _AFTER_POOR, _AFTER_REFUSED, _AFTER_SINGULAR = 0.1, 0.5, 2.0, 6.0, 10.0
_SAME = 0.1
"""Of a step that was refused: one that differs by less is not evaluated anew."""
_REFUSALS = 12
"""Steps refused one after another: the damping has then grown two billion times."""


class Stop(Enum):
    """Why a descent ended."""

    CONVERGED = "converged"
    NO_DESCENT = "no descent"
    ITERATIONS = "iterations used up"
    NOT_EVALUATED = "cannot be evaluated"


class Point(Protocol):
    """A sum of squares at some coordinates (q,), and what a step from there needs."""

    @property
    def squares(self) -> float:
        """Sum of squares of the residual; not finite where there is none."""

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """J'J (q, q) and J'r (q,), r = data - model, J partials of the model; asked for once, where a step begins."""


P = TypeVar("P", bound=Point)


@dataclass(frozen=True, slots=True)
class Until:
    """When a descent is done: a step promises or gains no more than ``gain`` + ``share`` of the squares, or
    ``iterations`` steps were made.
    """

    gain: float = 0.0
    share: float = 0.0
    iterations: int = 40


@dataclass(frozen=True, slots=True)
class Bounds:
    """Of coordinates, each (q,): lower, upper, and the longest move of one step."""

    lower: FloatArray
    upper: FloatArray
    longest: FloatArray

    @classmethod
    def of(cls, count: int, lower: float = -math.inf, upper: float = math.inf, longest: float = math.inf) -> "Bounds":
        """The same for each of ``count`` coordinates."""
        return cls(np.full(count, lower), np.full(count, upper), np.full(count, longest))

    def held(self, at: FloatArray, pull: FloatArray) -> BoolArray:
        """Which coordinates (q,) stand on a bound that the descent along ``pull`` (q,) would cross."""
        return ((at <= self.lower) & (pull < 0.0)) | ((at >= self.upper) & (pull > 0.0))

    def moved(self, at: FloatArray, step: FloatArray) -> FloatArray:
        """Coordinates (q,) after a step (q,)."""
        return np.clip(at + np.clip(step, -self.longest, self.longest), self.lower, self.upper)


@dataclass(frozen=True, slots=True)
class Descent(Generic[P]):
    """Where a descent ended: coordinates (q,), what was found there, why it ended, and after how many steps."""

    coordinates: FloatArray
    point: P
    stop: Stop
    steps: int


@dataclass(frozen=True, slots=True)
class Residual:
    """A point given by its residual (n,), data minus model, and the model's partials (n, q)."""

    residual: FloatArray
    partials: FloatArray

    @property
    def squares(self) -> float:
        """Sum of squares of the residual."""
        return float(self.residual @ self.residual)

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """J'J (q, q) and J'r (q,)."""
        return self.partials.T @ self.partials, self.partials.T @ self.residual


def least_squares(
    evaluate: Callable[[FloatArray], P], start: FloatArray, until: Until, bounds: Bounds | None = None
) -> Descent[P]:
    """The least sum of squares that descends from ``start`` (q,), brought within the bounds first.

    A step is refused where ``evaluate`` raises SimulationError or squares are not finite; at the start the error is the
    caller's.
    """
    bounds = bounds or Bounds.of(start.size)
    at = np.clip(start, bounds.lower, bounds.upper)
    point, damping = evaluate(at), _FIRST
    if not math.isfinite(point.squares):
        return Descent(at, point, Stop.NOT_EVALUATED, 0)
    for steps in range(until.iterations):
        normal, pull = point.normal_equations()
        if not (np.isfinite(normal).all() and np.isfinite(pull).all()):
            return Descent(at, point, Stop.NOT_EVALUATED, steps)
        scale = np.sqrt(np.maximum(normal.diagonal(), 0.0))
        scale[scale == 0.0] = 1.0
        normal, pull = normal / (scale[:, None] * scale), pull / scale
        moving = ~bounds.held(at, pull)
        enough = until.gain + until.share * point.squares
        refused = failed = 0
        aim, trial = at, None
        better: P | None = None
        while better is None and refused < _REFUSALS:
            step = _step(normal, pull, moving, damping)
            promised = 0.0 if step is None else float(2.0 * step @ pull - step @ normal @ step)
            if step is not None and promised <= enough:
                break
            if step is not None:
                before, aim = aim, bounds.moved(at, step / scale)
                # damping far below the curvature leaves a step as it is: what was refused is refused again
                if _far(aim - before, scale) >= _SAME * _far(before - at, scale):
                    trial = _tried(evaluate, aim)
                else:
                    aim = before
            if trial is not None and trial[1].squares < point.squares:
                gained = point.squares - trial[1].squares
                (at, better) = trial
                # a step that had to be shortened ends where a longer one fails: the next one begins as short
                damping = max(damping * max(_factor(gained / promised), 1.0 if refused else 0.0), _LEAST)
            else:
                refused += 1
                failed += trial is None
                damping *= _AFTER_SINGULAR if step is None else _AFTER_REFUSED
        if better is None:
            return Descent(at, point, _why(refused, failed), steps)
        point = better
        if gained <= enough:
            return Descent(at, point, Stop.CONVERGED, steps + 1)
    return Descent(at, point, Stop.ITERATIONS, until.iterations)


def _step(normal: FloatArray, pull: FloatArray, moving: BoolArray, damping: float) -> FloatArray | None:
    """The damped step (q,) of the coordinates that move, in units of their scale; None where there is none."""
    part = normal if moving.all() else normal[np.ix_(moving, moving)]
    damped = part.copy()
    damped.flat[:: part.shape[0] + 1] += damping
    step = np.zeros(pull.size)
    try:
        step[moving] = np.linalg.solve(damped, pull[moving])
    except np.linalg.LinAlgError:
        return None
    return step if np.isfinite(step).all() else None


def _far(move: FloatArray, scale: FloatArray) -> float:
    """Length of a move (q,) of coordinates in units of their scale."""
    return float(np.linalg.norm(move * scale))


def _tried(evaluate: Callable[[FloatArray], P], at: FloatArray) -> tuple[FloatArray, P] | None:
    """A point that can be evaluated."""
    if not np.isfinite(at).all():
        return None
    try:
        point = evaluate(at)
    except SimulationError:
        return None
    return (at, point) if math.isfinite(point.squares) else None


def _factor(kept: float) -> float:
    """By what the damping changes after a step that kept this share of the fall it promised."""
    return _AFTER_GOOD if kept > _KEPT_MOST else _AFTER_FAIR if kept > _KEPT_SOME else _AFTER_POOR


def _why(refused: int, failed: int) -> Stop:
    """Why no step was made: none promised enough, or of those that did none descended or none could be evaluated."""
    if refused == 0:
        return Stop.CONVERGED
    return Stop.NOT_EVALUATED if failed == refused else Stop.NO_DESCENT


_SEEN = 1e-13
"""Share of the largest eigenvalue, columns scaled to one, below which a direction is rounding."""


def inverse_of(normal: FloatArray) -> FloatArray:
    """Pseudo-inverse (q, q) of normal equations J'J (q, q), each column brought to its own unit first.

    Numbers that do not show, and directions that rounding alone tells apart, get no variance.
    """
    scale = np.sqrt(np.maximum(np.diag(normal), 0.0))
    scale[scale == 0.0] = 1.0
    units = np.outer(scale, scale)
    return np.asarray(np.linalg.pinv(normal / units, rcond=_SEEN, hermitian=True) / units, dtype=np.float64)


def covariance_of(partials: FloatArray) -> FloatArray:
    """Covariance (q, q) of numbers with these partials (n, q) of a residual of unit variance, n values.

    As ``inverse_of`` of their normal equations; from their triangle, which keeps twice as many digits where two numbers
    hardly part.
    """
    scale = np.sqrt(np.sum(partials**2, axis=0))
    scale[scale == 0.0] = 1.0
    triangle = np.linalg.qr(partials / scale, mode="r")
    inverse = np.linalg.pinv(triangle, rcond=math.sqrt(_SEEN)) / scale[:, None]
    return np.asarray(inverse @ inverse.T, dtype=np.float64)


def coloured_covariance(
    partials: FloatArray, residual: FloatArray, lags: int, begins: tuple[int, ...] = ()
) -> FloatArray:
    """Covariance (q, q) of numbers with these partials (n, q), colour and uneven size of a residual (n,) allowed for.

    lags : over which the two may go together. begins : of further series laid behind the first (Newey and West 1987,
    Econometrica 55, 703).
    """
    moments = partials * residual[:, None]
    middle = moments.T @ moments
    for lag in range(1, lags + 1):
        for own in np.split(moments, begins):
            across = own[lag:].T @ own[:-lag]
            middle += (1.0 - lag / (lags + 1.0)) * (across + across.T)
    size, count = partials.shape
    middle *= size / max(size - count, 1)
    bread = covariance_of(partials)
    return np.asarray(bread @ middle @ bread, dtype=np.float64)
