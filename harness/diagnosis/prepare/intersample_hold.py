"""Whether a recorded force acts between samples as a straight line, or held until the next as a controller's output."""

from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.baseline.base_fit import base_names, driven_scales
from harness.diagnosis.fit.least_squares import Fit, fit
from harness.diagnosis.fit.observe import COARSE
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.input_noise.noisy_base_fit import in_turn
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import FORCE_HELD
from harness.kernels.solve import Drive, Scales
from harness.model.model import Model

_ITERATIONS = 8
"""Of a first fit."""
_SAMPLES = 20_000
"""That tell whether a force is held, more than enough for a share of chi-square of 2 %."""
_STRAYS = 300.0
"""Standard deviations by which a simulation may miss on average; more, and it is another motion."""


def held(t: FloatArray, u: FloatArray) -> Drive:
    """The drive of u (n,) at t (n,), s, as it acts when each value is held: to the motion, half an interval later."""
    return Drive(t + 0.5 * float(np.median(np.diff(t))), u)


@dataclass(frozen=True, slots=True)
class Acting:
    """How a force acts. held : until the next sample. follows : whether the base model, fitted to a first part, does so
    from one start.
    """

    drive: Drive
    held: bool
    follows: bool
    model: Model


def acting(problem: Problem, u: FloatArray) -> Acting:
    """How the force u (n,) acts, and whether the base model then follows the recording.

    It is held where the base model follows the recording better so. The model strays where its misfit is hundreds of
    times what the sensor's noise is, as an encoder shows of a real drive: then no law says the force well enough, and
    the force itself is what can be compared. Raises SimulationError.
    """
    assert problem.first is not None
    assert problem.drive is not None
    part, stepped = problem.part(slice(0, _SAMPLES)), held(problem.t, u)
    straight, in_steps = (
        _followed(problem.first, replace(part, drive=drive), driven_scales(problem, problem.first))
        for drive in (problem.drive, stepped)
    )
    is_held = in_steps.chi2 < FORCE_HELD.value * straight.chi2
    found = in_steps if is_held else straight
    return Acting(stepped if is_held else problem.drive, is_held, found.chi2 < _STRAYS**2 * found.points, found.model)


def _followed(model: Model, problem: Problem, scales: Scales) -> Fit:
    """The base model as it follows a drive; over gaps from starts of which nothing counts as known."""
    free = free_of(model, base_names(problem))

    def again(problem: Problem, found: Fit) -> tuple[Problem, Fit]:
        return problem, fit(found.model, problem, free, scales, _ITERATIONS, COARSE, thorough=False)

    found = fit(model, problem, free, scales, _ITERATIONS, COARSE, thorough=False)
    return found if problem.restarts is None else in_turn(problem, found, scales, again)[1]
