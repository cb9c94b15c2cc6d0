"""Whether a recorded force acts between samples as a straight line, or held until the next as a controller's output."""

from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
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
_STRAYS = 300.0


def held(t: FloatArray, u: FloatArray) -> Drive:
    """The drive of u (n,) at t (n,), s, as it acts when each value is held: to the motion, half an interval later."""
    return Drive(t + 0.5 * float(np.median(np.diff(t))), u)


def is_held(problem: Problem, u: FloatArray) -> bool:
    """Whether the base model follows the recording better with the force u (n,) held. Raises SimulationError."""
    assert problem.first is not None
    part = problem.part(slice(0, _SAMPLES))
    model = problem.first
    scales, free = driven_scales(problem, model), free_of(model, base_names(problem))
    straight = fit(model, part, free, scales, _ITERATIONS, COARSE, thorough=False)
    stepped = fit(model, replace(part, drive=held(problem.t, u)), free, scales, _ITERATIONS, COARSE, thorough=False)
    return stepped.chi2 < _BETTER * straight.chi2


def follows(problem: Problem) -> bool:
    """Whether the base model follows the whole from one start, but for a misfit that a law may explain.

    Where it strays by hundreds of times what the sensor's noise is, as an encoder shows of a real drive, no law says
    the force well enough for that: then the force itself is what can be compared. Raises SimulationError.
    """
    assert problem.first is not None
    part = problem.part(slice(0, _SAMPLES))
    scales = driven_scales(problem, problem.first)
    found = fit(problem.first, part, free_of(problem.first, base_names(problem)), scales, _ITERATIONS, COARSE, False)
    return found.chi2 < _STRAYS**2 * found.points
