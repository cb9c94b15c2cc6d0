"""The log of a robot's joints that a diagnosis is of."""

from collections.abc import Sequence
from pathlib import Path

from harness.core.robot.joint_log import JointLog
from harness.io.logs.read import read_joint_log
from harness.io.recording import ReadOptions


def read_log(path: Path, joints: Sequence[str], gain: float | None, reading: ReadOptions) -> JointLog:
    """Read a log; joints : those of the model, in its order. Raises InputError naming what is wrong, and where."""
    return read_joint_log(
        path,
        columns=reading.columns,
        joints=joints,
        gain=gain,
        skip_rows=reading.skip_rows,
        rate=reading.rate,
        start=reading.start,
        stop=reading.stop,
        drop_nan=reading.drop_nan,
    )
