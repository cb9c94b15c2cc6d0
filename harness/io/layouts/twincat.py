"""TwinCAT Scope's text export: names of channels behind ``Name``, units behind ``Unit``, settings, a time before each
value.
"""

from collections.abc import Sequence

from harness.io.layout import Head, Layout, is_row, separator_of
from harness.io.units import is_unit

_DEEP = 40
"""Lines of a header at most."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    if not any(line.startswith("SampleTime[ms]") for line in lines[:_DEEP]):
        return None
    mark = "\t" if "\t" in lines[0] else ";" if ";" in lines[0] else ","
    heads = [line.split(mark) for line in lines[:_DEEP] if line.startswith(f"Name{mark}")]
    first = next((i for i, line in enumerate(lines) if is_row(line.split(mark))), None)
    if first is None or not heads:
        return None
    named = [cell.strip() for cell in heads[-1][1:] if cell.strip() not in ("", "Name")]
    fields = [field for one in named for field in ("time", one)]
    said = next((line.split(mark)[1:] for line in lines[:_DEEP] if line.startswith(f"Unit{mark}")), [])
    of_each = [unit if is_unit(unit) else "" for cell in said if (unit := cell.strip()) not in ("", "Unit")]
    of_each = of_each if len(of_each) == len(named) else [""] * len(named)
    units = [unit for one in of_each for unit in ("ms", one)]
    return Head(
        first=first,
        fields=tuple(fields),
        units=tuple(units),
        separator=mark,
        decimal=separator_of(["", lines[first]])[1],
    )


LAYOUT = Layout(name="TwinCAT Scope", find=_find)
