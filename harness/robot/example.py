"""A log of a robot's joints with known friction, to try things on: ``python -m harness.robot.example DIR``.

Joints move as sums of sines, and the torque is what the rigid model and the friction then need, so that both are exact
before noise is put on them.
"""

import argparse
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.joint_log import JointLog
from harness.core.writing import replacing
from harness.engines.models import folder
from harness.robot.arm import Arm, load_arm


@dataclass(frozen=True, slots=True)
class Friction:
    """Of a joint. f_k : N m or N. c : N m s/rad or N s/m. offset : a torque or force that is always there."""

    f_k: float
    c: float
    offset: float = 0.0


FRICTION = {"base": Friction(0.6, 0.2), "shoulder": Friction(1.1, 0.4), "elbow": Friction(0.35, 0.12)}
"""Of the arm of models/arm in the example: more than its model has."""
_SINES = 5
"""Of each joint's motion."""
_SLOWEST, _FASTEST = 0.1, 0.6
"""Their frequencies, Hz."""
_ENCODER, _TORQUE = 2e-5, 0.01
"""Noise of positions, rad, and of torques, share of their rms."""


def excited(
    arm: Arm,
    friction: Mapping[str, Friction],
    moving: tuple[str, ...],
    duration: float = 30.0,
    rate: float = 250.0,
    amplitude: float = 0.9,
    seed: int = 0,
) -> JointLog:
    """A log in which some joints move and the others are held; the same for the same seed.

    friction : by joint, none for those left out. duration : s. rate : Hz. amplitude : largest of a motion, rad.
    """
    random = np.random.default_rng(seed)
    t = np.arange(round(duration * rate) + 1) / rate
    q = np.tile(arm.model.qpos0, (t.size, 1))
    v, a = np.zeros_like(q), np.zeros_like(q)
    for name in arm.joints:
        size, turn = random.uniform(0.2, 1.0, _SINES), random.uniform(0.0, 2.0 * math.pi, _SINES)
        omega = 2.0 * math.pi * random.uniform(_SLOWEST, _FASTEST, _SINES)
        if name in moving:
            at = omega[:, None] * t + turn[:, None]
            scale = amplitude / float(np.max(np.abs(size @ np.sin(at))))
            i = arm.index(name)
            q[:, i] += scale * (size @ np.sin(at))
            v[:, i], a[:, i] = scale * ((size * omega) @ np.cos(at)), -scale * ((size * omega**2) @ np.sin(at))
    torque = arm.inverse(q, v, a)
    for name, one in friction.items():
        i = arm.index(name)
        torque[:, i] += one.f_k * np.sign(v[:, i]) + one.c * v[:, i] + one.offset
    torque += _TORQUE * np.sqrt(np.mean(torque**2, axis=0)) * random.normal(size=torque.shape)
    seen = q + _ENCODER * random.normal(size=q.shape)
    position = {name: seen[:, i] for i, name in enumerate(arm.joints)}
    effort = {name: torque[:, i] for i, name in enumerate(arm.joints)}
    velocity = {name: v[:, i] for i, name in enumerate(arm.joints)}
    return JointLog(t, position, velocity, effort, file="an example")


def table(log: JointLog) -> str:
    """A log as CSV with columns t, NAME.position, NAME.velocity and NAME.effort."""
    columns: dict[str, FloatArray] = {"t": log.t}
    for kind in ("position", "velocity", "effort"):
        columns |= {f"{name}.{kind}": values for name, values in getattr(log, kind).items()}
    rows = np.column_stack(list(columns.values())).tolist()
    lines = [",".join(columns), *(",".join(f"{value:.9g}" for value in row) for row in rows)]
    return "\n".join(lines) + "\n"


def write(log: JointLog, path: Path) -> None:
    """Write a log as CSV, whole or not at all. Raises StoreError."""
    with replacing(path) as file:
        file.write_text(table(log), encoding="utf-8")


def write_bag(log: JointLog, path: Path) -> None:
    """Write a log as an MCAP bag of sensor_msgs/JointState, the topic /joint_states.

    path : of the bag's folder, which must not be there. Raises InputError where rosbags is not installed.
    """
    try:
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise InputError(str(path), "rosbags, which writes it, is not installed", "a CSV is accepted") from None
    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    stamp, header = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
    state = types["sensor_msgs/msg/JointState"]
    names = list(log.joints)
    kinds = [np.column_stack([getattr(log, kind)[n] for n in names]) for kind in ("position", "velocity", "effort")]
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        topic = writer.add_connection("/joint_states", state.__msgtype__, typestore=store)
        for i, at in enumerate(log.t.tolist()):
            nanoseconds = round(at * 1e9)
            time = stamp(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
            message = state(header(stamp=time, frame_id=""), names, *(kind[i] for kind in kinds))
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
