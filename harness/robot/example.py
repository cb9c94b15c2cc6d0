"""A log of a robot's joints with known friction, to try things on: ``python -m harness.robot.example DIR``.

A servo follows sums of sines, its torque held from one sample to the next, as controllers do; MuJoCo carries the arm
along in much shorter steps, with friction as stiff as those allow. What is logged is noisy, what moved is not.
"""

import argparse
import copy
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.robot import JointLog
from harness.core.writing import replacing
from harness.engines.models import folder
from harness.engines.mujoco.presets import presets
from harness.robot.arm import Arm, load_arm
from harness.robot.reduction import reduced


@dataclass(frozen=True, slots=True)
class Friction:
    """Of a joint. f_k : N m or N. c : N m s/rad or N s/m. offset : a torque or force that is always there."""

    f_k: float
    c: float
    offset: float = 0.0


FRICTION = {"base": Friction(0.6, 0.2), "shoulder": Friction(1.1, 0.4), "elbow": Friction(0.35, 0.12)}
"""Of the arm of models/arm in the example: more than its model has."""
_KINDS = ("position", "velocity", "effort")
_SINES = 5
"""Of each joint's motion."""
_SLOWEST, _FASTEST = 0.1, 0.9
"""Their frequencies, Hz."""
_ENCODER, _SPEED, _TORQUE = 2e-5, 2e-3, 0.005
"""Noise of positions (rad), of speeds (rad/s), and of torques, share of their rms."""
_STEP = 2e-4
"""Of MuJoCo, s."""
_LOCKED = 1e4
"""Rotor inertia, kg m^2, with which a joint stands still between samples; at each it is put back."""
_STIFF, _DAMPED = 40.0, 2.0
"""A servo's gains over the joint's inertia times its bandwidth squared, and times that."""
_BANDWIDTH = 5.0
"""rad/s."""


def excited(
    arm: Arm,
    friction: Mapping[str, Friction],
    moving: tuple[str, ...],
    duration: float = 30.0,
    rate: float = 250.0,
    amplitude: float = 0.9,
    seed: int = 0,
) -> JointLog:
    """A log in which some joints move and the others are locked; the same for the same seed.

    friction : by joint, none for those left out. duration : s. rate : Hz. amplitude : largest of a wanted motion, rad.
    """
    random = np.random.default_rng(seed)
    t = np.arange(round(duration * rate) + 1) / rate
    wanted = _wanted(arm, moving, t, amplitude, random)
    q, v, torque = _followed(arm, friction, moving, wanted, rate)
    torque = torque + _TORQUE * np.sqrt(np.mean(torque**2, axis=0)) * random.normal(size=torque.shape)
    seen = q + _ENCODER * random.normal(size=q.shape), v + _SPEED * random.normal(size=q.shape)
    position, velocity, effort = ({name: y[:, i] for i, name in enumerate(arm.joints)} for y in (*seen, torque))
    return JointLog(t, position, velocity, effort, file="an example")


def _wanted(
    arm: Arm, moving: tuple[str, ...], t: FloatArray, amplitude: float, random: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Positions and speeds (n, nv) that the servos are to follow."""
    q = np.tile(arm.model.qpos0, (t.size, 1))
    v = np.zeros_like(q)
    for i, name in enumerate(arm.joints):
        size, turn = random.uniform(0.2, 1.0, _SINES), random.uniform(0.0, 2.0 * math.pi, _SINES)
        omega = 2.0 * math.pi * random.uniform(_SLOWEST, _FASTEST, _SINES)
        if name in moving:
            at = omega[:, None] * t + turn[:, None]
            scale = amplitude / float(np.max(np.abs(size @ np.sin(at))))
            q[:, i] += scale * (size @ np.sin(at))
            v[:, i] = scale * ((size * omega) @ np.cos(at))
    return q, v


def _followed(
    arm: Arm,
    friction: Mapping[str, Friction],
    moving: tuple[str, ...],
    wanted: tuple[FloatArray, FloatArray],
    rate: float,
) -> FloatArray:
    """Positions, speeds and the servos' torques (3, n, nv)."""
    model = copy.copy(arm.model)
    model.opt.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT.value | mujoco.mjtDisableBit.mjDSBL_LIMIT.value
    substeps = max(1, math.ceil(1.0 / (rate * _STEP)))
    model.opt.timestep = 1.0 / (rate * substeps)
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4.value
    stiff = presets("joint", "tuned", model.opt.timestep)
    model.dof_solref[:], model.dof_solimp[:] = stiff["solreffriction"], stiff["solimpfriction"]
    offset = np.zeros(model.nv)
    for name, one in friction.items():
        i = arm.index(name)
        model.dof_frictionloss[i], model.dof_damping[i], offset[i] = one.f_k, one.c, one.offset
    still = [i for i, name in enumerate(arm.joints) if name not in moving]
    model.dof_armature[still] = _LOCKED
    model.actuator_gainprm[:] = model.actuator_biasprm[:] = 0.0
    inertia, data = np.array([reduced(arm, name).moved for name in arm.joints]), mujoco.MjData(model)
    q, v, applied = data.qpos, data.qvel, data.qfrc_applied
    q[:], v[:] = wanted[0][0], wanted[1][0]
    found = np.zeros((3, *wanted[0].shape))
    for k in range(wanted[0].shape[0]):
        q[still], v[still] = wanted[0][k, still], 0.0
        behind, slow = wanted[0][k] - q, wanted[1][k] - v
        torque = inertia * _BANDWIDTH * (_STIFF * _BANDWIDTH * behind + _DAMPED * _BANDWIDTH * slow)
        found[0, k], found[1, k], found[2, k] = q, v, torque
        applied[:] = torque - offset
        mujoco.mj_step(model, data, substeps)
    return found


def write(log: JointLog, path: Path) -> None:
    """Write a log as CSV with columns t, NAME.position, NAME.velocity and NAME.effort, whole or not at all.

    Raises StoreError.
    """
    names = [f"{name}.{kind}" for kind in _KINDS for name in getattr(log, kind)]
    columns = [values for kind in _KINDS for values in getattr(log, kind).values()]
    with replacing(path) as file:
        rows = np.column_stack((log.t, *columns))
        np.savetxt(file, rows, "%.9g", ",", header=",".join(("t", *names)), comments="", encoding="utf-8")


def table(log: JointLog) -> str:
    """A log as CSV with columns t, NAME.position, NAME.velocity and NAME.effort."""
    columns: dict[str, FloatArray] = {"t": log.t}
    for kind in ("position", "velocity", "effort"):
        columns |= {f"{name}.{kind}": values for name, values in getattr(log, kind).items()}
    rows = np.column_stack(list(columns.values())).tolist()
    lines = [",".join(columns), *(",".join(f"{value:.9g}" for value in row) for row in rows)]
    return "\n".join(lines) + "\n"


def write_bag(log: JointLog, path: Path) -> None:
    """Write a log as an MCAP bag of sensor_msgs/JointState, the topic /joint_states.

    path : of the bag's folder, which must not be there. Raises InputError where rosbags is not installed.
    """
    try:
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(str(path), "rosbags, which writes it, is not installed", "a CSV") from None
    store = get_typestore(Stores.ROS2_HUMBLE)
    kinds = ("builtin_interfaces/msg/Time", "std_msgs/msg/Header", "sensor_msgs/msg/JointState")
    stamp, header, state = (store.types[kind] for kind in kinds)
    names = list(log.joints)
    every = [np.column_stack([getattr(log, kind)[n] for n in names]) for kind in _KINDS]
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        topic = writer.add_connection("/joint_states", state.__msgtype__, typestore=store)
        for i, at in enumerate(log.t.tolist()):
            nanoseconds = round(at * 1e9)
            time = stamp(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
            message = state(header(stamp=time, frame_id=""), names, *(kind[i] for kind in every))
            writer.write(topic, nanoseconds, store.serialize_cdr(message, state.__msgtype__))


def main() -> None:
    """Write locked.csv (the shoulder moves) and moving.csv (all move) to a folder, and bags where rosbags is there."""
    parser = argparse.ArgumentParser(description="Logs of the arm of models/arm with known friction.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    arm = load_arm(folder() / "arm" / "arm.xml")
    given.folder.mkdir(parents=True, exist_ok=True)
    for name, moving in (("locked", ("shoulder",)), ("moving", arm.joints)):
        log = excited(arm, FRICTION, moving, seed=given.seed)
        write(log, given.folder / f"{name}.csv")
        try:
            write_bag(log, given.folder / name)
        except InputError as error:
            print(error)


if __name__ == "__main__":
    main()
