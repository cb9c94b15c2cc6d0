"""What a log of a robot's joints holds: harness log."""

from pathlib import Path

from harness.io.logs.finish import Gain
from harness.io.logs.raw import LogOptions
from harness.io.logs.read import describe_log
from harness.io.logs.read import read_joint_log as read
from harness.results.robot import LogResult, Topic

__all__ = ["LogOptions", "log", "read"]


def log(path: Path, options: LogOptions | None = None, gain: Gain | None = None) -> LogResult:
    """Every topic of a log, with its joints, fields, rate and gaps. Raises InputError for a file that holds none.

    options : how it is read. gain : N m per A, one or by joint.
    """
    topics = []
    for one in describe_log(path, options or LogOptions(), gain):
        units = {str(kind): unit for kind, unit in one.units.items()}
        topics.append(Topic.taken_from(one, type=one.kind, units_guessed=units))
    return LogResult(file=str(path.absolute()), topics=topics)
