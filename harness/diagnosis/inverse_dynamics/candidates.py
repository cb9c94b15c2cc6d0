"""Laws as inverse dynamics show them, for a search that follows the motion.

A first look at a motion that has gone astray says little: what a law would change is seen from where the slider is not.
What is left of the force is told place by place and speed by speed, wherever a simulation may be.
"""

import math
from contextlib import suppress
from dataclasses import replace

from harness.core.errors import SimulationError
from harness.diagnosis.inverse_dynamics.search import extended, force_baseline
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.inverse_dynamics import InverseDynamics
from harness.diagnosis.smoothed_state.state import Course
from harness.model.model import Model

_LAWS = 6
"""Laws that go on, of those that say most of the force: they bound the work."""


def by_the_force(problem: Driven, base: Model) -> tuple[Model, ...]:
    """The base model with one law each, and with numbers that its force asks for; none where too little moves.

    base : fitted to the motion, released as these are.
    """
    with suppress(SimulationError):
        forces = InverseDynamics.of(problem, Course.of(problem.t, problem.channels, problem.noise).anew(math.inf))
        measured, found, scales = force_baseline(forces)
        laws = extended(found, measured, forces, scales)[:_LAWS]
        return tuple(_released_as(base, one.model) for one in laws)
    return ()


def _released_as(base: Model, model: Model) -> Model:
    return replace(model, x0=base.x0 + base.offset - model.offset, v0=base.v0, t0=base.t0)
