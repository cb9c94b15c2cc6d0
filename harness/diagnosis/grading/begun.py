"""Laws as a search has begun them, where a misfit is looked at: they are gone on with, not looked for again."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.errors import SimulationError
from harness.diagnosis.fit.observe import COARSE
from harness.diagnosis.problem import Problem
from harness.kernels.solve import Scales, solve
from harness.model.model import Model


def from_within(models: Sequence[Model], problem: Problem, begin: float, scales: Scales) -> tuple[Model, ...]:
    """Models of a recording that begins later within the same motion, where their own motion is by then.

    begin : s. None of a recording that is simulated from more than one start or with covariates, and none that cannot
    be simulated.
    """
    if problem.covariates:
        return ()
    moved = []
    for model in models:
        starts = problem.starts.of(model)
        if len(starts) != 1:
            return ()
        with suppress(SimulationError):
            there = solve(starts[0].model, np.array([begin]), (), problem.drive, scales, COARSE, want_a=False)
            moved.append(replace(model, x0=float(there.x[0]), v0=float(there.v[0]), t0=begin))
    return tuple(moved)
