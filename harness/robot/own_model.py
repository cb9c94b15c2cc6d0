"""A user's own model of one joint, MJCF or URDF: as a slider, and as its own engine simulates it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import mujoco

from harness.core.errors import InputError
from harness.engines.base import Settings
from harness.engines.mujoco.presets import INTEGRATORS, SOLVERS, STIFF
from harness.engines.registry import load
from harness.engines.simulator import EngineSimulator
from harness.model.model import Model, Restoring
from harness.robot.arm import Arm, load_arm
from harness.robot.reduction import reduced

_SUFFIXES = (".xml", ".mjcf", ".urdf")
_ONE = "a model of one joint (of a robot's: --robot FILE --joint NAME)"


def words(arm: Arm, joint: str) -> dict[str, Any]:
    """Settings of MuJoCo as the model's file has them, in the names of harness.engines.mujoco."""
    option, at = arm.model.opt, arm.index(joint)

    def named(member: Any, known: tuple[str, ...]) -> str:
        """The word of the settings for a member of an enumeration of MuJoCo's, such as mjINT_EULER."""
        return next(one for one in known if one.upper() == member.name.rpartition("_")[2])

    return {
        "integrator": named(mujoco.mjtIntegrator(int(option.integrator)), INTEGRATORS),
        "solver": named(mujoco.mjtSolver(int(option.solver)), SOLVERS),
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


@dataclass(frozen=True, slots=True)
class OwnModel:
    """slider : what the joint is, let go nowhere; its friction, damping and spring are the file's. engine : MuJoCo for
    an MJCF, PyBullet for a URDF. settings : of the engine, as the file has them. dt : its step, s.
    """

    file: str
    slider: Model
    engine: str
    dt: float
    settings: Settings = field(default_factory=dict)

    @property
    def simulator(self) -> EngineSimulator:
        """The engine as the file has it. Raises SimulationError where it is not installed."""
        return EngineSimulator(load(self.engine), "as-shipped", self.settings)


def is_own(path: Path) -> bool:
    """Whether a file is an MJCF or a URDF, by its name."""
    return path.suffix.lower() in _SUFFIXES


def own_model(path: Path) -> OwnModel:
    """Read a file, as ``load_arm`` does; raises InputError for several joints, and for a spring beside gravity."""
    arm = load_arm(path)
    if len(arm.joints) > 1:
        raise InputError(str(path), f"{len(arm.joints)} joints: {', '.join(arm.joints)}", _ONE)
    (joint,) = arm.joints
    own = reduced(arm, joint)
    hangs = own.gravity > 0.0 and not own.slides and not own.upright
    if hangs and own.spring > 0.0:
        raise InputError(f"{path}: joint {joint}", "a spring beside gravity", "a joint with one of the two")
    held = Restoring.PENDULUM if hangs else Restoring.SPRING if own.spring > 0.0 else Restoring.NONE
    k = own.gravity if hangs else own.spring
    slider = Model(own.moved, float(arm.damping[0]), k, float(arm.frictionloss[0]), restoring=held)
    if path.suffix.lower() == ".urdf":
        engine = load("pybullet")
        return OwnModel(str(path), slider, engine.name, float(engine.presets("joint", "as-shipped")["dt"]))
    settings = loosened(words(arm, joint), looseness(arm, joint, own.moved))
    return OwnModel(str(path), slider, "mujoco", float(arm.model.opt.timestep), settings)
