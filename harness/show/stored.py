"""What a .rrd of ours holds, read in a process of its own: nothing here imports rerun."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from harness.core.apart import read_apart
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.show.pack import recording_of, trajectory_of
from harness.show.robot.shown import HELD, LEFT, MOTION, SWING

ACCEPTED = "a whole .rrd written by this program is accepted"


class StoredTrace(NamedTuple):
    """What a .rrd of ours holds: trajectories (the first is the reference), named properties, recordings.

    robot : of a robot's joints, by the names of harness.show.robot.shown.
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
