"""Least squares of a model to a recording: Levenberg and Marquardt with exact sensitivities and bounds."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.events import Events
from harness.diagnosis.observe import FINE, Observation, observe
from harness.diagnosis.parameters import Free, values_of, with_values
from harness.diagnosis.problem import Problem
from harness.kernels.solve import Effort, Scales
from harness.model.model import Model

_FIRST_DAMPING = 1e-3
_DRAWS = 16
_REACHES = (1.0, 1.0, 0.5, 0.5, 0.25)
_LEFT_OUT = (3.0, 1.5)
"""Sampling intervals next to an event that are left out at first."""

_NEAR = 3.5
"""Standard deviations from which a sample beside a jump is looked at twice."""

_DONE = 1e-5
"""A step that promises less than this in chi-square changes nothing that anybody could see."""


@dataclass(frozen=True, slots=True)
class Fit:
    """A model fitted to a recording.

    chi2 : sum of squares in units of the noise. points : values fitted. residual : (N,) whitened, channels one after
    another. jacobian : (N, q), whitened, by the fitted numbers themselves. shown : what the sensors would have shown.
    """

    model: Model
    free: tuple[Free, ...]
    chi2: float
    points: int
    residual: FloatArray
    jacobian: FloatArray
    shown: Observation
    converged: bool

    @property
    def bic(self) -> float:
        """Bayesian information criterion with known noise: chi2 + q ln N."""
        return self.chi2 + len(self.free) * math.log(max(self.points, 2))

    @property
    def values(self) -> FloatArray:
        """Values of the fitted numbers, (q,)."""
        return values_of(self.model, self.free)

    def covariance(self) -> FloatArray:
        """Covariance of the fitted numbers, (q, q), for noise as estimated; numbers on a bound have none."""
        scale = np.sqrt(np.sum(self.jacobian**2, axis=0))
        safe = np.where(scale > 0.0, scale, 1.0)
        j = self.jacobian / safe
        inverse = np.linalg.pinv(j.T @ j, rcond=1e-13, hermitian=True)
        return np.asarray(inverse / np.outer(safe, safe), dtype=np.float64)


def whiten(problem: Problem, channel: str, values: FloatArray) -> FloatArray:
    """Residuals (n,) or partials (n, q) of a channel in units of its noise, colour taken out, unweighted ones zero."""
    noise, weight = problem.noise[channel], problem.weight[channel]
    scaled = values / noise.sigma
    if noise.phi != 0.0:
        # first-order colour: the innovation of each sample, where the one before it is its neighbour
        coloured = scaled.copy()
        coloured[1:] -= noise.phi * scaled[:-1]
        coloured[1:] /= math.sqrt(1.0 - noise.phi**2)
        scaled = coloured
    return scaled * (weight if values.ndim == 1 else weight[:, None])


def whitened(problem: Problem, values: Mapping[str, FloatArray]) -> FloatArray:
    """Residuals (n,) or partials (n, q) of all channels whitened, one channel after another.

    Where the noise of a force shows, all channels together tell of it: each sample counts as what it adds to those
    before it.
    """
    if problem.force_noise is not None:
        own = {c: values[c] for c in problem.channels}
        together, _ = problem.force_noise.whitened(problem.t, problem.noise, problem.weight, own)
        return np.concatenate([together[c] for c in problem.channels])
    return np.concatenate([whiten(problem, c, values[c]) for c in problem.channels])


def evaluate(
    model: Model,
    problem: Problem,
    free: tuple[Free, ...],
    scales: Scales | None = None,
    effort: Effort = FINE,
) -> tuple[FloatArray, FloatArray, Observation]:
    """Whitened residual (N,) and its partials (N, q) by the fitted numbers, data minus model."""
    shown = observe(model, problem, tuple(f.by for f in free), scales, effort)
    residual = whitened(problem, {c: y - shown.y[c] for c, y in problem.channels.items()})
    jacobian = whitened(problem, shown.dy)
    return residual, jacobian, shown


def _by_coordinates(jacobian: FloatArray, free: tuple[Free, ...], values: FloatArray) -> FloatArray:
    """Partials (N, q) by the coordinates that are fitted; infinite where one overflows."""
    with np.errstate(over="ignore"):
        return np.asarray(jacobian * [f.slope(v) for f, v in zip(free, values, strict=True)], dtype=np.float64)


def _descend(
    model: Model,
    problem: Problem,
    free: tuple[Free, ...],
    scales: Scales | None = None,
    iterations: int = 40,
    effort: Effort = FINE,
) -> Fit:
    """Levenberg and Marquardt's descent."""
    values = values_of(model, free)
    values = np.array(
        [f.outward(f.inward(v)) if not f.log or v > 0.0 else v for f, v in zip(free, values, strict=True)]
    )
    model = with_values(model, free, values)
    residual, jacobian, shown = evaluate(model, problem, free, scales, effort)
    chi2 = float(residual @ residual)
    damping, done = _FIRST_DAMPING, False
    for _ in range(iterations):
        j = _by_coordinates(jacobian, free, values)
        if not np.all(np.isfinite(j)):
            break  # a number has run away to where the law is its own limit
        scale = np.sqrt(np.einsum("ij,ij->j", j, j))
        scale[scale == 0.0] = 1.0
        j /= scale
        normal, gradient = j.T @ j, j.T @ residual
        # numbers that a bound holds stay out of the step
        held = np.array(
            [
                (v <= f.lower and g < 0.0) or (v >= f.upper and g > 0.0)
                for f, v, g in zip(free, values, gradient, strict=True)
            ]
        )
        moving = ~held
        improved = False
        for _ in range(12):
            step = np.zeros(len(free))
            n = normal[np.ix_(moving, moving)]
            try:
                step[moving] = np.linalg.solve(n + damping * np.eye(n.shape[0]), gradient[moving])
            except np.linalg.LinAlgError:
                damping *= 10.0
                continue
            promised = float(2.0 * step @ gradient - step @ normal @ step)
            if promised < _DONE:
                done = True
                break
            trial = np.array(
                [f.outward(f.inward(v) + float(np.clip(s / w, -2.0, 2.0) if f.log else s / w))
                 for f, v, s, w in zip(free, values, step, scale, strict=True)]
            )  # fmt: skip
            if not np.all(np.isfinite(trial)):
                damping *= 10.0
                continue
            try:
                candidate = with_values(model, free, trial)
                r, new_j, new_shown = evaluate(candidate, problem, free, scales, effort)
                new = float(r @ r)
            except SimulationError:
                new = math.inf
            if math.isfinite(new) and new < chi2:
                gained = chi2 - new
                ratio = gained / promised
                model, values, residual, jacobian, shown, chi2 = candidate, trial, r, new_j, new_shown, new
                damping = max(damping * (0.1 if ratio > 0.75 else (0.5 if ratio > 0.25 else 2.0)), 1e-12)
                improved = True
                done = gained < _DONE
                break
            damping *= 6.0
        if done or not improved:
            break
    return Fit(model, free, chi2, problem.points, residual, jacobian, shown, done)


def fit(
    model: Model,
    problem: Problem,
    free: tuple[Free, ...],
    scales: Scales | None = None,
    iterations: int = 40,
    effort: Effort = FINE,
    thorough: bool = True,
) -> Fit:
    """Fit the free numbers of a model, starting from its own values.

    An acceleration jumps at a reversal, so chi-square has a step wherever an event passes a sample, and a descent stops
    before the first. With ``thorough``, where a sample next to an event seems to lie on its wrong side, it is made
    without those samples too, and from the best of several points that this leaves open with all of them.
    Raises SimulationError when even the start cannot be simulated.
    """
    found = _descend(model, problem, free, scales, iterations, effort)
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
