"""Starts of windows from what follows them: a smoothed channel is rounded off at its ends, a model's motion is not."""

import math
from dataclasses import replace

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.driven.starts import Start, starts_of
from harness.diagnosis.observe import COARSE, observe
from harness.diagnosis.problem import Problem, Window
from harness.kernels.solve import Scales
from harness.model.model import Model

_CYCLE = 0.25
"""Cycles after a start that say where it was: too few for what a model lacks to show."""
_FEWEST = 12
_ITERATIONS = 4
_BY = ("x0", "v0")


def begun(problem: Problem, model: Model, scales: Scales) -> Problem:
    """The problem with each window's start fitted to what follows it within a quarter of a cycle, all else given."""
    if problem.restarts is None:
        return problem
    length = _CYCLE * 2.0 * math.pi / scales.omega
    windows = tuple(_fitted(problem, start, length, scales) for start in starts_of(model, problem.restarts))
    return replace(problem, restarts=replace(problem.restarts, windows=windows))


def _fitted(problem: Problem, start: Start, length: float, scales: Scales) -> Window:
    """A window with the start that Gauss and Newton find, and its standard errors; as it was where they find none."""
    w, t = start.window, problem.t
    stop = min(max(int(np.searchsorted(t, w.t0 + length)), w.start + _FEWEST), w.stop)
    part = replace(problem.part(slice(w.start, stop)), restarts=None, force_noise=None)
    best, found = math.inf, w
    model = start.model
    try:
        for _ in range(_ITERATIONS):
            shown = observe(model, part, _BY, scales, COARSE)
            over = [(1.0 / part.noise[c].sigma, c) for c in part.channels]
            left = np.concatenate([s * (part.channels[c] - shown.y[c]) for s, c in over])
            partials = np.concatenate([s * shown.dy[c] for s, c in over])
            squares = float(left @ left)
            if not squares < best:
                break
            size = np.linalg.norm(partials, axis=0)
            known = size > 0.0
            inverse = np.linalg.pinv((partials[:, known] / size[known]).T @ (partials[:, known] / size[known]))
            sd = np.array([w.x_sd, w.v_sd])
            sd[known] = np.sqrt(np.diag(inverse)) / size[known]
            best = squares
            found = replace(
                w, x0=model.x0 + model.offset, v0=model.v0, x_sd=min(sd[0], w.x_sd), v_sd=min(sd[1], w.v_sd)
            )
            step = np.zeros(2)
            step[known] = inverse @ (partials[:, known] / size[known]).T @ left / size[known]
            model = replace(model, x0=model.x0 + float(step[0]), v0=model.v0 + float(step[1]))
    except SimulationError:
        return found
    return found
