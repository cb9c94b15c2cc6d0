"""A robot's rigid model, from MJCF or URDF, by MuJoCo's compiler: what torque its joints need without friction.

Joints of a compiled model may not move alone: two on a ratio, and those in loops or on tendons that pull. What couples
joints leaves the other joints' equations as they are: its forces are inner ones of what hangs on them.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.model.term import Zone
from harness.robot.apart import compiled

_BODY, _SITE = mujoco.mjtObj.mjOBJ_BODY.value, mujoco.mjtObj.mjOBJ_SITE.value
_JOINT = mujoco.mjtWrap.mjWRAP_JOINT.value
_ON_BODY = (mujoco.mjtWrap.mjWRAP_SITE.value, mujoco.mjtWrap.mjWRAP_SPHERE.value, mujoco.mjtWrap.mjWRAP_CYLINDER.value)
_SLOPE, _DEGREES = 1, slice(2, 5)
"""Of an equality's polynomial."""


@dataclass(frozen=True, slots=True)
class Tie:
    """q of the joint ``follows`` is start + ratio q of the joint ``leads``; numbers of joints, rad or m."""

    follows: int
    leads: int
    ratio: float
    start: float


@dataclass(frozen=True, slots=True)
class Coupled:
    """ties : pairs on a ratio. alone : by joint, why it neither moves alone nor on a ratio. notes : what was left out,
    one sentence each.
    """

    ties: tuple[Tie, ...]
    alone: Mapping[int, str]
    notes: tuple[str, ...]


def coupled(model: Any) -> Coupled:
    """What couples the joints of a model that has hinges and slides alone."""
    ties, alone, notes = list[Tie](), dict[int, str](), list[str]()
    for i in range(model.neq):
        if not model.eq_active0[i]:
            continue
        kind = mujoco.mjtEq(int(model.eq_type[i])).name.removeprefix("mjEQ_").lower()
        said = f"the {kind} equality{' ' * bool(model.equality(i).name)}{model.equality(i).name}"
        both = [int(one) for one in (model.eq_obj1id[i], model.eq_obj2id[i]) if one >= 0]
        if kind in ("joint", "tendon"):
            joints = both if kind == "joint" else [j for one in both for j in _pulled(model, one)]
            tie = _on_joints(model, i, both) if kind == "joint" else _on_tendons(model, i, both)
            if tie is not None:
                ties.append(tie)
            else:
                alone |= dict.fromkeys(joints, f"{said} couples it with another")
            continue
        site = int(model.eq_objtype[i]) == _SITE
        bodies = [int(model.site_bodyid[one]) if site else one for one in both]
        hand = next((b for b in bodies if model.body_mocapid[model.body_rootid[b]] >= 0), None)
        if hand is not None:
            notes.append(f"{said} is not used: {model.body(hand).name} is a simulation's hand on the robot")
            continue
        alone |= dict.fromkeys(_between(model, bodies), f"{said} closes a loop that it is in")
    forces = (model.tendon_stiffness, model.tendon_damping, model.tendon_frictionloss, model.tendon_armature)
    for i in range(model.ntendon):
        if any(float(one[i]) != 0.0 for one in forces):
            alone |= dict.fromkeys(_pulled(model, i), f"the tendon {model.tendon(i).name or i + 1} pulls it")
    return Coupled(tuple(ties), alone, tuple(notes))


def moved_with(ties: tuple[Tie, ...], joint: int) -> dict[int, tuple[float, float]]:
    """By joint that a joint moves by ratios, itself among them: ratio and start of its position on that one's."""
    found, ways = {joint: (1.0, 0.0)}, [joint]
    while ways:
        at = ways.pop()
        for tie in ties:
            if tie.leads == at and tie.follows not in found:
                other, ratio, start = tie.follows, tie.ratio, tie.start
            elif tie.follows == at and tie.leads not in found and tie.ratio != 0.0:
                other, ratio, start = tie.leads, 1.0 / tie.ratio, -tie.start / tie.ratio
            else:
                continue
            own = found[at]
            found[other] = (ratio * own[0], start + ratio * own[1])
            ways.append(other)
    return found


def _on_joints(model: Any, equality: int, joints: list[int]) -> Tie | None:
    """q1 - ref1 is a line of q2 - ref2, or rests."""
    data = model.eq_data[equality]
    first, other = joints[0], joints[-1]
    ref = [float(model.qpos0[model.jnt_qposadr[j]]) for j in (first, other)]
    if len(joints) < 2 or any(data[_DEGREES]):
        return None
    slope = float(data[_SLOPE])
    return Tie(first, other, slope, ref[0] + float(data[0]) - slope * ref[1])


def _on_tendons(model: Any, equality: int, tendons: list[int]) -> Tie | None:
    """The same of tendons over two joints in all; L1 - L1_ref is a line of L2 - L2_ref, or rests."""
    data, sums = model.eq_data[equality], dict[int, float]()
    slope = float(data[_SLOPE]) if len(tendons) > 1 else 0.0
    if any(data[_DEGREES]):
        return None
    for tendon, times in zip(tendons, (1.0, -slope), strict=False):
        for w in _wraps(model, tendon):
            if int(model.wrap_type[w]) != _JOINT:
                return None
            joint = int(model.wrap_objid[w])
            sums[joint] = sums.get(joint, 0.0) + times * float(model.wrap_prm[w])
    if len(sums) != 2 or not all(sums.values()):
        return None
    (first, one), (other, two) = sums.items()
    ref = [float(model.qpos0[model.jnt_qposadr[j]]) for j in (first, other)]
    ratio = -two / one
    return Tie(first, other, ratio, ref[0] + float(data[0]) / one - ratio * ref[1])


def _wraps(model: Any, tendon: int) -> range:
    first = int(model.tendon_adr[tendon])
    return range(first, first + int(model.tendon_num[tendon]))


def _pulled(model: Any, tendon: int) -> set[int]:
    """Joints that change a tendon's length."""
    wraps = [(int(model.wrap_type[w]), int(model.wrap_objid[w])) for w in _wraps(model, tendon)]
    places = [
        int(model.site_bodyid[one] if kind == _ON_BODY[0] else model.geom_bodyid[one])
        for kind, one in wraps
        if kind in _ON_BODY
    ]
    return {one for kind, one in wraps if kind == _JOINT} | _between(model, places)


def _between(model: Any, bodies: list[int]) -> set[int]:
    """Joints by which bodies move against each other; a single one against the world."""
    ways = [set(_rooted(model, body)) for body in (bodies if len(bodies) != 1 else [*bodies, 0])]
    some = {body for way in ways for body in way if not all(body in other for other in ways)}
    return {j for j in range(model.njnt) if int(model.jnt_bodyid[j]) in some}


def _rooted(model: Any, body: int) -> Iterator[int]:
    """A body and those it hangs on, the world last."""
    while True:
        yield body
        if body == 0:
            return
        body = int(model.body_parentid[body])


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
    what was taken out, held or repaired, one sentence each. drag (nv, 2) : the file's further coefficients of damping,
    of v |v| and of v^3. zones : springs with a dead zone, which act on one joint each through a tendon, by the joint's
    number, in its own position; taken out where the caller reads them.
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
    drag: FloatArray = field(default_factory=lambda: np.zeros((0, 2)))
    zones: tuple[tuple[int, Zone], ...] = ()

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
    path: Path,
    gravity: tuple[float, float, float] | None = None,
    edited: Mapping[Path, str] = MappingProxyType({}),
    polynomials: bool = False,
) -> Arm:
    """An arm from .xml (MJCF or URDF) or .urdf; gravity : m/s^2 in the frame of the base, None for the file's own.

    edited : by resolved path, texts that take the place of what a file of the model holds. polynomials : stiffness and
    damping may be such, and the caller reads them. Bodies on free and ball joints are held, and it is noted.

    Raises InputError when there is no such file, MuJoCo cannot compile it (its message in one line), or there is
    neither hinge nor slide.
    """
    file = str(path)
    model, notes = compiled(path, edited)
    if not model.njnt:
        raise InputError(file, "no joint", _ACCEPTED)
    joints = [model.joint(i).name or f"joint {i + 1}" for i in range(model.njnt)]
    if not polynomials and any(np.any(one) for one in (model.jnt_stiffnesspoly, model.dof_dampingpoly)):
        raise InputError(file, "stiffness or damping of a joint as a polynomial", f"one number each, and {_ACCEPTED}")
    friction, damping, rotors = np.array(model.dof_frictionloss), np.array(model.dof_damping), model.dof_armature.copy()
    drag = np.array(model.dof_dampingpoly)
    for i in range(model.nactuator):  # a pid has two controls
        if model.actuator_trntype[i] == mujoco.mjtTrn.mjTRN_JOINT.value:
            # a rotor turns faster by the gear's ratio, and its inertia counts with the square
            rotors[model.actuator_trnid[i, 0]] += model.actuator_armature[i] * model.actuator_gear[i, 0] ** 2
    zones = _zones(model) if polynomials else ()
    found = coupled(model)
    alone = MappingProxyType({joints[j]: said for j, said in found.alone.items()})
    said = (*notes, *found.notes, *_strip(model, gravity))
    return Arm(file, model, tuple(joints), rotors, friction, damping, alone, found.ties, said, drag, zones)


def _zones(model: Any) -> tuple[tuple[int, Zone], ...]:
    """Springs with a dead zone of tendons over one joint each, by that joint; they are taken out of the model."""
    others = (model.tendon_damping, model.tendon_frictionloss, model.tendon_armature, model.tendon_limited)
    bent = (model.tendon_stiffnesspoly, model.tendon_dampingpoly)
    found = []
    for i in range(model.ntendon):
        wraps = _wraps(model, i)
        low, high = map(float, model.tendon_lengthspring[i])
        alone = len(wraps) == 1 and int(model.wrap_type[wraps[0]]) == _JOINT
        plain = not any(one[i] for one in others) and not any(np.any(one[i]) for one in bent)
        if not (alone and plain and low < high and model.tendon_stiffness[i] > 0.0):
            continue
        per = float(model.wrap_prm[wraps[0]])  # length over position
        if per == 0.0:
            continue
        ends = sorted((low / per, high / per))
        found.append((int(model.wrap_objid[wraps[0]]), Zone(float(model.tendon_stiffness[i]) * per**2, *ends)))
        model.tendon_stiffness[i] = 0.0
    return tuple(found)


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
