"""A robot's rigid model, from MJCF or URDF, by MuJoCo's compiler: what torque its joints need without friction."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.robot.apart import compiled
from harness.robot.compiled import ACCEPTED, coupled, joint_names, rotors, strip

GRAVITY = (0.0, 0.0, -9.81)


@dataclass(frozen=True, slots=True)
class Arm:
    """An open or closed chain as MuJoCo compiled it, its joint friction and damping taken out.

    file : of the model. model : mujoco's. joints : names of hinges and slides in the order of the model's degrees of
    freedom (nv,). armature (nv,) : rotor inertia seen at the joint, kg m^2 or kg. frictionloss, damping (nv,) : as the
    file has them, N m or N and N m s/rad or N s/m. coupled : by joint, why it does not move alone (an equality, a
    tendon); the others' torque is right all the same. notes : what else was taken out, one sentence each.
    """

    file: str
    model: Any
    joints: tuple[str, ...]
    armature: FloatArray
    frictionloss: FloatArray
    damping: FloatArray
    coupled: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def inverse(self, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """Torque (n, nv) that the rigid model needs: inertia with armature, Coriolis, gravity, springs of joints.

        q, v, a : (n, nv), rad or m, and per s and s^2; nothing of friction or damping is in it.
        """
        model, data = self.model, mujoco.MjData(self.model)
        found = np.empty_like(q)
        for i in range(q.shape[0]):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[i], v[i], a[i]
            mujoco.mj_inverse(model, data)
            found[i] = data.qfrc_inverse
        return found

    def index(self, joint: str, where: str = "--joint") -> int:
        """Number of a joint among the degrees of freedom. Raises InputError that lists those there are."""
        if joint not in self.joints:
            near = did_you_mean(joint, self.joints)
            raise InputError(where, f"{joint!r}", f"a joint of {self.file} is accepted: {', '.join(self.joints)}{near}")
        return self.joints.index(joint)

    def slides(self, joint: str) -> bool:
        """Whether a joint is a slide, in m and N; else it is a hinge, in rad and N m."""
        return bool(self.model.jnt_type[self.index(joint)] == mujoco.mjtJoint.mjJNT_SLIDE.value)


def load_arm(
    path: Path,
    gravity: tuple[float, float, float] | None = None,
    edited: Mapping[Path, str] = MappingProxyType({}),
    fixed: bool = False,
) -> Arm:
    """An arm from .xml (MJCF or URDF) or .urdf; gravity : m/s^2 in the frame of the base, None for the file's own.

    edited : by resolved path, texts that take the place of what a file of the model holds. fixed : bodies on free and
    ball joints are held, and it is noted.

    Raises InputError when there is no such file, MuJoCo cannot compile it (its message in one line), or a joint is
    neither hinge nor slide (named).
    """
    file = str(path)
    model, about = compiled(path, edited, fixed=fixed)
    joints = joint_names(file, model)
    if any(np.any(one) for one in (model.jnt_stiffnesspoly, model.dof_dampingpoly)):
        raise InputError(file, "stiffness or damping of a joint as a polynomial", f"one number each, and {ACCEPTED}")
    friction, damping = np.array(model.dof_frictionloss), np.array(model.dof_damping)
    together = coupled(file, model) | about["alone"]
    notes = (*about["notes"], *strip(model, gravity))
    return Arm(file, model, joints, rotors(model), friction, damping, MappingProxyType(together), notes)
