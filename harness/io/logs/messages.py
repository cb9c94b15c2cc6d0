"""MCAP files of no ROS profile: messages in JSON, protobuf or CDR, each number a column by the names of its fields.

What runs here runs in a process of its own (harness.core.apart), but for ``is_plain`` and ``need_mcap``. What a schema
says is not needed to read JSON; of protobuf it is the file's own, of CDR the known type of joint states alone.
"""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import Found
from harness.core.errors import InputError
from harness.io.logs.bags import TYPE

ACCEPTED = "a whole MCAP file with messages in JSON, protobuf or ROS 2's JointState"
_MAGIC, _HEADER = b"\x89MCAP0\r\n", 1
_DEEPEST, _MOST = 8, 2000
"""Fields within fields, and numbers of a message, that are read."""
_NAMES = ("name", "names", "joint_names")
LOGGED = "logged"
"""The column of the times at which messages were logged, s."""
Numbers = dict[str, float]


def is_plain(path: Path) -> bool:
    """Whether a file is an MCAP that ROS has not written."""
    if path.suffix.lower() != ".mcap" or not path.is_file():
        return False
    with path.open("rb") as stream:
        begin = stream.read(len(_MAGIC) + 64)
    head = begin[len(_MAGIC) :]
    if not begin.startswith(_MAGIC) or len(head) < 13 or head[0] != _HEADER:
        return False
    size = int.from_bytes(head[9:13], "little")
    return head[13 : 13 + size] not in (b"ros1", b"ros2")


def need_mcap(path: Path) -> None:
    """Raise InputError, that says what to install, where a package is missing that reads such files."""
    if find_spec("mcap") is None or find_spec("mcap_protobuf") is None:
        found = "an MCAP file, and the packages mcap and mcap-protobuf-support that read it are not installed"
        raise InputError(str(path), found, "try: pip install 'friction-harness[bags]'")


def topics_of(path: Path) -> Found:
    """Name, schema and count of every topic, and the numbers of its first message by name."""
    found = []
    with _opened(path) as reader:
        summary = reader.get_summary()
        if summary is None:
            raise InputError(str(path), "no summary in it, so it was not closed", ACCEPTED)
        counts = summary.statistics.channel_message_counts if summary.statistics else {}
        for number, channel in summary.channels.items():
            schema = summary.schemas.get(channel.schema_id)
            first = next(_messages(reader, channel.topic), None)
            known = [] if first is None or isinstance(first[1], str) else list(first[1])
            found.append(
                [channel.topic, schema.name if schema else channel.message_encoding, counts.get(number, 0), known]
            )
    return {}, found


def columns_of(path: Path, topic: str) -> Found:
    """Every number of every message of a topic, nan where a message has not that one. Raises InputError."""
    times, rows = [], []
    with _opened(path) as reader:
        for stamp, numbers in _messages(reader, topic):
            if isinstance(numbers, str):
                raise InputError(f"{path}: {topic}", numbers, ACCEPTED)
            times.append(stamp)
            rows.append(numbers)
    names = list(dict.fromkeys(name for row in rows for name in row))
    columns = {name: np.array([row.get(name, np.nan) for row in rows]) for name in names}
    since = [stamp - times[0] for stamp in times]
    return {**columns, LOGGED: np.array(since, dtype=np.float64) * 1e-9}, names


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    from mcap.reader import make_reader

    try:
        with path.open("rb") as stream:
            yield make_reader(stream)
    except (InputError, MemoryError):
        raise
    except Exception as error:  # whatever damaged bytes lead the libraries to
        said = " ".join(str(error).split()) or type(error).__name__
        raise InputError(str(path), f"cannot be read as MCAP ({said})", ACCEPTED) from None


def _messages(reader: Any, topic: str) -> Iterator[tuple[int, Numbers | str]]:
    """Time of logging, ns, and numbers of each message, or why these cannot be had."""
    decoders: dict[int, Callable[[bytes], Any] | None] = {}
    for schema, channel, message in reader.iter_messages([topic]):
        if channel.id not in decoders:
            decoders[channel.id] = _decoder(schema, channel.message_encoding)
        decode = decoders[channel.id]
        numbers: Numbers | str = f"messages of {schema.name if schema else topic} in {channel.message_encoding}"
        if decode is not None:
            numbers = {}
            _gather(decode(message.data), "", numbers, 0)
        yield message.log_time, numbers


def _decoder(schema: Any, encoding: str) -> Callable[[bytes], Any] | None:
    """How a channel's bytes become fields; None where that is not known."""
    if encoding == "json":
        return json.loads
    if encoding == "protobuf":
        from google.protobuf.json_format import MessageToDict
        from mcap_protobuf.decoder import DecoderFactory

        read = DecoderFactory().decoder_for(encoding, schema)
        # numbers that are 0 are not written in protobuf
        told = {"preserving_proto_field_name": True, "always_print_fields_with_no_presence": True}
        return None if read is None else lambda data: MessageToDict(read(data), **told)
    if encoding == "cdr" and schema is not None and schema.name == TYPE:
        from rosbags.typesys import Stores, get_typestore

        store = get_typestore(Stores.ROS2_HUMBLE)

        def state(data: bytes) -> Any:
            message: Any = store.deserialize_cdr(data, TYPE)
            fields = {kind: list(getattr(message, kind)) for kind in ("position", "velocity", "effort")}
            stamp = {"sec": message.header.stamp.sec, "nanosec": message.header.stamp.nanosec}
            return {"stamp": stamp, "name": list(message.name), **fields}

        return state
    return None


def _gather(told: Any, where: str, found: Numbers, depth: int) -> None:
    """Numbers of a message by the path of their fields; what has a name is called by it."""
    if depth > _DEEPEST or len(found) >= _MOST:
        return
    if isinstance(told, Mapping):
        seconds = _seconds(told)
        if seconds is not None:
            found[where or "stamp"] = seconds
            return
        names: list[str] = next((told[key] for key in _NAMES if _texts(told.get(key))), [])
        for key, value in told.items():
            if names and isinstance(value, list) and len(value) == len(names) and not _texts(value):
                for name, one in zip(names, value, strict=True):
                    _gather(one, f"{name}.{key}", found, depth + 1)
            else:
                _gather(value, f"{where}.{key}" if where else str(key), found, depth + 1)
    elif isinstance(told, list):
        for number, one in enumerate(told):
            called = one.get("name") if isinstance(one, Mapping) else None
            _gather(one, called if isinstance(called, str) and called else f"{where}[{number}]", found, depth + 1)
    elif isinstance(told, bool | int | float):
        found[where] = float(told)
    elif isinstance(told, str) and where.rpartition(".")[2] in ("timestamp", "stamp", "time"):
        _stamp(told, where, found)


def _stamp(told: str, where: str, found: Numbers) -> None:
    """A time as protobuf's JSON has it, or in ns as a text, s."""
    try:
        found[where] = (
            float(told) * 1e-9 if told.isdigit() else np.datetime64(told.rstrip("Z"), "ns").astype(int) * 1e-9
        )
    except ValueError:
        return


def _texts(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(one, str) for one in value)


def _seconds(told: Mapping[Any, Any]) -> float | None:
    """A stamp of seconds and ns."""
    rest = next((told[key] for key in ("nsec", "nanosec", "nanos") if key in told), None)
    whole = told.get("sec", told.get("seconds", told.get("secs")))
    if len(told) != 2 or rest is None or whole is None:
        return None
    return float(whole) + 1e-9 * float(rest)
