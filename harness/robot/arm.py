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
from harness.robot.ties import Tie, coupled, moved_with

_RIGID = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT.value | mujoco.mjtDisableBit.mjDSBL_DAMPER.value
_NO_GRAVITY = mujoco.mjtDisableBit.mjDSBL_GRAVITY.value
_ACCEPTED = "a model with hinges or slides"


@dataclass(frozen=True, slots=True)
class Arm:
    """Open chains and loops as MuJoCo compiled them, joints' friction and damping taken out, free bodies held.

    file : of the model. model : mujoco's. joints : names of hinges and slides in the order of the model's degrees of
    freedom (nv,). armature (nv,) : rotor inertia seen at the joint, kg m^2 or kg. frictionloss, damping (nv,) : as the
    file has them, N m or N and N m s/rad or N s/m. coupled : by joint, why it does not move alone (a loop, a tendon, a
    curve); the others' torque is right all the same. ties : joints that move together by a ratio. notes :
    what was taken out, held or repaired, one sentence each.
    """

    file: str
    model: Any
    joints: tuple[str, ...]
    armature: FloatArray
    frictionloss: FloatArray
    damping: FloatArray
    coupled: Mapping[str, str] = field(default_factory=dict)
    ties: tuple[Tie, ...] = ()
    notes: tuple[str, ...] = ()

    def inverse(self, q: FloatArray, v: FloatArray, a: FloatArray) -> FloatArray:
        """Torque (n, nv) that the rigid model needs: inertia with armature, Coriolis, gravity, springs of joints.

        q, v, a : (n, nv), rad or m, and per s and s^2; nothing of friction or damping is in it. A joint that another
        moves by a ratio goes where that one takes it, and has its torque from there.
        """
        model, data = self.model, mujoco.MjData(self.model)
        groups = [moved_with(self.ties, j) for j in range(len(self.joints))] if self.ties else []
        followers = {tie.follows for tie in self.ties}
        if groups:
            q, v, a = q.copy(), v.copy(), a.copy()
        for lead in (j for j, group in enumerate(groups) if len(group) > 1 and j not in followers):
            for j, (ratio, start) in groups[lead].items():
                q[:, j], v[:, j], a[:, j] = start + ratio * q[:, lead], ratio * v[:, lead], ratio * a[:, lead]
        found = np.empty_like(q)
        # each look at an array of MuJoCo's makes it anew
        here, speed, rate, torque = data.qpos, data.qvel, data.qacc, data.qfrc_inverse
        for i in range(q.shape[0]):
            here[:], speed[:], rate[:] = q[i], v[i], a[i]
            mujoco.mj_inverse(model, data)
            found[i] = torque
        if groups:
            found = np.stack([sum(r * found[:, j] for j, (r, _) in group.items()) for group in groups], axis=1)
        return found

    def index(self, joint: str, where: str = "--joint") -> int:
        """Number of a joint among the degrees of freedom. Raises InputError that lists those there are."""
        if joint not in self.joints:
            near = did_you_mean(joint, self.joints)
            raise InputError(where, f"{joint!r}", f"a joint of {self.file}: {', '.join(self.joints)}{near}")
        return self.joints.index(joint)

    def slides(self, joint: str) -> bool:
        """Whether a joint is a slide, in m and N; else it is a hinge, in rad and N m."""
        return bool(self.model.jnt_type[self.index(joint)] == mujoco.mjtJoint.mjJNT_SLIDE.value)


def load_arm(
    path: Path, gravity: tuple[float, float, float] | None = None, edited: Mapping[Path, str] = MappingProxyType({})
) -> Arm:
    """An arm from .xml (MJCF or URDF) or .urdf; gravity : m/s^2 in the frame of the base, None for the file's own.

    edited : by resolved path, texts that take the place of what a file of the model holds. Bodies on free and ball
    joints are held, and it is noted.

    Raises InputError when there is no such file, MuJoCo cannot compile it (its message in one line), or there is
    neither hinge nor slide.
    """
    file = str(path)
    model, notes = compiled(path, edited)
    if not model.njnt:
        raise InputError(file, "no joint", _ACCEPTED)
    joints = [model.joint(i).name or f"joint {i + 1}" for i in range(model.njnt)]
    if any(np.any(one) for one in (model.jnt_stiffnesspoly, model.dof_dampingpoly)):
        raise InputError(file, "stiffness or damping of a joint as a polynomial", f"one number each, and {_ACCEPTED}")
    friction, damping, rotors = np.array(model.dof_frictionloss), np.array(model.dof_damping), model.dof_armature.copy()
    for i in range(model.nactuator):  # a pid has two controls
        if model.actuator_trntype[i] == mujoco.mjtTrn.mjTRN_JOINT.value:
            # a rotor turns faster by the gear's ratio, and its inertia counts with the square
            rotors[model.actuator_trnid[i, 0]] += model.actuator_armature[i] * model.actuator_gear[i, 0] ** 2
    found = coupled(model)
    alone = MappingProxyType({joints[j]: said for j, said in found.alone.items()})
    said = (*notes, *found.notes, *_strip(model, gravity))
    return Arm(file, model, tuple(joints), rotors, friction, damping, alone, found.ties, said)


def _strip(model: Any, gravity: tuple[float, float, float] | None) -> list[str]:
    """Leave of a model its rigid bodies, armatures, gravity and the joints' springs; what was taken out, in words."""
    there = {
        "gravity compensation": np.any(model.body_gravcomp),
        "the drag of a medium": model.opt.density or model.opt.viscosity,
    }
    model.body_gravcomp[:] = model.dof_frictionloss[:] = model.dof_damping[:] = model.dof_dampingpoly[:] = 0.0
    model.opt.density = model.opt.viscosity = 0.0
    model.opt.disableflags |= _RIGID
    if gravity is not None:
        model.opt.gravity[:] = gravity
        model.opt.disableflags &= ~_NO_GRAVITY
    return [f"{said} is taken out: a log's torque carries all of it" for said, held in there.items() if held]
