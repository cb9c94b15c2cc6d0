"""MJX: MuJoCo's models compiled by jax, which takes seconds to import and waits until something runs."""

from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any, ClassVar, Final, final

from harness.core.errors import InputError
from harness.engines.base import Preset, Route, Task, choice
from harness.engines.mujoco import presets as mujoco
from harness.engines.mujoco.at_once import AtOnce, Ready, Runs

if find_spec("jax") is None or find_spec("mujoco.mjx") is None:
    raise ImportError("No module named 'mujoco.mjx'")

CHOICES: Final = {
    "integrator": ("Euler", "RK4", "implicitfast"),
    "solver": ("CG", "Newton"),
    "cone": mujoco.CONES,
    "device": ("cpu", "gpu"),
}
PRECISIONS: Final = (32, 64)
COMPILED_IN: Final = ("integrator", "solver", "iterations", "ls_iterations", "cone", "precision", "device")
"""Settings that a program is compiled for, beside the route and whether the joint rubs."""
LACKING: Final = {"noslip_iterations": 0, "noslip_tolerance": 1e-6}
"""Settings of MuJoCo that MJX takes and drops without a word: here they are none."""


@final
class MjxEngine(AtOnce):
    """MJX on one slide joint (joint and law routes) or a box that slides and lifts (contact route)."""

    name: ClassVar[str] = "mjx"
    package: ClassVar[str] = "mujoco-mjx"

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        """See Engine.presets: those of MuJoCo that it has, precision and device.

        precision : of its numbers in bits; 32 is what jax ships with. device : where it runs.
        """
        of_mujoco = mujoco.presets(route, preset, dt)
        own = {"precision": 32 if preset == "as-shipped" else 64, "device": "cpu"}
        return {name: value for name, value in of_mujoco.items() if name not in LACKING} | own

    def check(self, settings: dict[str, Any]) -> None:
        for name, accepted in CHOICES.items():
            choice(f"mjx setting {name}", settings[name], accepted)
        if settings["precision"] not in PRECISIONS:
            raise InputError("mjx setting precision", str(settings["precision"]), "32 or 64")

    def of_mujoco(self, settings: dict[str, Any]) -> dict[str, Any]:
        return settings | LACKING

    def single(self, settings: dict[str, Any]) -> bool:
        return bool(settings["precision"] == 32)

    def unused(self, task: Task, settings: dict[str, Any]) -> tuple[str, ...]:
        shipped = self.presets(task.route, "as-shipped", task.dt)
        return mujoco.unused(self.of_mujoco(settings), self.of_mujoco(shipped), task.route)

    def alike(self, ready: Ready) -> tuple[Any, ...]:
        held, settings = ready
        return held.task.route, held.rubs, *(settings[name] for name in COMPILED_IN)

    def ready(self, group: Sequence[Ready]) -> Runs:
        from harness.engines.mjx_scan import Scans

        return Scans(group, self.alike(group[0]), self.sticks_below(group[0][1]))
