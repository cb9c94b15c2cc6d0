"""ROS bags: sensor_msgs/JointState of ROS 1 (.bag), ROS 2 (sqlite3, MCAP, a folder of either), message by message.

What runs here runs in a process of its own (harness.core.apart), but for ``need_rosbags``. The type is known, so that
whatever other types a bag defines is not looked at.

Joint states, message by message, as columns that grow by blocks; joints are followed by their names.
"""

import struct
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import Found
from harness.core.arrays import FloatArray, IntArray
from harness.core.errors import InputError
from harness.io.logs.raw import Field
from harness.io.registry import BAGS

_HEAD, _STAMP = 4, 8
"""Bytes before the stamp (of the encapsulation, or the sequence number), and of the stamp."""


@dataclass(frozen=True, slots=True)
class Layout:
    """One layout. kept : places of bytes that are those of ``like``. numbers : place and count of each array."""

    like: bytes
    kept: tuple[slice, ...]
    numbers: tuple[tuple[int, int], ...]

    def read(self, data: bytes) -> tuple[tuple[int, int], list[FloatArray]] | None:
        """Seconds and nanoseconds of the stamp, and the arrays; None for bytes of another layout."""
        if len(data) != len(self.like) or any(data[part] != self.like[part] for part in self.kept):
            return None
        return struct.unpack_from("<iI", data, _HEAD), [np.frombuffer(data, "<f8", n, at) for at, n in self.numbers]


def layout_of(data: bytes, frame: str, names: Sequence[str], values: Sequence[FloatArray], old: bool) -> Layout | None:
    """The layout of a message that was unpacked to this; None where its bytes are not as expected.

    frame : frame_id of its header. values : position, velocity, effort. old : of ROS 1.
    """
    end = _HEAD + _STAMP

    def after(size: int, alignment: int) -> int:
        at = end if old else _HEAD + -(-(end - _HEAD) // alignment) * alignment
        return at + size

    for text in (frame, None, *names):  # None: how many names there are
        end = after(4, 4) + (0 if text is None else len(text.encode()) + (0 if old else 1))
    numbers, kept = [], [slice(_HEAD + _STAMP, end)]
    for array in values:
        begin, end = end, after(4, 4)
        start = after(0, 8) if array.size else end
        kept.append(slice(begin, start))
        numbers.append((start, array.size))
        end = start + 8 * array.size
    found = Layout(data, (*kept, *([] if old else [slice(0, _HEAD)])), tuple(numbers))
    if end != len(data) or not (old or data[:2] == b"\x00\x01"):
        return None
    read = found.read(data)
    alike = read is not None and all(a.tobytes() == b.tobytes() for a, b in zip(read[1], values, strict=True))
    return found if alike else None


FIELDS: tuple[Field, ...] = ("position", "velocity", "effort")
_FIRST = 1024
"""Rows of the first block; each time it is full it doubles."""


class Joints:
    """The messages that speak of one set of joints.

    names : as the first of them orders them. reordered : messages that order them otherwise.
    """

    def __init__(self, names: tuple[str, ...]) -> None:
        self.names, self.size, self.reordered = names, 0, 0
        self._values: FloatArray = np.empty((_FIRST, len(FIELDS), len(names)))
        self._stamps: IntArray = np.empty((_FIRST, 2), dtype=np.int64)
        self._orders: dict[tuple[str, ...], IntArray] = {}

    def add(self, names: tuple[str, ...], stamps: tuple[int, int], values: list[FloatArray]) -> None:
        """One message; a field that it leaves empty is nan."""
        if self.size == len(self._stamps):
            self._values = np.concatenate([self._values, np.empty_like(self._values)])
            self._stamps = np.concatenate([self._stamps, np.empty_like(self._stamps)])
        row = self._values[self.size]
        order = self._orders.get(names)
        if order is None:
            order = np.array([names.index(name) for name in self.names])
            self._orders[names] = order
        self.reordered += names != self.names
        for part, given in zip(row, values, strict=True):
            part[:] = given[order] if given.size else np.nan
        self._stamps[self.size] = stamps
        self.size += 1

    def columns(self) -> tuple[dict[str, FloatArray], list[str]]:
        """Times in s and the values, and what is said of the times."""
        header, received = self._stamps[: self.size].T
        forward = self.size > 1 and bool(np.all(np.diff(header) >= 0)) and header[-1] > header[0]
        stamps = header if forward else received
        said = "Times are those of the headers."
        if not forward:
            why = "do not change" if self.size and np.all(header == header[:1]) else "go back"
            said = f"Times are those of receiving: the stamps of the headers {why}."
        notes = [said]
        if self.reordered:
            notes.append(f"Joints change their order in {self.reordered} of {self.size} messages: followed by name.")
        t = (stamps - stamps[0]).astype(np.float64) * 1e-9 if self.size else np.empty(0)
        columns = {"t": t}
        for k, kind in enumerate(FIELDS):
            for j, name in enumerate(self.names):
                values = self._values[: self.size, k, j]
                if not np.all(np.isnan(values)):
                    columns[f"{kind} {name}"] = values
        return columns, notes


class Topic:
    """The messages of one topic, by the joints they speak of. where : what a message calls it."""

    def __init__(self, where: str) -> None:
        self._where, self._count, self._unnamed = where, 0, False
        self._sets: dict[frozenset[str], Joints] = {}
        self._last: tuple[tuple[str, ...], Joints] | None = None
        self._layout: Layout | None = None

    def add_alike(self, received: int, data: bytes) -> bool:
        """One message whose bytes are laid out as those of the one before; False where they are not."""
        found = None if self._layout is None else self._layout.read(data)
        if found is None or self._last is None:
            return False
        (seconds, rest), values = found
        self._count += 1
        self._last[1].add(self._last[0], (seconds * 10**9 + rest, received), values)
        return True

    def add(self, received: int, message: Any, data: bytes, old: bool) -> None:
        """One sensor_msgs/JointState, received at this time in ns, from these bytes (``old``: of ROS 1).

        Raises InputError for one that makes no sense.
        """
        self._count += 1
        names, values = tuple(message.name), [getattr(message, kind) for kind in FIELDS]
        if not names and values[0].size:
            names, self._unnamed = tuple(f"joint{k + 1}" for k in range(values[0].size)), True
        for kind, given in zip(FIELDS, values, strict=True):
            if given.size not in (0, len(names)):
                found = f"{given.size} values of {kind} for {len(names)} joints"
                raise InputError(f"{self._where}: message {self._count}", found, "a value for each joint is accepted")
        if self._last is None or self._last[0] != names:
            if len(set(names)) < len(names):
                twice = next(name for name in names if names.count(name) > 1)
                where = f"{self._where}: message {self._count}"
                raise InputError(where, f"the joint {twice} twice", "names that differ are accepted")
            self._last = names, self._sets.setdefault(frozenset(names), Joints(names))
        stamp = message.header.stamp
        self._layout = layout_of(data, message.header.frame_id, message.name, values, old)
        self._last[1].add(names, (stamp.sec * 10**9 + stamp.nanosec, received), values)

    def found(self) -> Found:
        """Each set of joints, the one with most values first; their columns are numbered."""
        ordered = sorted(self._sets.values(), key=lambda joints: -joints.size * len(joints.names))
        columns: dict[str, FloatArray] = {}
        about = []
        for number, joints in enumerate(ordered):
            held, notes = joints.columns()
            columns |= {f"{number} {key}": values for key, values in held.items()}
            about.append(
                {"joints": list(joints.names), "count": joints.size, "notes": notes, "numbered": self._unnamed}
            )
        return columns, about


TYPE = "sensor_msgs/msg/JointState"
ACCEPTED = "a whole ROS bag (.bag, .db3, .mcap, or a folder of a ROS 2 bag) is accepted"


def need_rosbags(path: Path) -> None:
    """Raise InputError, that says what to install, where the package is missing that reads bags."""
    if find_spec("rosbags") is None:
        found = "a ROS bag, and the package rosbags that reads it is not installed"
        raise InputError(str(path), found, "pip install 'friction-harness[bags]' makes it accepted")


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
        for reader in readers:
            for connection in reader.connections:
                key = connection.topic, connection.msgtype
                counts[key] = counts.get(key, 0) + connection.msgcount
        return {}, [[topic, kind, count] for (topic, kind), count in counts.items()]


def columns_of(path: Path, topic: str) -> Found:
    """Every message of a topic of joint states: columns and what was said, for each set of joints."""
    from rosbags.typesys import Stores, get_typestore

    found = Topic(f"{path}: {topic}")
    with _opened(path) as readers:
        old = path.suffix == ".bag"
        store = get_typestore(Stores.ROS1_NOETIC if old else Stores.ROS2_HUMBLE)
        read: Callable[[bytes, str], Any] = store.deserialize_ros1 if old else store.deserialize_cdr
        for reader in readers:
            connections = [c for c in reader.connections if c.topic == topic and c.msgtype == TYPE]
            for _, received, data in reader.messages(connections) if connections else ():
                if not found.add_alike(received, data):
                    found.add(received, read(data, TYPE), data, old)
    return found.found()


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
