"""Whether a recorded force acts between samples as a straight line, or held until the next as a controller's output."""

from dataclasses import replace

import numpy as np

from harness.diagnosis.baseline import base_names, driven_scales
from harness.diagnosis.fit import fit
from harness.diagnosis.observe import COARSE
from harness.diagnosis.parameters import free_of
from harness.diagnosis.problem import Problem
from harness.kernels.solve import Drive

_BETTER = 0.98
"""What chi-square must fall to for the force to count as held."""
_ITERATIONS = 8
_SAMPLES = 20_000


def held(problem: Problem) -> Drive:
    """The drive as it acts when each value is held: to the motion, half an interval later."""
    assert problem.drive is not None
    return Drive(problem.drive.t + 0.5 * float(np.median(np.diff(problem.drive.t))), problem.drive.u)


def is_held(problem: Problem) -> bool:
    """Whether the base model follows the recording better with the force held. Raises SimulationError as a fit does."""
    assert problem.restarts is not None
    part = problem.part(slice(0, _SAMPLES))
    model = problem.restarts.first
    scales, free = driven_scales(problem, model), free_of(model, base_names(problem))
    straight = fit(model, part, free, scales, _ITERATIONS, COARSE, thorough=False)
    stepped = fit(model, replace(part, drive=held(problem)), free, scales, _ITERATIONS, COARSE, thorough=False)
    return stepped.chi2 < _BETTER * straight.chi2
