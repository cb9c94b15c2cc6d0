"""The simulator's words that the friction of a model's joint depends on."""

from collections.abc import Mapping
from typing import Any

import mujoco

from harness.engines.mujoco.presets import INTEGRATORS, SOLVERS, STIFF
from harness.robot.arm import Arm


def words(arm: Arm, joint: str) -> dict[str, Any]:
    """Settings of MuJoCo as the model's file has them, in the names of harness.engines.mujoco."""
    option, at = arm.model.opt, arm.index(joint)
    return {
        "integrator": _named(mujoco.mjtIntegrator(int(option.integrator)).name, INTEGRATORS),
        "solver": _named(mujoco.mjtSolver(int(option.solver)).name, SOLVERS),
        "iterations": int(option.iterations),
        "tolerance": float(option.tolerance),
        "ls_iterations": int(option.ls_iterations),
        "noslip_iterations": int(option.noslip_iterations),
        "noslip_tolerance": float(option.noslip_tolerance),
        "solreffriction": tuple(map(float, arm.model.dof_solref[at])),
        "solimpfriction": tuple(map(float, arm.model.dof_solimp[at])),
    }


def looseness(arm: Arm, joint: str, moved: float) -> float:
    """By how much the file's friction is softer in the whole arm than in a model of the joint alone with this inertia.

    MuJoCo takes a joint's inertia for that with every other joint free, at the reference.
    """
    return float(arm.model.dof_invweight0[arm.index(joint)]) * moved


def loosened(settings: Mapping[str, Any], by: float) -> dict[str, Any]:
    """MuJoCo's settings with which a joint alone is as soft as these make it in the whole arm; by : its looseness.

    The regularisation is (1 - d)/d of the inverse inertia that MuJoCo takes for the joint's, d the impedance at rest.
    """
    found = dict(settings)
    if "solimpfriction" in found:
        d, *others = found["solimpfriction"]
        found["solimpfriction"] = (min(d / (d + by * (1.0 - d)), STIFF), *others)
    return found


def _named(name: str, known: tuple[str, ...]) -> str:
    """The word of the settings for a member of an enumeration of MuJoCo's, such as mjINT_EULER."""
    return next(one for one in known if one.upper() == name.rpartition("_")[2])
