"""One joint of an open chain while the others stand still: a pendulum, or a mass under a constant force.

What hangs on the joint is then one rigid body about one axis, so that its inertia does not depend on its own angle
and gravity's torque is a sine of it:

    (inertia + armature) q'' + c q' + spring (q - q_ref) + friction + a sin q + b cos q = tau

A slide has a constant force in place of the sine. So it is with joints that one moves by a ratio, as long as their sum
has one inertia and one sine.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, did_you_mean
from harness.robot.arm import Arm, moved_with

_ANGLES = 72
"""Of a whole turn, at which gravity's torque is read."""
_ALONE = "a joint that moves by itself"
_ALIKE = 0.01
"""Share of inertia, and of gravity's torque, to which a joint that moves others by ratios is a pendulum."""
_NONE = 1e-12
_UPRIGHT = 1e-4
"""Sine of the tilt of an axis below which it counts as along gravity; a right angle written 1.5708 is 4e-6 off."""


@dataclass(frozen=True, slots=True)
class Reduced:
    """The equation of one joint with the others still; kg m^2, N m, rad for a hinge, kg, N, m for a slide.

    inertia : of what the joint moves. armature : of its rotor, to be added. a, b : of gravity's torque, a hinge's.
    spring, q_ref : the joint's own spring and where it is slack. constant : gravity's force on a slide. slides : no
    hinge. upright : gravity has no torque about it: the axis is along it, or what moves is balanced. held : the other
    joints' positions. ratios : by joint that moves with it, how many times as far; its inertia, rotor and weight are in
    inertia, a and b.
    """

    joint: str
    inertia: float
    armature: float
    a: float = 0.0
    b: float = 0.0
    spring: float = 0.0
    q_ref: float = 0.0
    constant: float = 0.0
    slides: bool = False
    upright: bool = False
    held: Mapping[str, float] = field(default_factory=dict)
    ratios: Mapping[str, float] = field(default_factory=dict)

    @property
    def moved(self) -> float:
        """Inertia with the rotor's, kg m^2 or kg."""
        return self.inertia + self.armature

    @property
    def gravity(self) -> float:
        """Largest torque of gravity G, N m; of a slide its force, N."""
        return abs(self.constant) if self.slides else math.hypot(self.a, self.b)

    @property
    def q_eq(self) -> float:
        """Angle in (-pi, pi], rad, where gravity leaves the joint at rest and brings it back: G sin(q - q_eq)."""
        # what sums of cosines leave of a zero is none
        return math.atan2(0.0 if abs(self.b) < _NONE * abs(self.a) else -self.b, self.a)

    def load(self, q: FloatArray) -> FloatArray:
        """Torque or force (n,) of gravity and of the spring, on the left of the equation."""
        own = np.full_like(q, self.constant) if self.slides else self.a * np.sin(q) + self.b * np.cos(q)
        return np.asarray(own + self.spring * (q - self.q_ref))

    def torque(self, q: FloatArray, a: FloatArray) -> FloatArray:
        """Torque or force (n,) without friction and damping that a motion needs: positions q, accelerations a (n,)."""
        return np.asarray(self.moved * a + self.load(q))

    @property
    def sentence(self) -> str:
        """The equation with its numbers, in words."""
        inertia, torque, angle = ("kg", "N", "m") if self.slides else ("kg m^2", "N m", "rad")
        rotor = f" with {self.armature:.4g} {inertia} of its rotor" if self.armature else ""
        locked = "with the other joints locked, " if self.held else "joint "
        said = f"{locked}{self.joint}: inertia {self.moved:.4g} {inertia}{rotor}"
        if self.slides:
            said += f", gravity {self.constant:.4g} N" if self.constant else ""
        elif self.upright:
            said += ", no gravity torque (its axis is vertical, or what it moves is balanced about it)"
        else:
            said += f", gravity torque up to {self.gravity:.4g} N m (rest angle {self.q_eq:.4g} rad)"
        if self.spring:
            said += f"; its own spring has {self.spring:.4g} {torque}/{angle}, slack at {self.q_ref:.4g} {angle}"
        for name, ratio in self.ratios.items():
            said += f"; {name} moves {ratio:.4g} times as far with it, and the numbers of {self.joint} are of both"
        return f"{said}."


def reduced(arm: Arm, joint: str, held: Mapping[str, float] | None = None) -> Reduced:
    """The equation of a joint; held : positions of other joints, those of the model's reference where not given.

    Raises InputError for a joint that there is not, for one that does not move alone or on a ratio, and for one that
    moves others so that the whole is no pendulum.
    """
    at = arm.index(joint)
    group = moved_with(arm.ties, at)
    for name in (arm.joints[j] for j in group):
        if name in arm.coupled:
            said = arm.coupled[name] if name == joint else f"it moves {name}, and {arm.coupled[name]}"
            raise InputError(f"{arm.file}: joint {joint}", said, _ALONE)
    model = arm.model
    data, q = mujoco.MjData(model), positions(arm, held or {})
    if len(group) > 1:
        return _together(arm, joint, q, group)
    slides = arm.slides(joint)
    mass = np.zeros((model.nv, model.nv))
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, mass)
    moved = float(mass[at, at])
    a, b, upright = gravity_of(model, q, at, moved)
    found = Reduced(
        joint,
        moved - float(arm.armature[at]),
        float(arm.armature[at]),
        spring=float(model.jnt_stiffness[at]),
        q_ref=float(model.qpos_spring[at]),
        slides=slides,
        held=MappingProxyType({name: float(q[i]) for i, name in enumerate(arm.joints) if i != at}),
    )
    if slides:
        return replace(found, constant=a)
    return replace(found, a=a, b=b, upright=upright)


def _together(arm: Arm, joint: str, q: FloatArray, group: Mapping[int, tuple[float, float]]) -> Reduced:
    """The equation of a joint that moves others by ratios, over its range, where that is one of a pendulum or slide."""
    at, model, slides = arm.index(joint), arm.model, arm.slides(joint)
    low, high = map(float, model.jnt_range[at] if model.jnt_limited[at] else q[at] + math.pi * np.array([-1.0, 1.0]))
    x, many, still = np.linspace(low, high, _ANGLES), np.tile(q, (_ANGLES, 1)), np.zeros((_ANGLES, model.nv))
    pushed, ratios = still.copy(), {arm.joints[j]: ratio for j, (ratio, _) in group.items() if j != at}
    for j, (ratio, start) in group.items():
        many[:, j], pushed[:, j] = start + ratio * x, ratio
    load = arm.inverse(many, still, still)[:, at]
    inertia = arm.inverse(many, still, pushed)[:, at] - load
    moved = float(np.mean(inertia))
    # a, b, the force of gravity, and the springs' with where they are slack: of these what there can be
    sprung = any(model.jnt_stiffness[arm.index(name)] for name in (joint, *ratios))
    there = np.array([not slides, not slides, slides or sprung, sprung])
    columns = np.column_stack((np.sin(x), np.cos(x), np.ones(x.size), x))[:, there]
    numbers = np.zeros(4)
    numbers[there] = np.linalg.lstsq(columns, load, rcond=None)[0]
    least = _UPRIGHT * _strength(model, at, moved)
    left = float(np.max(np.abs(load - columns @ numbers[there])))
    if np.ptp(inertia) > _ALIKE * moved or left > max(_ALIKE * float(np.max(np.abs(load))), least):
        found = f"what it moves changes as {', '.join(ratios)} move{'s' * (len(ratios) == 1)} with it"
        raise InputError(f"{arm.file}: joint {joint}", found, _ALONE)
    a, b, force, spring = numbers.tolist()
    return Reduced(
        joint,
        moved - float(arm.armature[at]),
        float(arm.armature[at]),
        a,
        b,
        spring,
        -force / spring if spring and not slides else 0.0,
        force if slides else 0.0,
        slides,
        not slides and math.hypot(a, b) <= least,
        MappingProxyType({name: float(q[i]) for i, name in enumerate(arm.joints) if i not in group}),
        MappingProxyType(ratios),
    )


def _strength(model: Any, joint: int, moved: float) -> float:
    """What gravity could be on an inertia, N m or N."""
    hanging = float(model.body_subtreemass[model.jnt_bodyid[joint]])
    return float(np.linalg.norm(model.opt.gravity)) * math.sqrt(max(moved, 0.0) * hanging)


def gravity_of(model: Any, q: FloatArray, joint: int, moved: float) -> tuple[float, float, bool]:
    """Torque of gravity on a hinge as a sin q + b cos q, N m, and whether that is none; of a slide its force, N, and 0.

    q : positions of all joints. joint : number of one of the model's. moved : kg m^2 or kg.
    """
    at, dof = int(model.jnt_qposadr[joint]), int(model.jnt_dofadr[joint])
    slides = int(model.jnt_type[joint]) == mujoco.mjtJoint.mjJNT_SLIDE.value
    data = mujoco.MjData(model)
    data.qpos[:] = q
    angles = q[at] + 2.0 * math.pi / _ANGLES * np.arange(1 if slides else _ANGLES)
    pull = np.empty(angles.size)
    for i, angle in enumerate(angles):
        data.qpos[at] = angle
        mujoco.mj_forward(model, data)
        pull[i] = data.qfrc_bias[dof] - data.qfrc_gravcomp[dof]
    if slides:
        return float(pull[0]), 0.0, False
    a, b = (2.0 / _ANGLES * float(pull @ wave(angles)) for wave in (np.sin, np.cos))
    return a, b, math.hypot(a, b) <= _UPRIGHT * _strength(model, joint, moved)


def positions(arm: Arm, held: Mapping[str, float]) -> FloatArray:
    """Positions (nv,) with these joints so and the others as the model's reference has them.

    Raises InputError for a joint that there is not, or a position that is no finite number.
    """
    q = np.array(arm.model.qpos0)
    for name, value in held.items():
        if name not in arm.joints:
            accepted = f"joints of {arm.file}: {', '.join(arm.joints)}{did_you_mean(name, arm.joints)}"
            raise InputError("held joint", f"{name!r}", accepted)
        if not math.isfinite(value):
            raise InputError(f"held joint {name}", f"{value}", "a finite position")
        q[arm.joints.index(name)] = value
    return q
