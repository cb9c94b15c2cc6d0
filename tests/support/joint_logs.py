"""Logs of a robot's joints as programs write them, for tests: one motion, written in every format."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

Columns = dict[str, np.ndarray]


@dataclass(frozen=True)
class Motion:
    """Positions and what else of named joints, (n,) each; velocities are the derivative of the positions."""

    t: np.ndarray
    position: Columns
    velocity: Columns = field(default_factory=dict)
    effort: Columns = field(default_factory=dict)

    @property
    def joints(self) -> list[str]:
        return list(self.position)

    def columns(self, pattern: str = "{joint}.{kind}") -> Columns:
        """One column for each field of each joint, named by the pattern ({joint}, {kind}, {i} from 0, {n} from 1)."""
        found = {}
        for kind in ("position", "velocity", "effort"):
            for i, (joint, values) in enumerate(getattr(self, kind).items()):
                found[pattern.format(joint=joint, kind=kind, i=i, n=i + 1)] = values
        return found


def motion(n: int = 400, joints: Sequence[str] = ("shoulder", "elbow"), rate: float = 100.0, seed: int = 1) -> Motion:
    """A swing of each joint at a frequency of its own, with noise on the effort."""
    t = np.arange(n) / rate
    draw = np.random.default_rng(seed)
    position, velocity, effort = {}, {}, {}
    for k, joint in enumerate(joints):
        w = 2.0 * np.pi * (0.3 + 0.2 * k)
        position[joint] = (0.8 + 0.1 * k) * np.sin(w * t)
        velocity[joint] = (0.8 + 0.1 * k) * w * np.cos(w * t)
        effort[joint] = 2.0 * np.cos(w * t) + draw.normal(0.0, 0.1, n)
    return Motion(t, position, velocity, effort)


def csv(path: Path, columns: Mapping[str, np.ndarray], head: str = "") -> Path:
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns), *(",".join(repr(float(v)) for v in row) for row in rows)]
    path.write_text(head + "\n".join(lines) + "\n")
    return path


def parquet(path: Path, columns: Mapping[str, Any]) -> Path:
    pq.write_table(pa.table(dict(columns)), path, row_group_size=100)
    return path


def lerobot(folder: Path, episodes: Sequence[Motion], names: object = None, chunked: bool = False) -> Path:
    """A data set: episodes one after the other in one file, or a file each."""
    (folder / "meta").mkdir(parents=True)
    joints = episodes[0].joints
    shape = {
        "dtype": "float32",
        "shape": [len(joints)],
        "names": [f"{j}.pos" for j in joints] if names is None else names,
    }
    features = {"observation.state": shape, "action": shape, "timestamp": {"dtype": "float32", "shape": [1]}}
    (folder / "meta" / "info.json").write_text(json.dumps({"codebase_version": "v3.0", "features": features}))
    tables = [_episode(number, one) for number, one in enumerate(episodes)]
    for number, table in enumerate(tables if chunked else [pa.concat_tables(tables)]):
        file = folder / "data" / f"chunk-{number:03d}" / "file-000.parquet"
        file.parent.mkdir(parents=True)
        pq.write_table(table, file, row_group_size=100)
    return folder


def _episode(number: int, one: Motion) -> pa.Table:
    state = np.column_stack(list(one.position.values()))
    return pa.table(
        {
            "observation.state": pa.array(list(state), pa.list_(pa.float64())),
            "action": pa.array(list(state + 0.1), pa.list_(pa.float64())),
            "timestamp": pa.array(one.t, pa.float64()),
            "frame_index": pa.array(np.arange(one.t.size)),
            "episode_index": pa.array(np.full(one.t.size, number)),
        }
    )


@dataclass
class Message:
    """What is to be in a sensor_msgs/JointState; stamp and received in ns."""

    stamp: int
    received: int
    names: Sequence[str]
    position: Sequence[float]
    velocity: Sequence[float] = ()
    effort: Sequence[float] = ()


def messages(one: Motion, start: int = 1_700_000_000 * 10**9) -> list[Message]:
    """The motion as a driver sends it."""

    def at(columns: Columns, i: int) -> list[float]:
        return [float(values[i]) for values in columns.values()]

    ns = [start + round(1e9 * float(t)) for t in one.t]
    return [
        Message(ns[i], ns[i] + 10**6, one.joints, at(one.position, i), at(one.velocity, i), at(one.effort, i))
        for i in range(one.t.size)
    ]


def bag1(path: Path, topics: Mapping[str, Sequence[Message]]) -> Path:
    """A bag of ROS 1."""
    from rosbags.rosbag1 import Writer

    store = _store(True)
    with Writer(path) as writer:
        for topic, sent in topics.items():
            connection = writer.add_connection(topic, "sensor_msgs/msg/JointState", typestore=store)
            for k, message in enumerate(sent):
                data = store.serialize_ros1(_message(store, message, seq=k), "sensor_msgs/msg/JointState")
                writer.write(connection, message.received, data)
    return path


def bag2(path: Path, topics: Mapping[str, Sequence[Message]], storage: str = "sqlite3", text: bool = False) -> Path:
    """A folder of a ROS 2 bag; ``text`` adds a topic of another type."""
    from rosbags.rosbag2 import StoragePlugin, Writer

    store = _store(False)
    plugin = StoragePlugin.MCAP if storage == "mcap" else StoragePlugin.SQLITE3
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        for topic, sent in topics.items():
            connection = writer.add_connection(topic, "sensor_msgs/msg/JointState", typestore=store)
            for message in sent:
                data = store.serialize_cdr(_message(store, message), "sensor_msgs/msg/JointState")
                writer.write(connection, message.received, data)
        if text:
            kind = "std_msgs/msg/String"
            connection = writer.add_connection("/rosout", kind, typestore=store)
            writer.write(connection, 10**9, store.serialize_cdr(store.types[kind](data="hello"), kind))
    return path


def packed(message: Message, frame: str, old: bool) -> tuple[Any, bytes]:
    """A message and its bytes, of ROS 1 where ``old``."""
    store = _store(old)
    made = _message(store, message, frame, **({"seq": 3} if old else {}))
    pack = store.serialize_ros1 if old else store.serialize_cdr
    return made, bytes(pack(made, "sensor_msgs/msg/JointState"))


@cache
def _store(old: bool) -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS1_NOETIC if old else Stores.ROS2_HUMBLE)


def _message(store: Any, message: Message, frame: str = "", **header: int) -> Any:
    types = store.types
    stamp = types["builtin_interfaces/msg/Time"](sec=message.stamp // 10**9, nanosec=message.stamp % 10**9)
    return types["sensor_msgs/msg/JointState"](
        header=types["std_msgs/msg/Header"](stamp=stamp, frame_id=frame, **header),
        name=list(message.names),
        **{k: np.array(getattr(message, k), dtype=np.float64) for k in ("position", "velocity", "effort")},
    )


ONE = motion()
HOLED = ONE.position["elbow"].copy()
HOLED[7] = np.nan


def short_of(path: Path, **change: np.ndarray) -> Path:
    """The log of ONE as a table, some of its columns changed; those that are empty are left out."""
    columns = {"t": ONE.t, **ONE.columns(), **change}
    return csv(path, {name: values for name, values in columns.items() if values.size})


def two(path: Path) -> Path:
    """A bag with the joint states of ONE under two names, beside another topic."""
    sent = messages(ONE)
    return bag2(path, {"/left/joint_states": sent, "/right/joint_states": sent}, text=True)
