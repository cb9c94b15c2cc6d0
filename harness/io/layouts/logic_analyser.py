"""A logic analyser's export of one line: a row for each edge. A pulse is its rising edge, and the rows are those."""

from collections.abc import Sequence
from itertools import pairwise

from harness.io.layout import Head, Layout

_LEAST = 10
"""Edges from which a line is known."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    rows = [line.split(",") for line in lines[1:] if line.strip()]
    if len(rows) < _LEAST or not lines[0].lower().startswith("time") or {len(row) for row in rows} != {2}:
        return None
    levels = [row[1].strip() for row in rows]
    if set(levels) != {"0", "1"} or any(one == other for one, other in pairwise(levels)):
        return None
    # the first row says the level at the start, which is no edge
    return Head(first=2, fields=(lines[0].split(",")[0],), separator=";", plain=_rising)


def _rising(line: str) -> str:
    time, _, level = line.partition(",")
    return time if level.strip() == "1" else ""


LAYOUT = Layout(name="logic analyser", find=_find)
