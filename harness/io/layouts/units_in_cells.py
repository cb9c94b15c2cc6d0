"""Tables whose cells carry their unit, ``1450 rpm``, as dashboards export them and MATLAB writes durations."""

import re
from collections.abc import Mapping, Sequence

from harness.io.layout import Head, Layout
from harness.io.units import is_unit, split_header

_CELL = re.compile(r'"?[+-]?\d{1,12}(?:[.,]\d{1,12})?(?:[eE][+-]?\d{1,3})?\s?(?P<unit>[^\d\s,;"][^\d,;"]{0,15})"?')
_LEAST = 5
"""Rows from which a table is known."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    rows = [(i, line) for i, line in enumerate(lines) if line.strip()]
    last = rows[-1][1] if rows else ""
    mark = next((one for one in ("\t", ";", ",") if one in last), "")
    cells = [(i, [cell.strip() for cell in line.split(mark)]) for i, line in rows] if mark else []
    units = _units([row for _, row in cells[-_LEAST:]])
    if not units:
        return None
    begin = next(k for k in range(len(cells)) if all(_carries(row, units) for _, row in cells[k:]))
    width, above = len(cells[-1][1]), cells[begin - 1][1] if begin else []
    if len(cells) - begin < _LEAST or len(above) != width or any(len(row) != width for _, row in cells[begin:]):
        return None

    def plain(line: str) -> str:
        parts = line.split(mark)
        if _carries([part.strip() for part in parts], units):
            parts = [part.strip(' "').removesuffix(units.get(i, "")).strip() for i, part in enumerate(parts)]
        return mark.join(parts)

    said = [split_header(field.strip('"')) for field in above]
    known = tuple(units.get(i) or unit or "" for i, (_, unit) in enumerate(said))
    commas = mark != "," and any("," in row[i] for _, row in cells[begin:] for i in units)
    fields = tuple(field for field, _ in said)
    first = cells[begin][0]
    return Head(first=first, fields=fields, units=known, separator=mark, decimal="," if commas else ".", plain=plain)


def _units(rows: Sequence[Sequence[str]]) -> dict[int, str]:
    """By column, the unit that every cell of these rows carries."""
    if len(rows) < _LEAST or len(set(map(len, rows))) > 1:
        return {}
    found = {i: {_CELL.fullmatch(row[i]) for row in rows} for i in range(len(rows[0]))}
    units = {i: {one["unit"] if one else "" for one in cells} for i, cells in found.items()}
    return {i: unit for i, of in units.items() if len(of) == 1 and (unit := next(iter(of))) and is_unit(unit)}


def _carries(row: Sequence[str], units: Mapping[int, str]) -> bool:
    cells = {i: _CELL.fullmatch(row[i]) if i < len(row) else None for i in units}
    return all(cell is not None and cell["unit"] == units[i] for i, cell in cells.items())


LAYOUT = Layout(name="units in cells", find=_find)
