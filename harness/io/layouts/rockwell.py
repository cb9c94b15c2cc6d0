"""Rockwell's trends: settings, a line ``Header:`` of names, and rows that begin with ``Data``, a date and a time of day
whose ms stand behind a semicolon.
"""

import re
from collections.abc import Sequence

from harness.io.layout import Head, Layout

_ROW = re.compile(r"Data,([^,;]{1,20}),([\d:]{4,8})(?:;(\d{1,3}))?( [AP]M)?,(.*)")
_DEEP = 40
"""Lines of a header at most."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    at = next((i for i, line in enumerate(lines[:_DEEP]) if line.startswith("Header:,Date,Time,")), None)
    if at is None:
        return None
    tags = [cell.strip(' "') for cell in lines[at].split(",")[3:]]
    return Head(first=at + 1, fields=("time", *tags), separator=",", plain=_plain)


def _plain(line: str) -> str:
    found = _ROW.match(line.strip())
    if found is None:
        return line
    day, clock, ms, half, values = found.groups()
    return f"{day} {clock}.{(ms or '0').zfill(3)}{half or ''},{values}"


LAYOUT = Layout(name="Rockwell trend", find=_find)
