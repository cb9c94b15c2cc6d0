"""harness log."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import json_option, quiet_option
from harness.cli.output import check_json, emit_json, say, shows_tables
from harness.cli.tables import show
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.log import LogResult, Topic

_MOST = 20
"""Topics that a table for people shows; --json has all of them."""
_NAMED = 8
"""Joints that are listed by name."""


@click.command(short_help="What a log of a robot's joints holds: topics, joints, rates, what is odd.")
@click.argument("file", type=click.Path(path_type=Path))
@json_option
@quiet_option
def command(file: Path, json_to: str | None, quiet: bool) -> int:
    """What FILE, a log of a robot's joints, holds: topics, joints, fields, units, rate, gaps, and what is odd about it.

    Formats: CSV (also .gz), Parquet, MATLAB .mat, .npz, plain text tables; a LeRobot data set (its folder or a file of
    it); bags of ROS 1 (.bag) and ROS 2 (.db3, .mcap, a folder) with sensor_msgs/JointState, by the extra bags.

    \b
    Example: harness log trajectory.db3
             harness log joints.csv --json -
    """
    check_json(json_to)
    if not file.exists():
        raise InputError(str(file), "no such file", "a file or folder that can be read is accepted")
    from harness.app.log.log import log

    result = log(file)
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
    return 0


def _print(result: "LogResult") -> None:
    from rich.table import Table

    table = Table()
    for heading in ("topic", "type", "count", "Hz", "joints", "fields", "gaps"):
        table.add_column(heading, justify="right" if heading in ("count", "Hz", "joints", "gaps") else "left")
    for topic in result.topics[:_MOST]:
        rate = "-" if topic.rate_hz is None else f"{topic.rate_hz:.4g}"
        cells = (topic.type.rpartition("/")[2], str(topic.count), rate, str(len(topic.joints) or "-"))
        table.add_row(topic.name, *cells, "\n".join(_fields(topic)) or "-", str(len(topic.gaps_s) or "-"))
    show(table)
    if len(result.topics) > _MOST:
        say(f"and {len(result.topics) - _MOST} more; --json has all of them")
    for topic in result.topics[:_MOST]:
        before = f"{topic.name}: " if len(result.topics) > 1 else ""
        if topic.joints and topic == next(t for t in result.topics if t.joints == topic.joints):
            more = f" and {len(topic.joints) - _NAMED} more" if len(topic.joints) > _NAMED else ""
            say(f"{before}joints {', '.join(topic.joints[:_NAMED])}{more}")
        for note in topic.notes:
            say(f"- {before}{note}")


def _fields(topic: "Topic") -> list[str]:
    """Fields with the units they are read in."""
    called = {"magnitude": "|effort|"}
    return [f"{called.get(field, field)} {topic.units_guessed.get(field, '')}".strip() for field in topic.fields]
