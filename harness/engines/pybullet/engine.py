"""PyBullet: spring and driving forces as a torque each step, dry friction as a velocity motor limited to f_k."""

import time
from typing import Any, ClassVar, final

from harness.core.quiet import quiet
from harness.core.registered import version
from harness.core.trajectory import Trajectory
from harness.engines.base import TUNED_DT, Engine, Preset, Route, Task, resolve
from harness.engines.pybullet import loop
from harness.engines.pybullet.world import log, opened
from harness.engines.samples import trajectory

SHIPPED_DT = 1.0 / 240.0
"""PyBullet's own step, s."""

CONTACT_ONLY = ("contactERP", "frictionERP", "contactSlop", "contactBreakingThreshold", "frictionAnchor")


def presets(route: Route, preset: Preset, dt: float | None) -> dict[str, Any]:
    """Every setting of a preset; see harness.engines.base.Engine.presets.

    leapfrog : read PyBullet's step (v+ = v + dt a(x), x+ = x + dt v+) as the leapfrog it is: the run starts with the
    speed of half a step earlier, damping is scaled to act on the speed in the middle, and the speed of a sample is the
    mean of those half a step to either side. The other names are PyBullet's own.
    """
    settings: dict[str, Any] = {
        "dt": SHIPPED_DT if dt is None else dt,
        "leapfrog": False,
        "numSolverIterations": 50,
        "solverResidualThreshold": 1e-7,
        "numSubSteps": 0,
        "linearDamping": 0.04,
        "angularDamping": 0.04,
        "maxJointVelocity": 100.0,
        "contactERP": 0.08,
        "frictionERP": 0.2,
        "contactSlop": 1e-5,
        "contactBreakingThreshold": 0.02,
        "frictionAnchor": False,
    }
    if preset == "tuned":
        settings |= {
            "dt": TUNED_DT if dt is None else dt,
            "leapfrog": True,
            "linearDamping": 0.0,
            "angularDamping": 0.0,
            "maxJointVelocity": 1e9,
        }
    return settings


def unused(settings: dict[str, Any], shipped: dict[str, Any], route: Route) -> tuple[str, ...]:
    """What PyBullet does not honour, of the model and of settings that differ from what ships, one sentence each."""
    lines = [
        "URDF spring: the format has none, -k x is applied as a force that PyBullet holds over each step",
        "MJCF: loadMJCF would ignore stiffness, damping and frictionloss, so the URDF is loaded",
    ]
    if route == "joint":
        lines.append("URDF joint friction: read but without effect, a velocity motor limited to f_k stands for it")
    if route != "contact":
        differ = [name for name in CONTACT_ONLY if settings[name] != shipped[name]]
        lines += [f"{name}: there is no contact on this route" for name in differ]
    if settings["numSubSteps"] > 1:
        lines.append("numSubSteps: applied forces stay frozen during sub-steps")
    return tuple(lines)


@final
class PybulletEngine(Engine):
    """PyBullet on one prismatic joint (joint and law routes) or a box that slides and lifts (contact route)."""

    name: ClassVar[str] = "pybullet"

    def version(self) -> str:
        """Version of the pybullet package."""
        return version("pybullet")

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        """Settings of a preset; see Engine.presets."""
        return presets(route, preset, dt)

    def simulate(self, task: Task) -> Trajectory:
        """Run a task; see Engine.simulate."""
        settings = resolve(self, task)
        ignored = unused(settings, self.presets(task.route, "as-shipped", task.dt), task.route)
        planned = loop.plan(task, settings)
        model, substeps = loop.model(planned), max(1, settings["numSubSteps"])
        with quiet(log), opened(model, task.route, settings, task.scenario.x0, planned.first_speed) as world:
            started = time.perf_counter()
            motion = loop.motion(planned, world, substeps)
            wall = time.perf_counter() - started
        return trajectory(self, task, settings, ignored, motion, wall)
