"""What a log of a robot's joints holds: harness log."""

from pathlib import Path

from harness.io.logs.finish import Gain
from harness.io.logs.raw import LogOptions
from harness.io.logs.read import TopicInfo, describe_log
from harness.io.logs.read import read_joint_log as read
from harness.results.robot import LogResult, Topic

__all__ = ["LogOptions", "log", "read"]


def log(path: Path, options: LogOptions | None = None, gain: Gain | None = None) -> LogResult:
    """Every topic of a log, with its joints, fields, rate and gaps. Raises InputError for a file that holds none.

    options : how it is read. gain : N m per A, one or by joint.
    """
    found = describe_log(path, options or LogOptions(), gain)
    return LogResult(file=str(path.absolute()), topics=[_topic(topic) for topic in found])


def _topic(found: TopicInfo) -> Topic:
    return Topic(
        name=found.name,
        type=found.kind,
        count=found.count,
        rate_hz=found.rate_hz,
        joints=list(found.joints),
        fields=list(found.fields),
        units_guessed={str(kind): unit for kind, unit in found.units.items()},
        gaps_s=[list(gap) for gap in found.gaps_s],
        ranges={joint: {kind: list(r) for kind, r in of.items()} for joint, of in found.ranges.items()},
        notes=list(found.notes),
    )
