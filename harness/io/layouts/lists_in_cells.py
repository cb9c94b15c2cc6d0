"""Tables whose cells hold lists, ``"[0.1, 0.2]"`` or ``"(0.1, 0.2)"``, as a frame of messages is written: each number
becomes a column, position[0] and so on.
"""

import csv
import re
from collections.abc import Sequence

from harness.io.layout import NUMBER, Head, Layout
from harness.io.units import split_header

_LIST = re.compile(r"\s*[\[(](?P<inside>[^\[\]()]*)[\])]\s*")
_MOST = 64
"""Numbers of a list at most."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    rows = [line for line in lines if line.strip()]
    if len(rows) < 2 or not any(mark in rows[1] for mark in ('"[', '"(')):
        return None
    fields, first = _cells(rows[0]), _cells(rows[1])
    sizes = [len(found) if (found := _numbers(cell)) is not None else 0 for cell in first]
    if len(fields) != len(first) or not 0 < max(sizes) <= _MOST:
        return None

    def plain(line: str) -> str:
        cells = _cells(line)
        if len(cells) != len(sizes):
            return line
        parts: list[str] = []
        for cell, size in zip(cells, sizes, strict=True):
            found = _numbers(cell) if size else None
            parts += [*(found or []), *[""] * size][:size] if size else [cell.replace(";", " ")]
        return ";".join(parts)

    names: list[str] = []
    units: list[str] = []
    for field, size in zip(fields, sizes, strict=True):
        bare, unit = split_header(field)
        names += [f"{bare}[{i}]" for i in range(size)] if size else [bare]
        units += [unit or ""] * max(size, 1)
    return Head(first=lines.index(rows[1]), fields=tuple(names), units=tuple(units), separator=";", plain=plain)


def _cells(line: str) -> list[str]:
    return next(csv.reader([line[: csv.field_size_limit()].rstrip("\r")]), [])


def _numbers(cell: str) -> list[str] | None:
    """The numbers of a list; None for what is none."""
    found = _LIST.fullmatch(cell)
    parts = re.split(r"[,\s]+", found["inside"].strip(" ,")) if found else []
    return parts if parts and all(map(NUMBER.match, parts)) else None


LAYOUT = Layout(name="lists in cells", find=_find)
