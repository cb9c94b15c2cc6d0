"""What a .rrd of ours holds, read in a process of its own: nothing here imports rerun."""

import os
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple, final

from harness.core.apart import read_apart
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.show.pack import recording_of, trajectory_of
from harness.show.shown import HELD, LEFT, MOTION, SWING

_PIECE = 1 << 20


@final
class Pipe:
    """The end to write to, by name; what comes out of the other end goes into a file.

    After an error the rest is taken and dropped, so that whoever writes is never kept waiting.
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._error: OSError | None = None
        self._out, self._in = os.pipe()
        self.name = f"/dev/fd/{self._in}"
        self._thread = threading.Thread(target=self._pour, daemon=True)
        self._thread.start()

    def opened(self) -> None:
        """Whoever writes has opened the pipe; it ends when they close it."""
        if self._in >= 0:
            os.close(self._in)
            self._in = -1

    def close(self) -> None:
        """Wait for the rest; raises the OSError that writing met with."""
        self.opened()
        self._thread.join()
        os.close(self._out)
        if self._error is not None:
            raise self._error

    def _pour(self) -> None:
        while piece := os.read(self._out, _PIECE):
            if self._error is None:
                try:
                    rest = memoryview(piece)
                    while rest:
                        rest = rest[self._file.write(rest) :]
                except OSError as error:
                    self._error = error


@contextmanager
def poured(path: Path) -> Iterator[Pipe]:
    """A pipe into the file ``path``; raises OSError at the end when it could not be written."""
    with path.open("wb", buffering=0) as file:
        pipe = Pipe(file)
        try:
            yield pipe
        except BaseException:
            with suppress(OSError):
                pipe.close()
            raise
        pipe.close()


ACCEPTED = "a whole .rrd written by this program is accepted"


class StoredTrace(NamedTuple):
    """What a .rrd of ours holds: trajectories (the first is the reference), named properties, recordings.

    robot : of a robot's joints, by the names of harness.show.shown.
    """

    trajectories: list[Trajectory]
    properties: dict[str, Any]
    recordings: list[Recording]
    robot: dict[str, list[Trajectory]]


def read_trace(path: Path) -> StoredTrace:
    """Trajectories and recordings, bit for bit as they were written, and the properties.

    Raises InputError when the file is missing, no .rrd, cut short, or not written by this program.
    """
    if not path.is_file():
        raise InputError(str(path), "no such file", "a .rrd written by this program is accepted")
    return stored_of(*read_apart("harness.show.trace:columns_of", path, ACCEPTED))


def stored_of(columns: Mapping[str, FloatArray], about: Mapping[str, Any]) -> StoredTrace:
    """The trace whose parts these are: columns as "NUMBER/NAME", and what is said of each part."""
    trajectories, recordings = [], []
    robot: dict[str, list[Trajectory]] = {kind: [] for kind in (LEFT, MOTION, HELD, SWING)}
    for number, part in enumerate(about["blobs"]):
        own = {name: columns[f"{number}/{name}"] for name in part["columns"]}
        if part["name"].startswith("trajectory"):
            trajectories.append(trajectory_of(own, part["about"]))
        elif part["name"].startswith("recording"):
            recordings.append(recording_of(own, part["about"]))
        elif (kind := part["name"].partition("-")[0]) in robot:
            robot[kind].append(trajectory_of(own, part["about"]))
    return StoredTrace(trajectories, about["properties"], recordings, robot)
