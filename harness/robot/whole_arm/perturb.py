"""The same arm with another mass, a load at its end, another armature, a tilted base or other zeros."""

import copy
import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations_with_replacement
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.robot.arm import Arm


def moving_bodies(arm: Arm) -> tuple[int, ...]:
    """Bodies with mass that a joint of the arm moves, from the base outwards."""
    model = arm.model
    return tuple(b for b in range(1, model.nbody) if model.body_weldid[b] != 0 and model.body_mass[b] > 0.0)


def last_body(arm: Arm) -> int:
    """The body with mass that most joints carry: where a payload is fastened."""
    model = arm.model
    return max(moving_bodies(arm), key=lambda b: (_joints_below(model, b), b))


def _joints_below(model: Any, body: int) -> int:
    """Degrees of freedom between a body and the world."""
    count = 0
    while body != 0:
        count += int(model.body_dofnum[body])
        body = int(model.body_parentid[body])
    return count


def with_mass(arm: Arm, body: int, factor: float) -> Arm:
    """The arm with mass and inertia of one body times ``factor``."""
    model = copy.copy(arm.model)
    model.body_mass[body] *= factor
    model.body_inertia[body] *= factor
    return _settled(arm, model)


def called(arm: Arm, body: int) -> str:
    """A body's name, or its number where it has none."""
    return str(arm.model.body(body).name) or f"body {body}"


def loaded_bodies(arm: Arm, most: int) -> tuple[int, ...]:
    """Bodies with mass that may carry a load, the last one first: of those that turn together the nearest to it."""
    found, model = [last_body(arm)], arm.model
    above = int(model.body_parentid[found[0]])
    while above and len(found) < most:
        if _joints_below(model, above) < _joints_below(model, found[-1]) and above in moving_bodies(arm):
            found.append(above)
        above = int(model.body_parentid[above])
    return tuple(found)


def with_load(arm: Arm, kg: float, beside: FloatArray | None = None, on: int | None = None) -> Arm:
    """The arm with a point mass on a body, by default its last: at its centre of mass, or ``beside`` that (3,), m."""
    model, body = copy.copy(arm.model), last_body(arm) if on is None else on
    mass, centre = float(model.body_mass[body]), np.array(model.body_ipos[body])
    at = centre if beside is None else centre + beside
    axes = _axes(model, body)
    inertia = axes @ np.diag(model.body_inertia[body]) @ axes.T
    both = (mass * centre + kg * at) / (mass + kg)
    _put(model, body, mass + kg, both, inertia + _of_point(mass, centre - both) + _of_point(kg, at - both))
    return _settled(arm, model)


def _axes(model: Any, body: int) -> FloatArray:
    """Of a body's principal inertia, as columns (3, 3)."""
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[body])
    return turn.reshape(3, 3)


def _put(model: Any, body: int, mass: float, centre: FloatArray, inertia: FloatArray) -> None:
    """Give a body mass, centre of mass (3,) and inertia (3, 3) about that."""
    principal, axes = np.linalg.eigh(inertia)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    mujoco.mju_mat2Quat(model.body_iquat[body], np.ascontiguousarray(axes).ravel())
    model.body_mass[body], model.body_ipos[body], model.body_inertia[body] = mass, centre, principal
    # a body whose centre of mass was its origin was compiled by a shorter way, which leaves the new one out
    model.body_sameframe[body] = model.body_simple[body] = 0
    first, count = int(model.body_dofadr[body]), int(model.body_dofnum[body])
    model.dof_simplenum[first : first + count] = 0


def _of_point(kg: float, at: FloatArray) -> FloatArray:
    """Inertia (3, 3) of a point mass at (3,)."""
    return np.asarray(kg * (float(at @ at) * np.eye(3) - np.outer(at, at)), dtype=np.float64)


def inertials(arm: Arm) -> Iterator[tuple[Arm, float, float]]:
    """The arm with one inertial number of one body changed, by how much, and how large it is in the model.

    Mass, three first moments and six of inertia about the body's origin, of every body that moves. Torque is linear in
    them.
    """
    for body in moving_bodies(arm):
        model = arm.model
        mass, centre, axes = float(model.body_mass[body]), np.array(model.body_ipos[body]), _axes(model, body)
        inertia = axes @ np.diag(model.body_inertia[body]) @ axes.T
        long = math.sqrt(float(np.trace(inertia)) / mass + float(centre @ centre))
        about = inertia + _of_point(mass, centre)
        yield _with_inertials(arm, body, mass * (1 + _STEP), mass * centre, about), mass * _STEP, mass
        for k in range(3):
            moved = mass * centre + mass * long * _STEP * np.eye(3)[k]
            yield _with_inertials(arm, body, mass, moved, about), mass * long * _STEP, mass * long
        for row, column in combinations_with_replacement(range(3), 2):
            more = np.zeros((3, 3))
            more[row, column] = more[column, row] = size = mass * long**2 * _STEP
            yield _with_inertials(arm, body, mass, mass * centre, about + more), size, mass * long**2


_STEP = 0.1
"""Share by which an inertial number is moved to see what it changes."""


def _with_inertials(arm: Arm, body: int, mass: float, moment: FloatArray, about: FloatArray) -> Arm:
    """The arm with these of one body: kg, kg m (3,), kg m^2 about its origin (3, 3)."""
    model, centre = copy.copy(arm.model), moment / mass
    above, more = body, mass - float(model.body_mass[body])
    while above:
        model.body_subtreemass[above] += more
        above = int(model.body_parentid[above])
    model.body_subtreemass[0] += more
    _put(model, body, mass, centre, about - _of_point(mass, centre))
    return replace(arm, model=model)


def without_armature(arm: Arm) -> Arm:
    """The arm as a sensor behind the gearbox sees it: no rotor."""
    model = copy.copy(arm.model)
    model.dof_armature[:] = 0.0
    return replace(_settled(arm, model), armature=np.zeros_like(arm.armature))


def under(arm: Arm, gravity: FloatArray) -> Arm:
    """The arm under another gravity (3,), m/s^2 in the frame of its base."""
    model = copy.copy(arm.model)
    model.opt.gravity[:] = gravity
    return _settled(arm, model)


def tilted(arm: Arm, angle: float, about: int) -> Arm:
    """The arm with gravity turned by ``angle``, rad, about an axis of the base (0 x, 1 y)."""
    model = copy.copy(arm.model)
    c, s, other = math.cos(angle), math.sin(angle), 1 - about
    g = np.array(model.opt.gravity)
    sign = -1.0 if about == 0 else 1.0
    model.opt.gravity[other] = c * g[other] + sign * s * g[2]
    model.opt.gravity[2] = c * g[2] - sign * s * g[other]
    return _settled(arm, model)


def with_zeros(arm: Arm, shift: FloatArray) -> Arm:
    """The arm as it stands where every position is ``shift`` (nv,), rad or m, more than it says."""
    model = copy.copy(arm.model)
    model.qpos0[:] -= shift
    model.qpos_spring[:] -= shift
    return _settled(arm, model)


def _settled(arm: Arm, model: Any) -> Arm:
    """The arm with this model, what MuJoCo derives from masses made anew."""
    mujoco.mj_setConst(model, mujoco.MjData(model))
    return replace(arm, model=model)
