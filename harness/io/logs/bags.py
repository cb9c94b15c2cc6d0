"""ROS bags: sensor_msgs/JointState of ROS 1 (.bag), ROS 2 (sqlite3, MCAP, a folder of either), message by message.

What runs here runs in a process of its own (harness.core.apart), but for ``need_rosbags``. The type is known, so that
whatever other types a bag defines is not looked at.
"""

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import Found
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.logs.raw import Field
from harness.io.registry import BAGS

TYPE = "sensor_msgs/msg/JointState"
ACCEPTED = "a whole ROS bag (.bag, .db3, .mcap, or a folder of a ROS 2 bag)"
FIELDS: tuple[Field, ...] = ("position", "velocity", "effort")


@dataclass(slots=True)
class Joints:
    """The messages that speak of one set of joints.

    names : as the first of them orders them. unnamed : whether messages have none. stamps : of the header and of
    receiving, ns. values : (fields, joints) each. reordered : messages that order joints otherwise.
    """

    names: tuple[str, ...]
    unnamed: bool
    stamps: list[tuple[int, int]] = field(default_factory=list)
    values: list[FloatArray] = field(default_factory=list)
    reordered: int = 0

    def add(self, names: tuple[str, ...], stamps: tuple[int, int], values: Sequence[FloatArray]) -> None:
        """One message; joints are followed by their names, a field that it leaves empty is nan."""
        row = np.array([given if given.size else np.full(len(names), np.nan) for given in values])
        if names != self.names:
            self.reordered += 1
            row = row[:, [names.index(name) for name in self.names]]
        self.stamps.append(stamps)
        self.values.append(row)

    def columns(self) -> tuple[dict[str, FloatArray], list[str]]:
        """Times in s and the values, and what is said of the times."""
        header, received = np.array(self.stamps, dtype=np.int64).T
        forward = header.size > 1 and bool(np.all(np.diff(header) >= 0)) and header[-1] > header[0]
        notes = ["Times are those of the headers."]
        if not forward:
            why = "do not change" if np.all(header == header[0]) else "go back"
            notes = [f"Times are those of receiving: the stamps of the headers {why}."]
        if self.reordered:
            many = f"{self.reordered} of {header.size} messages"
            notes.append(f"Joints change their order in {many}: followed by name.")
        stamps = header if forward else received
        columns = {"t": (stamps - stamps[0]).astype(np.float64) * 1e-9}
        for k, kind in enumerate(FIELDS):
            for j, name in enumerate(self.names):
                column = np.array([row[k, j] for row in self.values])
                if not np.all(np.isnan(column)):
                    columns[f"{kind} {name}"] = column
        return columns, notes


def need_rosbags(path: Path) -> None:
    """Raise InputError, that says what to install, where the package is missing that reads bags."""
    if find_spec("rosbags") is None:
        found = "a ROS bag, and the package rosbags that reads it is not installed"
        raise InputError(str(path), found, "try: pip install 'friction-harness[bags]'")


def storages(path: Path) -> list[Path]:
    """The files of a bag, or none where ``path`` is no bag."""
    if path.is_file():
        return [path] if path.suffix.lower() in BAGS else []
    kinds = (".db3", ".mcap", ".zstd") if (path / "metadata.yaml").is_file() else (".db3", ".mcap")
    return sorted(file for file in path.glob("*") if file.suffix in kinds)


def topics_of(path: Path) -> Found:
    """Name, type and count of every topic, without a look at messages."""
    with _opened(path) as readers:
        counts: dict[tuple[str, str], int] = {}
        for connection in (one for reader in readers for one in reader.connections):
            key = connection.topic, connection.msgtype
            counts[key] = counts.get(key, 0) + connection.msgcount
        return {}, [[topic, kind, count] for (topic, kind), count in counts.items()]


def columns_of(path: Path, topic: str) -> Found:
    """Every message of a topic of joint states: columns and what was said, for each set of joints.

    The set with most values comes first; columns are numbered by sets. Raises InputError for a message that makes no
    sense.
    """
    from rosbags.typesys import Stores, get_typestore

    sets: dict[frozenset[str], Joints] = {}
    with _opened(path) as readers:
        old = path.suffix == ".bag"
        store = get_typestore(Stores.ROS1_NOETIC if old else Stores.ROS2_HUMBLE)
        read: Any = store.deserialize_ros1 if old else store.deserialize_cdr
        count = 0
        for reader in readers:
            connections = [c for c in reader.connections if c.topic == topic and c.msgtype == TYPE]
            for _, received, data in reader.messages(connections) if connections else ():
                message, count = read(data, TYPE), count + 1
                names, values = tuple(message.name), [getattr(message, kind) for kind in FIELDS]
                unnamed = not names and values[0].size > 0
                if unnamed:
                    names = tuple(f"joint{k + 1}" for k in range(values[0].size))
                joints = sets.get(frozenset(names))
                if joints is None or names != joints.names or any(y.size not in (0, len(names)) for y in values):
                    _check(f"{path}: {topic}: message {count}", names, values)
                    joints = sets.setdefault(frozenset(names), Joints(names, unnamed))
                stamp = message.header.stamp
                joints.add(names, (stamp.sec * 10**9 + stamp.nanosec, received), values)
    columns: dict[str, FloatArray] = {}
    about = []
    for number, joints in enumerate(sorted(sets.values(), key=lambda one: -len(one.stamps) * len(one.names))):
        held, notes = joints.columns()
        columns |= {f"{number} {key}": values for key, values in held.items()}
        said = {"joints": list(joints.names), "count": len(joints.stamps), "notes": notes, "numbered": joints.unnamed}
        about.append(said)
    return columns, about


def _check(where: str, names: tuple[str, ...], values: Sequence[FloatArray]) -> None:
    """Raise InputError for a message whose names and values do not fit."""
    for kind, given in zip(FIELDS, values, strict=True):
        if given.size not in (0, len(names)):
            found = f"{given.size} values of {kind} for {len(names)} joints"
            raise InputError(where, found, "a value for each joint")
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InputError(where, f"the joint {twice} twice", "names that differ")


@contextmanager
def _opened(path: Path) -> Iterator[list[Any]]:
    """The readers of a bag; a folder without metadata.yaml is its files one after the other."""
    from rosbags.rosbag1 import Reader as Reader1
    from rosbags.rosbag2 import Reader as Reader2

    whole = path.is_file() or (path / "metadata.yaml").is_file()
    with ExitStack() as stack:
        try:
            make = Reader1 if path.suffix == ".bag" else Reader2
            yield [stack.enter_context(make(file)) for file in ([path] if whole else storages(path))]
        except (InputError, MemoryError):
            raise
        except Exception as error:  # rosbags raises its own errors, and whatever damaged bytes lead it to
            said = " ".join(str(error).split()) or type(error).__name__
            raise InputError(str(path), f"cannot be read as a ROS bag ({said})", ACCEPTED) from None


def seconds_of(sizes: int) -> int:
    """How long reading may take for so many bytes, s of a processor; a message is unpacked by a program in Python."""
    return int(10 + np.ceil(sizes / 1e6))
