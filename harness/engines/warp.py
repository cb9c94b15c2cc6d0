"""MuJoCo Warp; warp takes seconds to import and waits until something runs."""

from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any, ClassVar, Final, final

from harness.engines.base import Preset, Route, Task, choice
from harness.engines.mujoco import presets as mujoco
from harness.engines.mujoco.at_once import AtOnce, Ready, Runs

if find_spec("warp") is None or find_spec("mujoco_warp") is None:
    raise ImportError("No module named 'mujoco_warp'")

CHOICES: Final = {
    "integrator": ("Euler", "RK4", "implicit", "implicitfast"),
    "solver": ("CG", "Newton"),
    "cone": mujoco.CONES,
    "device": ("cpu", "gpu"),
}


@final
class WarpEngine(AtOnce):
    """MuJoCo Warp on one slide joint (joint and law routes) or a box that slides and lifts (contact route)."""

    name: ClassVar[str] = "warp"
    package: ClassVar[str] = "mujoco-warp"

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        """See Engine.presets: those of MuJoCo, and device, where it runs."""
        return mujoco.presets(route, preset, dt) | {"device": "cpu"}

    def check(self, settings: dict[str, Any]) -> None:
        for name, accepted in CHOICES.items():
            choice(f"warp setting {name}", settings[name], accepted)

    def of_mujoco(self, settings: dict[str, Any]) -> dict[str, Any]:
        return settings

    def single(self, settings: dict[str, Any]) -> bool:
        return True

    def unused(self, task: Task, settings: dict[str, Any]) -> tuple[str, ...]:
        return mujoco.unused(settings, self.presets(task.route, "as-shipped", task.dt), task.route)

    def alike(self, ready: Ready) -> tuple[Any, ...]:
        held, settings = ready
        return held.task.route, held.rubs, *settings.values()

    def ready(self, group: Sequence[Ready]) -> Runs:
        from harness.engines.warp_worlds import Worlds

        return Worlds(group, self.sticks_below(group[0][1]))
