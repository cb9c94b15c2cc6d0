"""harness log."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.diagnosis_tables import say_motion
from harness.cli.options import PATH, json_options, log_options
from harness.cli.output import Output, figure, say, say_all, say_as_it_is, show_rows
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.robot import LogResult, PreviewResult, Topic

_MOST = 20
"""Topics that a table for people shows; --json has all of them."""
_COUNTED = {"table": "rows", "episode": "rows"}
_CALLED = {"magnitude": "|effort|"}


@click.command(short_help="What a recording or a log of a robot's joints holds, as it was read.")
@click.argument("file", type=PATH)
@log_options
@click.option("--page", type=PATH, metavar="FILE", help="Write a page that plots a recording.")
@json_options
def command(file: Path, reading: dict[str, Any], page: Path | None, to: Output) -> int:
    """What FILE holds, before anything is fitted: a recording's channels as they were read, with a picture of each, or
    a log's topics, joints, fields, units, rate and gaps; and what is odd about it.

    Formats: those of a recording (harness identify --help); a LeRobot data set (its folder or a file of
    it); bags of ROS 1 (.bag) and ROS 2 (.db3, .mcap, a folder) with sensor_msgs/JointState, by the extra bags.

    \b
    Example: harness log swing.csv --page swing.html
             harness log trajectory.db3
             harness log ur5e.csv --gain 12.5
             harness log arm.csv --json - \\
                 --columns "t=clock[ms],elbow.position=enc3[deg]"
    """
    if not file.exists():
        raise InputError(str(file), "no such file", "a file or folder that can be read")
    from harness.app.log import LogOptions, log

    gain = reading.pop("gain")
    to.give(log(file, LogOptions(**reading), gain, page), _print)
    return 0


def _print(result: "LogResult") -> None:
    if result.recording is not None and not any(len(topic.joints) > 1 for topic in result.topics):
        _recording(result.recording)
    elif result.topics:
        _log(result)
        if result.recording is not None and result.recording.notes:
            say(f"- Without --robot, as one motion: {result.recording.notes[0]}")


_ROWS, _DOTS = 4, 4
"""Lines of a picture, and dots of a letter of Braille from top to bottom."""


def _recording(found: "PreviewResult") -> None:
    steady = found.motion.kind == "friction-curve"
    if steady:
        low, high = found.ranges["v"]
        say(f"{found.samples} steady speeds from {low:.4g} to {high:.4g} {found.units['v']}")
    else:
        say(f"{found.samples} samples at {found.rate_hz:.4g} Hz, {found.duration_s:.4g} s")
    say_motion(found.motion)
    rows = []
    for name, unit in found.units.items():
        if steady and name == "t":
            continue
        first = ", ".join(f"{value:.9g}" if name == "t" else f"{value:.6g}" for value in found.first[name])
        rows.append([f"{name} / {unit}", first, found.columns.get(name, "by --rate")])
    show_rows(("channel", "first samples", "read from"), rows, ("channel", "first samples", "read from"))
    for name, spans in found.envelope.items():
        if steady and name == "v":
            continue
        low, high = found.ranges[name]
        over = ", row by row in the order of the speeds" if steady else ""
        say(f"{name} from {low:.4g} to {high:.4g} {found.units[name]}{over}")
        for line in picture(spans, low, high):
            say_as_it_is(line)
    for note in found.notes:
        say(f"- {note}")


def picture(spans: list[list[float]], low: float, high: float) -> list[str]:
    """Spans [least, largest] from left to right as lines of Braille, two to a letter."""
    dots, scale = _ROWS * _DOTS, (_ROWS * _DOTS - 1) / (high - low or 1.0)
    bits = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))
    letters = [[0] * ((len(spans) + 1) // 2) for _ in range(_ROWS)]
    for k, (least, largest) in enumerate(spans):
        top, bottom = (dots - 1 - round((value - low) * scale) for value in (largest, least))
        for dot in range(top, bottom + 1):
            letters[dot // _DOTS][k // 2] |= bits[k % 2][dot % _DOTS]
    return ["".join(chr(0x2800 + letter) for letter in line) for line in letters]


def _log(result: "LogResult") -> None:
    (only,) = result.topics if len(result.topics) == 1 else (None,)
    if only is None:
        _topics(result.topics)
    else:
        rate = "" if only.rate_hz is None else f" at {only.rate_hz:.4g} Hz"
        say(f"{only.name}: {only.count} {_COUNTED.get(only.type, 'messages')}{rate}, {_gaps(only)}")
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
