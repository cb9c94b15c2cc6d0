"""harness log."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.options import PATH, json_options, log_options
from harness.cli.output import Output, figure, say, say_all, show_rows
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.robot import LogResult, Topic

_MOST = 20
"""Topics that a table for people shows; --json has all of them."""
_ROWS = {"table": "rows", "episode": "rows"}
_CALLED = {"magnitude": "|effort|"}


@click.command(short_help="What a log of a robot's joints holds: topics, joints, rates, what is odd.")
@click.argument("file", type=PATH)
@log_options
@json_options
def command(file: Path, reading: dict[str, Any], to: Output) -> int:
    """What FILE, a log of a robot's joints, holds: topics, joints, fields, units, rate, gaps, and what is odd about it.

    Formats: CSV (also .gz), Parquet, MATLAB .mat, .npz, plain text tables; a LeRobot data set (its folder or a file of
    it); bags of ROS 1 (.bag) and ROS 2 (.db3, .mcap, a folder) with sensor_msgs/JointState, by the extra bags.

    \b
    Example: harness log trajectory.db3
             harness log ur5e.csv --gain 12.5
             harness log arm.csv --json - \\
                 --columns "t=clock[ms],elbow.position=enc3[deg]"
    """
    if not file.exists():
        raise InputError(str(file), "no such file", "a file or folder that can be read is accepted")
    from harness.app.log import LogOptions, log

    gain = reading.pop("gain")
    to.give(log(file, LogOptions(**reading), gain), _print)
    return 0


def _print(result: "LogResult") -> None:
    (only,) = result.topics if len(result.topics) == 1 else (None,)
    if only is None:
        _topics(result.topics)
    else:
        rate = "" if only.rate_hz is None else f" at {only.rate_hz:.4g} Hz"
        say(f"{only.name}: {only.count} {_ROWS.get(only.type, 'messages')}{rate}, {_gaps(only)}")
    for topic in (topic for topic in result.topics[:_MOST] if topic.notes or (topic is only and topic.ranges)):
        if only is None:
            say(f"{topic.name}:")
        if topic.ranges:
            _joints(topic)
        say_all(topic.notes)


def _topics(topics: "list[Topic]") -> None:
    rows = []
    for topic in topics[:_MOST]:
        rate = figure(topic.rate_hz)
        joints, gaps = str(len(topic.joints) or "-"), str(len(topic.gaps_s) or "-")
        rows.append([topic.name, topic.type.rpartition("/")[2], str(topic.count), rate, joints, gaps])
    show_rows(("topic", "type", "count", "Hz", "joints", "gaps"), rows, ("topic", "type"))
    if len(topics) > _MOST:
        say(f"and {len(topics) - _MOST} more; --json has all of them")


def _joints(topic: "Topic") -> None:
    """A row a joint: from where to where each of its fields goes."""
    fields = [field for field in topic.units_guessed if any(field in of for of in topic.ranges.values())]
    rows = []
    for joint in topic.joints:
        of = topic.ranges.get(joint, {})
        rows.append([joint, *(f"{of[f][0]:.3g} to {of[f][1]:.3g}" if f in of else "-" for f in fields)])
    show_rows(["joint", *(f"{_CALLED.get(field, field)}, {topic.units_guessed[field]}" for field in fields)], rows)


def _gaps(topic: "Topic") -> str:
    count = len(topic.gaps_s)
    return "no gaps" if not count else f"{count} gap{'s' if count > 1 else ''}"
