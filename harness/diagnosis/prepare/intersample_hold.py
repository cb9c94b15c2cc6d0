"""Whether a recorded force acts between samples as a straight line, or held until the next as a controller's output."""

from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.baseline.driven_base_fit import driven_scales
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.observe import COARSE
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.input_noise.noisy_base_fit import in_turn
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.starts import Windows
from harness.diagnosis.rules import FORCE_HELD
from harness.kernels.solve import Drive, Scales
from harness.model.model import Model

_ITERATIONS = 8
"""Of a first fit."""
_SAMPLES = 20_000
"""That tell whether a force is held, more than enough for a share of chi-square of 2 %."""
_STRAYS = 300.0
"""Standard deviations by which a simulation may miss on average; more, and it is another motion."""


ACTS_HELD = "the force acts as a sampled controller's, held from each sample to the next"


def held(t: FloatArray, u: FloatArray) -> Drive:
    """The drive of u (n,) at t (n,), s, as it acts when each value is held: to the motion, half an interval later."""
    return Drive(t + 0.5 * float(np.median(np.diff(t))), u)


@dataclass(frozen=True, slots=True)
class Acting:
    """How a force acts. otherwise : the other way. held : until the next sample. follows : whether the base model,
    fitted to a first part, does so from one start.
    """

    drive: Drive
    otherwise: Drive
    held: bool
    follows: bool
    model: Model


def acting(problem: Driven, u: FloatArray) -> Acting:
    """How the force u (n,) acts, and whether the base model then follows the recording.

    It is held where the base model follows the recording better so. The model strays where its misfit is hundreds of
    times what the sensor's noise is, as an encoder shows of a real drive: then no law says the force well enough, and
    the force itself is what can be compared. Raises SimulationError.
    """
    part, stepped = problem.part(slice(0, _SAMPLES)), held(problem.t, u)
    straight, in_steps = (
        _followed(problem.first, replace(part, drive=drive), driven_scales(problem, problem.first))
        for drive in (problem.drive, stepped)
    )
    is_held = in_steps.chi2 < FORCE_HELD.value * straight.chi2
    found = in_steps if is_held else straight
    drive, otherwise = (stepped, problem.drive) if is_held else (problem.drive, stepped)
    return Acting(drive, otherwise, is_held, found.chi2 < _STRAYS**2 * found.points, found.model)


def _followed(model: Model, problem: Driven, scales: Scales) -> Fit:
    """The base model as it follows a drive; over gaps from starts of which nothing counts as known."""
    free = free_of(model, problem.base_names)

    def again(problem: Driven, found: Fit) -> tuple[Driven, Fit]:
        return problem, fit(found.model, problem, free, scales, _ITERATIONS, COARSE, thorough=False)

    found = fit(model, problem, free, scales, _ITERATIONS, COARSE, thorough=False)
    return in_turn(problem, found, scales, again)[1] if isinstance(problem.starts, Windows) else found
