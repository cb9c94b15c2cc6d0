"""What MuJoCo compiled, looked at: which joints there are, which do not move alone, and what is taken out."""

from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError

_FLAGS = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT.value | mujoco.mjtDisableBit.mjDSBL_DAMPER.value
_NO_GRAVITY = mujoco.mjtDisableBit.mjDSBL_GRAVITY.value
HINGE_OR_SLIDE = (mujoco.mjtJoint.mjJNT_HINGE.value, mujoco.mjtJoint.mjJNT_SLIDE.value)
_KINDS = {mujoco.mjtJoint.mjJNT_FREE.value: "free", mujoco.mjtJoint.mjJNT_BALL.value: "ball"}
ACCEPTED = "hinges and slides of an open chain on a fixed base are accepted"


def joint_names(file: str, model: Any) -> tuple[str, ...]:
    """Names of hinges and slides in the order of the degrees of freedom.

    Raises InputError for a ball or a free joint, by name, for none, and for one without a name.
    """
    names = []
    for i in range(model.njnt):
        name = model.joint(i).name
        kind = int(model.jnt_type[i])
        if kind not in HINGE_OR_SLIDE:
            where = name or f"of body {model.body(model.jnt_bodyid[i]).name or model.jnt_bodyid[i]}"
            raise InputError(f"{file}: joint {where}", f"a {_KINDS[kind]} joint", ACCEPTED)
        names.append(name or f"joint {i + 1}")
    if not names:
        raise InputError(file, "no joint", ACCEPTED)
    return tuple(names)


def coupled(file: str, model: Any) -> dict[str, str]:
    """By joint, why it does not move alone: an equality of joints, or a tendon with a force of its own.

    Such a constraint leaves the other joints' equations as they are. Raises InputError for one that does not: closed
    chains (connect, weld), and tendons through space that pull.
    """
    found: dict[str, str] = {}
    for i in range(model.neq):
        if not model.eq_active0[i]:
            continue
        kind = mujoco.mjtEq(int(model.eq_type[i])).name.removeprefix("mjEQ_").lower()
        name = model.equality(i).name
        said = f"the {kind} equality{' ' + name if name else ''}"
        if kind not in ("joint", "tendon"):
            raise InputError(f"{file}: {said}", "a closed chain", ACCEPTED)
        both = [int(one) for one in (model.eq_obj1id[i], model.eq_obj2id[i]) if one >= 0]
        joints = both if kind == "joint" else [j for one in both for j in _joints_of(file, model, one, said)]
        found |= dict.fromkeys((model.joint(j).name for j in joints), f"{said} couples it with another")
    for i in range(model.ntendon):
        if _pulls(model, i):
            said = f"the tendon {model.tendon(i).name or i + 1}"
            joints = _joints_of(file, model, i, said)
            found |= dict.fromkeys((model.joint(j).name for j in joints), f"{said} pulls it")
    return found


def _pulls(model: Any, i: int) -> bool:
    own = (model.tendon_stiffness, model.tendon_damping, model.tendon_frictionloss, model.tendon_armature)
    return any(float(one[i]) != 0.0 for one in own)


def _joints_of(file: str, model: Any, tendon: int, said: str) -> list[int]:
    """Joints of a fixed tendon; one through space is refused."""
    at, count = int(model.tendon_adr[tendon]), int(model.tendon_num[tendon])
    wraps = range(at, at + count)
    if any(int(model.wrap_type[w]) != mujoco.mjtWrap.mjWRAP_JOINT.value for w in wraps):
        raise InputError(f"{file}: {said}", "it pulls through space", "tendons of joints are accepted")
    return [int(model.wrap_objid[w]) for w in wraps]


def strip(model: Any, gravity: tuple[float, float, float] | None) -> tuple[str, ...]:
    """Leave of a model its rigid bodies, armatures, gravity and the joints' springs; what was taken out, in words."""
    notes = []
    out: tuple[tuple[str, Any, Callable[[], None]], ...] = (
        ("gravity compensation", model.body_gravcomp, lambda: model.body_gravcomp.fill(0.0)),
        ("the drag of a medium", (model.opt.density, model.opt.viscosity), lambda: _still(model)),
    )
    for said, values, take in out:
        if any(float(one) != 0.0 for one in values):
            notes.append(f"{said} is taken out: a log's torque carries all of it")
        take()
    model.dof_frictionloss[:] = 0.0
    model.dof_damping[:] = 0.0
    model.dof_dampingpoly[:] = 0.0
    model.opt.disableflags |= _FLAGS
    if gravity is not None:
        model.opt.gravity[:] = gravity
        model.opt.disableflags &= ~_NO_GRAVITY
    return tuple(notes)


def rotors(model: Any) -> FloatArray:
    """Rotor inertia (nv,) on the diagonal of the mass matrix, kg m^2 or kg: of the joints and of their actuators."""
    found = np.array(model.dof_armature)
    for i in range(model.nactuator):  # a pid has two controls
        if model.actuator_trntype[i] == mujoco.mjtTrn.mjTRN_JOINT.value:
            # a rotor turns faster by the gear's ratio, and its inertia counts with the square
            found[model.actuator_trnid[i, 0]] += model.actuator_armature[i] * model.actuator_gear[i, 0] ** 2
    return found


def _still(model: Any) -> None:
    model.opt.density = model.opt.viscosity = 0.0
