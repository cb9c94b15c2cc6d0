"""What FitCSVTool makes of the .fit of a watch or a bicycle's computer: in each line a message, its fields as name,
value and unit one after another. The message that most lines hold, ``record``, is the table.
"""

import csv
from collections import Counter
from collections.abc import Mapping, Sequence

from harness.io.layout import Head, Layout

_BEGINS = ("type", "local number", "message", "field 1", "value 1", "units 1")
_KIND, _MESSAGE, _FIRST = 0, 2, 3
_SINCE_1970 = 631_065_600
"""s from 1970 to the end of 1989, from which stamps of the format count."""
_STAMP = "timestamp"


def _find(lines: Sequence[str], name: str) -> Head | None:
    if not lines or tuple(cell.strip(' "').lower() for cell in lines[0].split(",")[: len(_BEGINS)]) != _BEGINS:
        return None
    rows = [(i, cells) for i, line in enumerate(lines) if (cells := _cells(line))[:1] == ["Data"]]
    counted = Counter(cells[_MESSAGE] for _, cells in rows if len(cells) > _FIRST)
    if not counted:
        return None
    message = counted.most_common(1)[0][0]
    own = [(i, _fields(cells)) for i, cells in rows if cells[_MESSAGE : _MESSAGE + 1] == [message]]
    units = {field: unit for _, fields in own for field, (_, unit) in fields.items()}

    def plain(line: str) -> str:
        cells = _cells(line)
        if cells[:1] != ["Data"] or cells[_MESSAGE : _MESSAGE + 1] != [message]:
            return ""
        fields = _fields(cells)
        return ";".join(fields[field][0] if field in fields else "" for field in units)

    said = tuple("" if unit == "semicircles" else unit for unit in units.values())
    return Head(first=own[0][0], fields=tuple(units), units=said, separator=";", plain=plain)


def _cells(line: str) -> list[str]:
    return next(csv.reader([line[: csv.field_size_limit()]]), [])


def _fields(cells: Sequence[str]) -> Mapping[str, tuple[str, str]]:
    """Value and unit of each field of a message; stamps count from 1970."""
    groups = zip(cells[_FIRST::3], cells[_FIRST + 1 :: 3], cells[_FIRST + 2 :: 3], strict=False)
    found = {field: (value, unit) for field, value, unit in groups if field}
    stamp, unit = found.get(_STAMP, ("", ""))
    return found | ({_STAMP: (str(int(stamp) + _SINCE_1970), unit)} if stamp.isdigit() else {})


LAYOUT = Layout(name="FitCSVTool", find=_find)
