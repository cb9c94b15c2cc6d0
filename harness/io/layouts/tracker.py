"""Tracker (video): the name of what was tracked, then t, x, y and what was derived; which axis moves is not said."""

import re
from collections.abc import Sequence

from harness.io.layout import Head, Layout, separator_of


def _find(lines: Sequence[str], name: str) -> Head | None:
    if len(lines) < 3 or not re.match(r"^[^\W\d][\w .-]{0,60}[\s,;]*$", lines[0]):
        return None
    separator, decimal = separator_of([lines[1], lines[2].strip()])
    fields = [cell.strip() for cell in (lines[1].split(separator) if separator else lines[1].split())]
    if fields[:1] != ["t"] or not {"x", "y"} & set(fields):
        return None
    return Head(first=2, fields=tuple(fields), separator=separator, decimal=decimal, own=False)


LAYOUT = Layout(name="Tracker", find=_find)
