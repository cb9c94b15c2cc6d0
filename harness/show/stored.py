"""What a .rrd of ours holds, read in a process of its own: nothing here imports rerun.

And what is shown of a robot besides a diagnosis, which a trace keeps too.
"""

import os
import threading
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from harness.core.apart import read_apart
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.robot import Bodies
from harness.core.trajectory import Source, Trajectory
from harness.show.pack import recording_of, trajectory_of

Left = Mapping[str, NDArray[np.float64]]
"""By joint: t, q, v, torque left by the base and by the model, and torque beyond the rigid model as the file has it and
as it was corrected, (m, 7)."""
BEFORE, AFTER = "#e4632d", "#2b7fd6"
BEFORE_NAME, AFTER_NAME = "viscous and Coulomb", "with the terms found"
LEFT, MOTION, HELD, SWING = "left", "motion", "held", "swing"
"""Of what a trace keeps under these names."""
LIFTED, SPUN = "lifted", "spun"
"""Of a body of a scene, beside how it slid: m, rad."""
_MEANS = 48
_BEFORE, _AFTER, _INSIDE = "before", "after", "inside"
_TORQUES = (_BEFORE, _AFTER, "raw", "friction")


@dataclass(frozen=True, slots=True)
class Motion:
    """A joint in an engine, driven by its log's torque.

    t (m,) : s. logged, before, after (m,) : rad or m, as logged, by the model's file and by the copy; nan between
    windows.
    """

    engine: str
    t: FloatArray
    logged: FloatArray
    before: FloatArray
    after: FloatArray


@dataclass(frozen=True, slots=True)
class Shown:
    """left : torque that is left of joints. motions : one an engine. bodies : the robot, None where a page is made
    again of a trace, which shows it."""

    left: Left
    motions: tuple[Motion, ...] = ()
    bodies: Bodies | None = None


def binned(rows: NDArray[np.float64], column: int) -> FloatArray:
    """Means of the rows over stretches of one column that hold equally many, by it."""
    ordered = rows[np.argsort(rows[:, column])]
    return np.array([part.mean(axis=0) for part in np.array_split(ordered, min(_MEANS, len(rows)))])


def moved_in(unit: str) -> str:
    """Unit of the position of a joint whose torque has this one: N m of a hinge, N of a slide."""
    return "rad" if "m" in unit else "m"


def parts_of(shown: Shown) -> dict[str, list[Trajectory]]:
    """As a trace keeps it: one motion a joint or an engine, named after it."""
    left = []
    for joint, rows in shown.left.items():
        t, q, v, *torques = rows.T
        extra = dict(zip(_TORQUES, torques, strict=True))
        left.append(Trajectory(t, q, v, np.zeros_like(t), Source(joint), extra=extra))
    motions = []
    for motion in shown.motions:
        inside = np.isfinite(motion.before) & np.isfinite(motion.after)
        extra = {name: np.where(inside, y, 0.0) for name, y in ((_BEFORE, motion.before), (_AFTER, motion.after))}
        extra[_INSIDE] = inside.astype(np.float64)
        still = np.zeros_like(motion.t)
        motions.append(Trajectory(motion.t, motion.logged, still, still, Source(motion.engine), extra=extra))
    return {LEFT: left, MOTION: motions}


def unpacked(left: Iterable[Trajectory], motions: Iterable[Trajectory]) -> Shown:
    """What ``parts_of`` was given. Raises LookupError for what is something else."""
    rows = {
        one.source.name: np.column_stack((one.t, one.x, one.v, *(one.extra[name] for name in _TORQUES))) for one in left
    }
    found = []
    for one in motions:
        before, after = (np.where(one.extra[_INSIDE] > 0.0, one.extra[n], np.nan) for n in (_BEFORE, _AFTER))
        found.append(Motion(one.source.name, one.t, one.x, before, after))
    return Shown(rows, tuple(found))


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


ACCEPTED = "a whole .rrd written by this program"


class StoredTrace(NamedTuple):
    """What a .rrd of ours holds: trajectories (the first is the reference), named properties, recordings.

    robot : of a robot's joints, by the names of harness.show.stored.
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
        raise InputError(str(path), "no such file", "a .rrd written by this program")
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
