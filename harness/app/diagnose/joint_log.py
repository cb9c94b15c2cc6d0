"""The log of a robot's joints that a diagnosis is of."""

from collections.abc import Sequence
from pathlib import Path

from harness.app.diagnose.robot_options import RobotOptions
from harness.core.errors import InputError
from harness.core.robot.joint_log import JointLog
from harness.io.logs.read import read_joint_log
from harness.io.options import ReadOptions


def read_log(path: Path, joints: Sequence[str], asked: RobotOptions, reading: ReadOptions) -> JointLog:
    """Read a log; joints : those of the model, in its order. Raises InputError naming what is wrong, and where."""
    gain = asked.gain
    if isinstance(gain, tuple):
        if len(gain) != len(joints):
            found = f"{len(gain)} numbers, and the model has {len(joints)} joints"
            raise InputError("--gain", found, f"one each of {', '.join(joints)}, or NAME=NUMBER,... is accepted")
        gain = dict(zip(joints, gain, strict=True))
    return read_joint_log(
        path,
        columns=reading.columns,
        joints=joints,
        gain=gain,
        angle_unit=asked.angle_unit,
        names=asked.names,
        flip=asked.flip,
        offset=asked.offset,
        skip_rows=reading.skip_rows,
        rate=reading.rate,
        start=reading.start,
        stop=reading.stop,
        drop_nan=reading.drop_nan,
    )
