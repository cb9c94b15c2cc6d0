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
from harness.robot.apart import HINGE_OR_SLIDE, compiled

_RIGID = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT.value | mujoco.mjtDisableBit.mjDSBL_DAMPER.value
_NO_GRAVITY = mujoco.mjtDisableBit.mjDSBL_GRAVITY.value
_KINDS = {mujoco.mjtJoint.mjJNT_FREE.value: "free", mujoco.mjtJoint.mjJNT_BALL.value: "ball"}
_ACCEPTED = "hinges and slides of an open chain on a fixed base are accepted"


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
    joints = []
    for i in range(model.njnt):
        name, kind = model.joint(i).name, int(model.jnt_type[i])
        if kind not in HINGE_OR_SLIDE:
            where = name or f"of body {model.body(model.jnt_bodyid[i]).name or model.jnt_bodyid[i]}"
            raise InputError(f"{file}: joint {where}", f"a {_KINDS[kind]} joint", _ACCEPTED)
        joints.append(name or f"joint {i + 1}")
    if not joints:
        raise InputError(file, "no joint", _ACCEPTED)
    if any(np.any(one) for one in (model.jnt_stiffnesspoly, model.dof_dampingpoly)):
        raise InputError(file, "stiffness or damping of a joint as a polynomial", f"one number each, and {_ACCEPTED}")
    friction, damping, rotors = np.array(model.dof_frictionloss), np.array(model.dof_damping), model.dof_armature.copy()
    for i in range(model.nactuator):  # a pid has two controls
        if model.actuator_trntype[i] == mujoco.mjtTrn.mjTRN_JOINT.value:
            # a rotor turns faster by the gear's ratio, and its inertia counts with the square
            rotors[model.actuator_trnid[i, 0]] += model.actuator_armature[i] * model.actuator_gear[i, 0] ** 2
    together = _coupled(file, model) | about["alone"]
    notes = (*about["notes"], *_strip(model, gravity))
    return Arm(file, model, tuple(joints), rotors, friction, damping, MappingProxyType(together), notes)


def _coupled(file: str, model: Any) -> dict[str, str]:
    """By joint, why it does not move alone: an equality of joints, or a tendon with a force of its own.

    Such a constraint leaves the other joints' equations as they are. Raises InputError for one that does not: closed
    chains (connect, weld), and tendons through space that pull.
    """
    found: dict[str, str] = {}

    def joints_of(tendon: int, said: str) -> list[int]:
        wraps = range(first := int(model.tendon_adr[tendon]), first + int(model.tendon_num[tendon]))
        if any(int(model.wrap_type[w]) != mujoco.mjtWrap.mjWRAP_JOINT.value for w in wraps):
            raise InputError(f"{file}: {said}", "it pulls through space", "tendons of joints are accepted")
        return [int(model.wrap_objid[w]) for w in wraps]

    for i in range(model.neq):
        if not model.eq_active0[i]:
            continue
        kind = mujoco.mjtEq(int(model.eq_type[i])).name.removeprefix("mjEQ_").lower()
        name = model.equality(i).name
        said = f"the {kind} equality{' ' + name if name else ''}"
        if kind not in ("joint", "tendon"):
            raise InputError(f"{file}: {said}", "a closed chain", _ACCEPTED)
        both = [int(one) for one in (model.eq_obj1id[i], model.eq_obj2id[i]) if one >= 0]
        joints = both if kind == "joint" else [j for one in both for j in joints_of(one, said)]
        found |= dict.fromkeys((model.joint(j).name for j in joints), f"{said} couples it with another")
    forces = (model.tendon_stiffness, model.tendon_damping, model.tendon_frictionloss, model.tendon_armature)
    for i in range(model.ntendon):
        if any(float(one[i]) != 0.0 for one in forces):
            said = f"the tendon {model.tendon(i).name or i + 1}"
            found |= dict.fromkeys((model.joint(j).name for j in joints_of(i, said)), f"{said} pulls it")
    return found


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
