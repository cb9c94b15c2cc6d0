"""Least squares of a model to a recording, with exact sensitivities; care where an event lies beside a sample.

The descent of a model's fitted numbers, whatever of a recording it is seen by.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.events import Events
from harness.diagnosis.fit.bounds import within
from harness.diagnosis.parameters import Free, bounds_of, coordinates_of, values_of, with_coordinates, with_values
from harness.diagnosis.problem import Observation, Problem
from harness.diagnosis.problems.simulated import FINE
from harness.fit.least_squares import Descent, Stop, Until, coloured_covariance, covariance_of, least_squares
from harness.fit.series import Memory, memory
from harness.kernels.solve import Effort, Scales
from harness.model.model import Model
from harness.model.term import Parameter, Term

S = TypeVar("S")


@dataclass(frozen=True, slots=True)
class At(Generic[S]):
    """A model beside its recording; coordinates are those of ``free``.

    residual (N,), jacobian (N, q) : data minus model and the model's partials by the fitted numbers. shown : what they
    were made from.
    """

    model: Model
    free: tuple[Free, ...]
    residual: FloatArray
    jacobian: FloatArray
    shown: S

    @property
    def squares(self) -> float:
        """Chi-square."""
        return float(self.residual @ self.residual)

    def normal_equations(self) -> tuple[FloatArray, FloatArray]:
        """By the coordinates that are fitted; infinite where a number has run away to a limit of its law."""
        values = values_of(self.model, self.free)
        with np.errstate(over="ignore", invalid="ignore"):
            j = self.jacobian * [f.slope(v) for f, v in zip(self.free, values, strict=True)]
            return j.T @ j, j.T @ self.residual


def downhill(
    model: Model, free: tuple[Free, ...], look: Callable[[Model], tuple[FloatArray, FloatArray, S]], until: Until
) -> Descent[At[S]]:
    """From a model's own values to where ``look`` (residual, partials and what they were made from) leaves least.

    Raises SimulationError when even the start cannot be looked at.
    """

    def evaluated(at: FloatArray) -> At[S]:
        candidate = with_coordinates(model, free, at)
        return At(candidate, free, *look(candidate))

    return least_squares(evaluated, coordinates_of(model, free), until, bounds_of(free))


_DRAWS = 16
_REACHES = (1.0, 1.0, 0.5, 0.5, 0.25)
"""Places drawn around a fit that stopped, and how far around, in its standard deviations, turn by turn."""
_LEFT_OUT = (3.0, 1.5)
"""Sampling intervals next to an event that are left out at first."""

_NEAR = 3.5
"""Standard deviations from which a sample beside a jump is looked at twice."""

_REACH = 2.0
"""Correlation times over which partials and a coloured residual may go together."""
HASTY = 1e-5
"""Of chi-square: a hasty descent that gains less in a step is near enough to be compared."""


class LawNumber(NamedTuple):
    """A fitted number of a law, which of its parameters it is, and its standard error."""

    law: Term
    which: int
    value: float
    error: float

    @property
    def parameter(self) -> Parameter:
        """What it is."""
        return self.law.parameters[self.which]

    def loose(self, most: float) -> bool:
        """Whether its standard error is so many times the number."""
        return self.error >= most * abs(self.value)


@dataclass(frozen=True, slots=True)
class Fit:
    """A model fitted to a recording.

    chi2 : sum of squares in units of the noise. points : values fitted. residual : (N,) whitened, rows one after
    another. jacobian : (N, q), whitened, by the fitted numbers themselves. shown : what the sensors would have shown.
    stop : why the descent ended. seams : see Problem.
    """

    model: Model
    free: tuple[Free, ...]
    chi2: float
    points: int
    residual: FloatArray
    jacobian: FloatArray
    shown: Observation
    stop: Stop
    seams: tuple[int, ...] | None = None

    @property
    def bic(self) -> float:
        """Bayesian information criterion with known noise: chi2 + q ln N."""
        return self.chi2 + len(self.free) * math.log(max(self.points, 2))

    @property
    def memory(self) -> Memory:
        """How long the residual remembers."""
        return memory(self.residual, begins=self.seams or ())

    def bic_of(self, independent: float, spare: float = 0.0) -> float:
        """Bayesian information criterion for noise of unknown level and so many independent values.

        spare : chi-square a value, taken off by chance alone, which does not count.
        """
        squares = self.chi2 + spare * self.residual.size
        return independent * math.log(squares) + len(self.free) * math.log(independent)

    def spare_within(self, independent: float, most: float) -> float:
        """The ``spare`` with which ``bic_of`` comes to ``most``."""
        squares = math.exp((most - len(self.free) * math.log(independent)) / independent)
        return (squares - self.chi2) / self.residual.size

    @property
    def as_named(self) -> bool:
        """Whether the numbers of every term, in this motion, are what its name says."""
        return self.model.as_named(*self._extent)

    @property
    def explains_as_named(self) -> bool:
        """The same of a model that leaves noise alone."""
        return self.model.as_named(*self._extent, explains=True)

    @property
    def _extent(self) -> tuple[float, float]:
        """How far (m) and how fast (m/s) the slider moves at most."""
        return float(np.max(np.abs(self.shown.x))), float(np.max(np.abs(self.shown.v)))

    @property
    def values(self) -> FloatArray:
        """Values of the fitted numbers, (q,)."""
        return values_of(self.model, self.free)

    def covariance(self) -> FloatArray:
        """Covariance of the fitted numbers, (q, q), for noise as estimated; numbers on a bound have none.

        Of a residual that is coloured by that of its own with the partials, whatever its size (Newey and West 1987).
        """
        if self.seams is None:
            return covariance_of(self.jacobian)
        lags = min(math.ceil(_REACH * self.memory.time), self.residual.size - 1)
        return coloured_covariance(self.jacobian, self.residual, lags, self.seams)


def of_laws(found: Fit) -> list[LawNumber]:
    """The fitted numbers that are laws' own, with their standard errors."""
    errors, terms = np.sqrt(np.maximum(np.diag(found.covariance()), 0.0)), found.model.terms
    return [
        LawNumber(terms[number.by[0]].term, number.by[1], float(value), float(error))
        for number, value, error in zip(found.free, found.values, errors, strict=True)
        if isinstance(number.by, tuple)
    ]


def whitened(problem: Problem, values: Mapping[str, FloatArray]) -> FloatArray:
    """Residuals (m,) or partials (m, q) of all rows whitened, one row after another."""
    white = problem.whitened(values)
    return np.concatenate([white[c] for c in problem.rows])


def evaluate(
    model: Model, problem: Problem, free: tuple[Free, ...], scales: Scales | None = None, effort: Effort = FINE
) -> tuple[FloatArray, FloatArray, Observation]:
    """Whitened residual (N,) and its partials (N, q) by the fitted numbers, data minus model.

    Raises SimulationError where model or partials cannot be followed.
    """
    shown = problem.shows(model, tuple(f.by for f in free), scales, effort)
    residual, jacobian = whitened(problem, problem.left(shown)), whitened(problem, shown.dy)
    if not np.isfinite(jacobian).all():
        # beside a law that is all but a jump, partials may grow beyond all bounds where the motion does not
        raise SimulationError("what the fitted numbers change of the motion could not be followed")
    return residual, jacobian, shown


def _descend(
    model: Model,
    problem: Problem,
    free: tuple[Free, ...],
    scales: Scales | None = None,
    iterations: int = 40,
    effort: Effort = FINE,
    share: float = 0.0,
) -> Fit:
    """The nearest fit downhill; share : of chi-square, that a step must gain to be followed by another."""
    free = within(free, model, problem, scales)
    gain, least = problem.settled
    until = Until(gain, max(share, least), iterations)
    found = downhill(model, free, lambda m: evaluate(m, problem, free, scales, effort), until)
    at = found.point
    return Fit(
        at.model, free, at.squares, problem.points, at.residual, at.jacobian, at.shown, found.stop, problem.seams
    )


def fit(
    model: Model,
    problem: Problem,
    free: tuple[Free, ...],
    scales: Scales | None = None,
    iterations: int = 40,
    effort: Effort = FINE,
    thorough: bool = True,
    share: float = HASTY,
) -> Fit:
    """Fit the free numbers of a model, starting from its own values.

    An acceleration jumps at a reversal, so chi-square has a step wherever an event passes a sample, and a descent stops
    before the first. With ``thorough``, where a sample next to an event seems to lie on its wrong side, it is made
    without those samples too, and from the best of several points that this leaves open with all of them. share : of
    chi-square, that a step must gain to be followed by another where it is not.
    Raises SimulationError when even the start cannot be simulated.
    """
    found = _descend(model, problem, free, scales, iterations, effort, 0.0 if thorough else share)
    if not thorough or not _misplaced(found, problem):
        return found
    smooth = found
    for width in _LEFT_OUT:
        apart = _apart_from(problem, smooth.shown.events, width)
        smooth = _descend(smooth.model, apart, free, scales, iterations, effort)
    best = min((found, _descend(smooth.model, problem, free, scales, iterations, effort)), key=lambda f: f.chi2)
    spread = _spread(smooth)
    random = np.random.default_rng(0)
    for reach in _REACHES:
        if not _misplaced(best, problem):
            break
        nearby = [_drawn(best, spread, reach * random.standard_normal(len(free))) for _ in range(_DRAWS)]
        start = min(nearby, key=lambda m: chi2_of(m, problem, scales, effort))
        tried = _descend(start, problem, free, scales, iterations, effort)
        best = min((best, tried), key=lambda f: f.chi2)
    return best


def _misplaced(found: Fit, problem: Problem) -> bool:
    """Whether an acceleration next to a jump, or at the start, stands out as if the event lay on its other side."""
    events = found.shown.events
    if "a" not in problem.channels or not len(events):
        return False
    t, sigma = problem.t, problem.noise["a"].sigma
    jumps = events.t[np.abs(events.a_after - events.a_before) > _NEAR * sigma]
    first = list(problem.channels).index("a") * t.size
    residual = np.abs(found.residual[first : first + t.size])
    after = np.searchsorted(t, jumps)
    beside = np.unique(np.clip(np.concatenate((after - 2, after - 1, after, after + 1, [0])), 0, t.size - 1))
    level = max(1.0, float(np.sqrt(np.mean(residual**2))))
    return bool(np.any(residual[beside] > _NEAR * level))


def _spread(smooth: Fit) -> FloatArray:
    """Matrix (q, q) that turns standard normal numbers into what the uncertainty of a fit leaves open."""
    values, vectors = np.linalg.eigh(smooth.covariance())
    spread: FloatArray = vectors * np.sqrt(np.maximum(values, 0.0))
    return spread


def _drawn(best: Fit, spread: FloatArray, draw: FloatArray) -> Model:
    """The model of a fit moved by a draw, within the bounds."""
    moved = best.values + spread @ draw
    moved = np.array([min(max(v, f.lower), f.upper) for f, v in zip(best.free, moved, strict=True)])
    return with_values(best.model, best.free, moved)


def chi2_of(model: Model, problem: Problem, scales: Scales | None = None, effort: Effort = FINE) -> float:
    """Chi-square of a model as it stands; infinite where it cannot be simulated."""
    try:
        residual, _, _ = evaluate(model, problem, (), scales, effort)
    except SimulationError:
        return math.inf
    return float(residual @ residual)


def _apart_from(problem: Problem, events: Events, width: float) -> Problem:
    """The problem without the accelerations within ``width`` sampling intervals of an event."""
    t = problem.t
    reach = width * float(np.median(np.diff(t)))
    after = np.clip(np.searchsorted(events.t, t), 1, len(events)) if len(events) else np.ones(t.size, dtype=np.int64)
    gap = np.minimum(np.abs(t - events.t[after - 1]), np.abs(t - events.t[np.minimum(after, len(events) - 1)]))
    keep = {c: gap > reach if c == "a" else np.ones(t.size, dtype=bool) for c in problem.channels}
    return problem.weighted(keep)
