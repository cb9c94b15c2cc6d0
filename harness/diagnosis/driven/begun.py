"""Starts of windows from what follows them: a smoothed channel is rounded off at its ends, a model's motion is not."""

import math
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.driven.starts import Start, starts_of
from harness.diagnosis.observe import COARSE, observe
from harness.diagnosis.problem import Problem, Window
from harness.kernels.solve import By, Scales
from harness.model.model import Model

_CYCLE = 0.25
"""Cycles after a start that say where it was: too few for what a model lacks to show."""
_FEWEST = 12
_ITERATIONS = 4
_BY: tuple[By, ...] = ("x0", "v0")


def begun(problem: Problem, model: Model, scales: Scales) -> Problem:
    """The problem with each window's start fitted to what follows it within a quarter of a cycle, all else given."""
    if problem.restarts is None:
        return problem
    length = _CYCLE * 2.0 * math.pi / scales.omega
    windows = tuple(_fitted(problem, start, length, scales) for start in starts_of(model, problem.restarts))
    return replace(problem, restarts=replace(problem.restarts, windows=windows))


def _fitted(problem: Problem, start: Start, length: float, scales: Scales) -> Window:
    """A window with the start that what follows tells best: in motion, or at rest unless that is worse."""
    w, t = start.window, problem.t
    stop = min(max(int(np.searchsorted(t, w.t0 + length)), w.start + _FEWEST), w.stop)
    part = replace(problem.part(slice(w.start, stop)), restarts=None, force_noise=None)
    # smoothing rounds off a first motion out of rest
    tried = [_descended(part, w, replace(start.model, v0=0.0), _BY[:1], scales)]
    if start.model.v0 != 0.0:
        tried.append(_descended(part, w, start.model, _BY, scales))
    squares, found = min(tried, key=lambda one: one[0])
    return found if math.isfinite(squares) else w


def _descended(part: Problem, w: Window, model: Model, by: tuple[By, ...], scales: Scales) -> tuple[float, Window]:
    """Squares that Gauss and Newton reach by these of the start, in units of the noise, and the window with it."""
    best, found, spread = math.inf, w, {"x0": w.x_sd, "v0": w.v_sd}
    with suppress(SimulationError):
        for _ in range(_ITERATIONS):
            shown = observe(model, part, by, scales, COARSE)
            left = np.concatenate([(y - shown.y[c]) / part.noise[c].sigma for c, y in part.channels.items()])
            partials = np.concatenate([shown.dy[c] / part.noise[c].sigma for c in part.channels])
            squares = float(left @ left)
            if not squares < best:
                break
            # what does not show, as a speed does not where it sticks, stays as it is
            inverse = np.linalg.pinv(partials.T @ partials, hermitian=True)
            sd = {b: math.sqrt(s) for b, s in zip(by, np.diag(inverse).tolist(), strict=True) if s > 0.0}
            known = {b: min(sd.get(b, s), s) for b, s in spread.items()}
            x_sd, v_sd = known["x0"], known["v0"]
            best, found = squares, replace(w, x0=model.x0 + model.offset, v0=model.v0, x_sd=x_sd, v_sd=v_sd)
            step = dict(zip(by, (inverse @ partials.T @ left).tolist(), strict=True))
            model = replace(model, x0=model.x0 + step["x0"], v0=model.v0 + step.get("v0", 0.0))
    return best, found
