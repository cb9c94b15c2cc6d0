"""Settings of MJX: those of MuJoCo that it has, precision and device."""

from typing import Any, Final

from harness.core.errors import InputError
from harness.engines.base import Preset, Route, choice
from harness.engines.mujoco import presets as mujoco

INTEGRATORS: Final = ("Euler", "RK4", "implicitfast")
SOLVERS: Final = ("CG", "Newton")
PRECISIONS: Final = (32, 64)
DEVICES: Final = ("cpu", "gpu")
COMPILED_IN: Final = ("integrator", "solver", "iterations", "ls_iterations", "cone", "precision", "device")
"""Settings that a program is compiled for, beside the route and whether the joint rubs."""
LACKING: Final = {"noslip_iterations": 0, "noslip_tolerance": 1e-6}
"""Settings of MuJoCo that MJX takes and drops without a word: here they are none."""


def presets(route: Route, preset: Preset, dt: float | None) -> dict[str, Any]:
    """Every setting of a preset; see harness.engines.base.Engine.presets.

    precision : of its numbers in bits; 32 is what jax ships with. device : where it runs.
    """
    of_mujoco = mujoco.presets(route, preset, dt)
    own = {"precision": 32 if preset == "as-shipped" else 64, "device": "cpu"}
    return {name: value for name, value in of_mujoco.items() if name not in LACKING} | own


def check(settings: dict[str, Any]) -> None:
    """Raise InputError for a name or a precision that does not exist."""
    for name, accepted in (
        ("integrator", INTEGRATORS), ("solver", SOLVERS), ("cone", mujoco.CONES), ("device", DEVICES)
    ):  # fmt: skip
        choice(f"mjx setting {name}", settings[name], accepted)
    if settings["precision"] not in PRECISIONS:
        raise InputError("mjx setting precision", str(settings["precision"]), "32 or 64")
