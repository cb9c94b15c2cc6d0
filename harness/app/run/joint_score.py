"""What one engine makes of a joint's dry friction: creep under a load, and when friction turns round."""

import logging
import math
from dataclasses import dataclass, replace

from harness.core.errors import SimulationError
from harness.core.scenario import Hold, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.engines import registry
from harness.engines.base import Preset, Settings, Task
from harness.fidelity.metrics import reversal_lead_s
from harness.fidelity.scenarios.hold import creep_m_s
from harness.results.joint import JointScore
from harness.robot.arm import Arm
from harness.robot.reduction import Reduced
from harness.robot.servo import words

LOGGER = logging.getLogger(__name__)
MUJOCO = "mujoco"
_HELD_FOR = 0.5
"""s."""
_SPRING = 4.0
"""Times dry friction a rad or m: the least spring under which a release of 1 turns round."""
_SWINGS = 2.0
"""Periods in which reversals are looked at."""


@dataclass(frozen=True, slots=True)
class Played:
    """A score, and the motions that it is of: held under the load, and swinging; None where they could not be run."""

    score: JointScore
    held: Trajectory | None
    swing: Trajectory | None


def played(
    arm: Arm, own: Reduced, f_k: float, load: float, softness: float, name: str, preset: Preset, dt: float
) -> Played:
    """Creep and lead in one engine; MuJoCo as shipped has the words of the model's file at its own step.

    softness : of MuJoCo's friction in the whole model, over that of the joint alone.
    """
    as_written = name == MUJOCO and preset == "as-shipped"
    settings: Settings = words(arm, own.joint) if as_written else {}
    step = float(arm.model.opt.timestep) if as_written else (dt if preset == "tuned" else None)
    soft = softness if name == MUJOCO else 1.0
    creep = lead = why = None
    held = swung = None
    try:
        engine = registry.load(name)
        loose = Slider(own.moved, 0.0, _SPRING * f_k, f_k)
        hold = Scenario("hold", loose, 0.0, 0.0, _HELD_FOR, Hold(load))
        alone = engine.simulate(Task(hold, "joint", preset, step, settings, restoring="none"))
        # the model of the joint alone holds it more firmly than the whole arm's
        held = replace(alone, x=soft * alone.x, v=soft * alone.v, a=soft * alone.a)
        creep = creep_m_s(held)
        sprung = replace(loose, k=max(own.gravity, loose.k))
        swing = Scenario("free-decay", sprung, 1.0, 0.0, _SWINGS * 2.0 * math.pi / sprung.omega_n)
        swung = engine.simulate(Task(swing, "joint", preset, step, settings))
        lead = reversal_lead_s(swung, sprung)
    except SimulationError as error:
        LOGGER.warning("%s %s: %s", name, preset, error)
        why = str(error)
    used = None if held is None else held.source
    score = JointScore(
        engine=name,
        preset=preset,
        version="" if used is None else used.version,
        dt_s=step if used is None else used.dt,
        creep=creep,
        reversal_lead_s=lead,
        settings={} if used is None else {k: list(v) if isinstance(v, tuple) else v for k, v in used.settings.items()},
        ignored=[] if used is None else list(used.ignored),
        error=why,
    )
    return Played(score, held, swung)
