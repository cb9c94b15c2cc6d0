"""ROS bags: sensor_msgs/JointState of ROS 1 (.bag), ROS 2 (sqlite3, MCAP, a folder of either), message by message.

What runs here runs in a process of its own (harness.core.apart), but for ``need_rosbags``. The type is known, so that
whatever other types a bag defines is not looked at.
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import Found
from harness.core.errors import InputError
from harness.io.logs.messages import Topic
from harness.io.registry import BAGS

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
