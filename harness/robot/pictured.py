"""A robot as it looks: the shapes of its own model where it has them, else links drawn from joint to joint."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.robot import Bodies, Kind, Shape
from harness.core.trajectory import Trajectory
from harness.robot.apart import compiled
from harness.robot.arm import Arm

_KINDS: dict[int, Kind] = {
    mujoco.mjtGeom.mjGEOM_BOX.value: "box",
    mujoco.mjtGeom.mjGEOM_SPHERE.value: "sphere",
    mujoco.mjtGeom.mjGEOM_CAPSULE.value: "capsule",
    mujoco.mjtGeom.mjGEOM_CYLINDER.value: "cylinder",
    mujoco.mjtGeom.mjGEOM_ELLIPSOID.value: "ellipsoid",
    mujoco.mjtGeom.mjGEOM_MESH.value: "mesh",
}
_SEEN_GROUPS = 3
"""Groups of geoms that MuJoCo's viewer shows unless told otherwise: 0, 1, 2."""
_FAINT = 0.05
"""Opacity below which nothing is seen."""
_FRAMES = 2400
"""Poses at most; a picture a thirtieth of a second is smooth."""
_PER_SECOND = 30.0
_MOST_CORNERS = 300_000
"""Of all meshes together: more would make a trace that is slow to open."""
_SLENDER = 0.13
"""Radius of a link over the median distance from joint to joint."""
_LINK, _AXLE, _ASKED = (201, 205, 212), (74, 82, 94), (43, 127, 214)


def moved(path: Path, arm: Arm, joint: str, motion: Trajectory | None) -> Bodies:
    """The robot in the reference of its model, one joint moving from there; None: still."""
    if motion is None:
        return pictured(path, arm, np.zeros(1), {}, joint)
    return pictured(path, arm, motion.t, {joint: arm.model.qpos0[arm.index(joint)] + motion.x}, joint)


def pictured(path: Path, arm: Arm, times: FloatArray, position: Mapping[str, FloatArray], joint: str) -> Bodies:
    """The robot of a model's file, moving as a log has it; joint : is marked at its axle."""
    model = _model(path, arm)
    found = [*_shapes(model), *_links(model, _at(model, arm, joint))]
    step = max(1, math.ceil(times.size / min(_FRAMES, _PER_SECOND * float(times[-1] - times[0]) + 2.0)))
    t = times[::step]
    q = np.tile(model.qpos0, (t.size, 1))
    for name, y in position.items():
        if name in arm.joints:
            q[:, _at(model, arm, name)] = y[::step]
    data = mujoco.MjData(model)
    places, turns = np.empty((t.size, model.nbody, 3)), np.empty((t.size, model.nbody, 4))
    for i in range(t.size):
        data.qpos[:] = q[i]
        mujoco.mj_kinematics(model, data)
        places[i], turns[i] = data.xpos, data.xquat
    names = tuple(model.body(i).name or f"body {i}" for i in range(model.nbody))
    return Bodies(names, tuple(found), t, places, turns)


def _model(path: Path, arm: Arm) -> Any:
    """With shapes where they can be read, else the rigid model: nothing that is only looked at stops a diagnosis."""
    for looks in ("meshes", "bare"):
        try:
            found, _ = compiled(path, looks=looks)
        except (InputError, OSError):
            continue
        if found.njnt == arm.model.njnt and found.nq == found.njnt:
            return found
    return arm.model


def _at(model: Any, arm: Arm, joint: str) -> int:
    """Number of a joint in a model whose joints without a name stand in the same order."""
    i = arm.joints.index(joint)
    return next((j for j in range(model.njnt) if model.joint(j).name == joint), i)


def _shapes(model: Any) -> Iterator[Shape]:
    geoms = [i for i in range(model.ngeom) if int(model.geom_type[i]) in _KINDS]
    seen = [i for i in geoms if model.geom_group[i] < _SEEN_GROUPS] or geoms
    corners = 0
    for i in seen:
        kind, mesh = _KINDS[int(model.geom_type[i])], int(model.geom_dataid[i])
        color = _color(model, i)
        if color is None:
            continue
        body, size = int(model.geom_bodyid[i]), np.array(model.geom_size[i])
        place, turn = np.array(model.geom_pos[i]), np.array(model.geom_quat[i])
        if kind != "mesh":
            yield Shape(body, kind, size, place, turn, color)
            continue
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        corners += count
        if corners > _MOST_CORNERS:
            continue
        face, faces = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
        yield Shape(
            body, kind, size, place, turn, color,
            np.array(model.mesh_vert[first : first + count], dtype=np.float64),
            np.array(model.mesh_face[face : face + faces], dtype=np.int64),
        )  # fmt: skip


def _color(model: Any, geom: int) -> tuple[int, int, int] | None:
    """Of a geom, from its material where it has one; None for what is not seen."""
    material = int(model.geom_matid[geom])
    own = model.geom_rgba[geom] if material < 0 else model.mat_rgba[material]
    if own[3] < _FAINT:
        return None
    red, green, blue = (round(255.0 * float(c)) for c in own[:3])
    return red, green, blue


def _links(model: Any, at: int) -> Iterator[Shape]:
    """A capsule from joint to joint for each body that has no shape, and an axle at each of their joints.

    at : number of the joint that is marked.
    """
    drawn = {int(model.geom_bodyid[i]) for i in range(model.ngeom) if int(model.geom_type[i]) in _KINDS}
    bare = {i for i in range(1, model.nbody) if i not in drawn and int(model.body_weldid[i]) != 0}
    # median distance from joint to joint
    steps = [float(np.linalg.norm(model.body_pos[i])) for i in range(1, model.nbody)]
    steps += [2.0 * float(np.linalg.norm(model.body_ipos[model.nbody - 1]))]
    radius = _SLENDER * float(np.median([one for one in steps if one > 0.0] or [0.1]))
    for body in bare:
        start = np.array(model.jnt_pos[model.body_jntadr[body]]) if model.body_jntnum[body] else np.zeros(3)
        children = [i for i in range(1, model.nbody) if int(model.body_parentid[i]) == body]
        ends = [model.body_pos[i] for i in children] or [2.0 * model.body_ipos[body] - start]
        for end in ends:
            along = np.array(end) - start
            if float(np.linalg.norm(along)) > radius:
                half = 0.5 * float(np.linalg.norm(along))
                size = np.array([radius, half, 0.0])
                yield Shape(body, "capsule", size, start + 0.5 * along, _turn(along), _LINK)
    for j in range(model.njnt):
        body = int(model.jnt_bodyid[j])
        if body in bare:
            size = np.array([1.35 * radius, 1.35 * radius, 0.0])
            color = _ASKED if j == at else _AXLE
            yield Shape(body, "cylinder", size, np.array(model.jnt_pos[j]), _turn(model.jnt_axis[j]), color)


def _turn(along: Any) -> FloatArray:
    """Quaternion (w, x, y, z) that turns z along a vector."""
    quat = np.empty(4)
    mujoco.mju_quatZ2Vec(quat, np.asarray(along, dtype=np.float64))
    return quat
