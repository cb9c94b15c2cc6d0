"""Oscilloscopes: Tektronix, whose settings stand beside the first rows, or, as Siglent's, above them; Rigol, which
tells a step and no times; Keysight, whose names are numbers; LeCroy, whose Ampl is in V.
"""

from collections.abc import Sequence

from harness.io.layout import Head, Layout, is_row, rate_of

_BESIDE = 3
"""Columns of settings before time and value."""


_DEEP = 60
"""Lines of settings at most."""
_UNITS = "Vertical Units,"


def _find(lines: Sequence[str], name: str) -> Head | None:
    units = next((line for line in lines[:_DEEP] if line.startswith(_UNITS)), "")
    if units and (head := _below_settings(lines, units)) is not None:
        return head
    if lines and lines[0].startswith("LECROY") and "Time,Ampl" in (above := [line.strip() for line in lines[:_DEEP]]):
        return Head(first=above.index("Time,Ampl") + 1, fields=("time", "Ampl"), units=("s", "V"), separator=",")
    if len(lines) > 2 and lines[0].startswith("x-axis,") and lines[1].startswith("second,"):
        return _keysight(lines)
    if lines and lines[0].startswith("Record Length,"):
        return _tektronix(lines)
    if len(lines) > 2 and lines[0].startswith(("X,CH", "CH")) and ",Start,Increment" in lines[0]:
        return _rigol(lines)
    return None


def _below_settings(lines: Sequence[str], said: str) -> Head | None:
    rows = [line.rstrip(" \r").split(",") for line in lines]
    first = next((i for i, row in enumerate(rows) if all(map(str.strip, row)) and is_row(row)), 0)
    fields = [field.strip() for field in rows[first - 1]]
    if not first or len(fields) != len(rows[first]) or len(fields) < 2 or not all(fields):
        return None
    units = [unit.rpartition(":")[2].strip() for unit in said.rstrip(" \r,").split(",")[1:]]
    of_rest = (units + units[-1:] * len(fields))[: len(fields) - 1]
    return Head(first=first, fields=("time", *fields[1:]), units=("s", *of_rest), separator=",")


def _keysight(lines: Sequence[str]) -> Head | None:
    fields, units = (line.rstrip(" \r").split(",")[1:] for line in lines[:2])
    if len(fields) != len(units) or not fields:
        return None
    short = ["V" if unit.lower() == "volt" else unit for unit in units]
    return Head(first=2, fields=("time", *(f"CH{one}" for one in fields)), units=("s", *short), separator=",")


def _tektronix(lines: Sequence[str]) -> Head | None:
    said = {line.partition(",")[0]: line.split(",")[1:] for line in lines[:20]}
    more = len(lines[0].rstrip(",").split(",")) - _BESIDE - 1
    unit = said.get("Vertical Units", ["V"])[0].strip() or "V"
    if more < 1:
        return None

    def plain(line: str) -> str:
        return ",".join(line.split(",")[_BESIDE : _BESIDE + 1 + more])

    fields = ("time", *(f"CH{i + 1}" for i in range(more)))
    return Head(first=0, fields=fields, units=("s", *[unit] * more), separator=",", plain=plain)


def _rigol(lines: Sequence[str]) -> Head | None:
    fields, said = (line.rstrip(",").split(",") for line in lines[:2])
    step, count = rate_of(said[-1]), fields.index("Start")
    if len(said) != len(fields) or step is None:
        return None
    names = ["sample" if one == "X" else one for one in fields[:count]]
    units = ["V" if "volt" in unit.lower() else unit for unit in said[:count]]
    units = ["" if name == "sample" else unit for name, unit in zip(names, units, strict=True)]
    more = [""] * (len(lines[2].split(",")) - count)
    return Head(first=2, fields=(*names, *more), units=tuple(units), separator=",", rate=1.0 / step)


LAYOUT = Layout(name="oscilloscope", find=_find)
