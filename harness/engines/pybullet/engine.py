"""PyBullet: spring and driving forces as a torque each step, dry friction as a velocity motor limited to f_k."""

import time
from typing import Any, ClassVar, final

from harness.core.quiet import quiet
from harness.core.trajectory import Trajectory
from harness.core.versions import version
from harness.engines.base import Engine, Preset, Route, Task, resolve
from harness.engines.pybullet import loop
from harness.engines.pybullet import presets as table
from harness.engines.pybullet.client import log
from harness.engines.pybullet.world import opened
from harness.engines.samples import trajectory


@final
class PybulletEngine(Engine):
    """PyBullet on one prismatic joint (joint and law routes) or a box that slides and lifts (contact route)."""

    name: ClassVar[str] = "pybullet"

    def version(self) -> str:
        """Version of the pybullet package."""
        return version("pybullet")

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        """Settings of a preset; see Engine.presets."""
        return table.presets(route, preset, dt)

    def simulate(self, task: Task) -> Trajectory:
        """Run a task; see Engine.simulate."""
        settings = resolve(self, task)
        ignored = table.unused(settings, self.presets(task.route, "as-shipped", task.dt), task.route)
        planned = loop.plan(task, settings)
        model, substeps = loop.model(planned), max(1, settings["numSubSteps"])
        with quiet(log), opened(model, task.route, settings, task.scenario.x0, planned.first_speed) as world:
            started = time.perf_counter()
            motion = loop.motion(planned, world, substeps)
            wall = time.perf_counter() - started
        return trajectory(self, task, settings, ignored, motion, wall)
