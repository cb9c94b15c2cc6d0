"""The engine; jax, which takes seconds, is imported when something runs."""

from collections.abc import Sequence
from typing import Any, ClassVar, final

from harness.engines.base import Preset, Route, Task
from harness.engines.mjx import presets as table
from harness.engines.mujoco import presets as mujoco
from harness.engines.mujoco.at_once import AtOnce, Ready, Runs


@final
class MjxEngine(AtOnce):
    """MJX on one slide joint (joint and law routes) or a box that slides and lifts (contact route)."""

    name: ClassVar[str] = "mjx"
    package: ClassVar[str] = "mujoco-mjx"

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        return table.presets(route, preset, dt)

    def check(self, settings: dict[str, Any]) -> None:
        table.check(settings)

    def of_mujoco(self, settings: dict[str, Any]) -> dict[str, Any]:
        return settings | table.LACKING

    def single(self, settings: dict[str, Any]) -> bool:
        return bool(settings["precision"] == 32)

    def unused(self, task: Task, settings: dict[str, Any]) -> tuple[str, ...]:
        shipped = self.presets(task.route, "as-shipped", task.dt)
        return mujoco.unused(self.of_mujoco(settings), self.of_mujoco(shipped), task.route)

    def alike(self, ready: Ready) -> tuple[Any, ...]:
        held, settings = ready
        return held.task.route, held.rubs, *(settings[name] for name in table.COMPILED_IN)

    def ready(self, group: Sequence[Ready]) -> Runs:
        from harness.engines.mjx.scan import Scans

        return Scans(group, self.alike(group[0]), self.sticks_below(group[0][1]))
