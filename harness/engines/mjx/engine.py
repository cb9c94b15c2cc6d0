"""The engine: tasks alone or many at once, by what is compiled in."""

from typing import Any, ClassVar, final

from harness.core.trajectory import Trajectory
from harness.engines.base import Engine, Preset, Route, Task, resolve
from harness.engines.mjx import presets as table
from harness.engines.mujoco.held import Held, Recorded, held
from harness.engines.samples import trajectory


@final
class MjxEngine(Engine):
    """MJX on one slide joint (joint and law routes) or a box that slides and lifts (contact route)."""

    name: ClassVar[str] = "mjx"
    package: ClassVar[str] = "mujoco-mjx"
    calls: ClassVar[bool] = False

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        return table.presets(route, preset, dt)

    def simulate(self, task: Task) -> Trajectory:
        from harness.engines.mjx import scan

        held, settings = self._held(task)
        (found,), wall = scan.run([(held, settings)])
        return self._told(held, settings, found, wall)

    def _held(self, task: Task) -> tuple[Held, dict[str, Any]]:
        settings = resolve(self, task)
        table.check(settings)
        return held(task, settings | table.LACKING), settings

    def _told(self, held: Held, settings: dict[str, Any], found: Recorded, wall: float) -> Trajectory:
        from harness.engines.mjx.scan import sticks_below

        task = held.task
        ignored = table.unused(settings, self.presets(task.route, "as-shipped", task.dt), task.route)
        motion = held.motion(found, float(settings["dt"]), sticks_below(settings))
        return trajectory(self, task, settings, ignored, motion, wall)
