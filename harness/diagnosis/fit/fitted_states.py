"""Starts of windows from what follows them: a smoothed channel is rounded off at its ends, a model's motion is not."""

import math
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.problems.simulated import COARSE, observe
from harness.diagnosis.starts import OneStart, Window
from harness.fit.least_squares import Residual, Until, covariance_of, least_squares
from harness.kernels.solve import By, Scales
from harness.model.model import Model

_CYCLE = 0.25
"""Cycles after a start that say where it was: too few for what a model lacks to show."""
_FEWEST = 12
"""Samples that say where a start was: three to each number of it."""
_ITERATIONS = 4
"""Of its fit, which begins near."""
_DONE = 1e-5
"""What a step must take off the squares, in units of the noise."""
_BY: tuple[By, ...] = ("x0", "v0")


def begun(problem: P, model: Model, scales: Scales) -> P:
    """The problem with each window's start fitted to what follows it within a quarter of a cycle, all else given."""
    length = _CYCLE * 2.0 * math.pi / scales.omega

    def anew(window: Window, started: Model) -> Window:
        return _fitted(problem, window, started, length, scales)

    return replace(problem, starts=problem.starts.moved(anew, model))


def _fitted(problem: Problem, w: Window, model: Model, length: float, scales: Scales) -> Window:
    """A window with the start that what follows tells best: in motion, or at rest unless that is worse.

    model : at the window's start.
    """
    t = problem.t
    stop = min(max(int(np.searchsorted(t, w.t0 + length)), w.start + _FEWEST), w.stop)
    part = replace(problem.part(slice(w.start, stop)), starts=OneStart())
    # smoothing rounds off a first motion out of rest
    tried = [_descended(part, w, replace(model, v0=0.0), _BY[:1], scales)]
    if model.v0 != 0.0:
        tried.append(_descended(part, w, model, _BY, scales))
    squares, found = min(tried, key=lambda one: one[0])
    return found if math.isfinite(squares) else w


def _descended(part: Problem, w: Window, model: Model, by: tuple[By, ...], scales: Scales) -> tuple[float, Window]:
    """Squares, in units of the noise, at the start that fits the samples of ``part`` best, and the window with it."""

    def started(at: FloatArray) -> Model:
        return replace(model, **dict(zip(map(str, by), at.tolist(), strict=True)))

    def evaluated(at: FloatArray) -> Residual:
        shown = observe(started(at), part, by, scales, COARSE)
        left = [(y - shown.y[c]) / part.noise[c].sigma for c, y in part.channels.items()]
        partials = [shown.dy[c] / part.noise[c].sigma for c in part.channels]
        return Residual(np.concatenate(left), np.concatenate(partials))

    start = np.array([getattr(model, str(b)) for b in by])
    try:
        found = least_squares(evaluated, start, Until(_DONE, iterations=_ITERATIONS))
    except SimulationError:
        return math.inf, w
    # what does not show, as a speed does not where it sticks, stays as it is and as well known as it was
    variances = np.diag(covariance_of(found.point.partials)).tolist()
    known = {b: math.sqrt(s) for b, s in zip(by, variances, strict=True) if s > 0.0}
    best = started(found.coordinates)
    x_sd, v_sd = min(known.get("x0", w.x_sd), w.x_sd), min(known.get("v0", w.v_sd), w.v_sd)
    return found.point.squares, replace(w, x0=best.x0 + best.offset, v0=best.v0, x_sd=x_sd, v_sd=v_sd)
