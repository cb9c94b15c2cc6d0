"""Oscilloscopes: Tektronix, whose settings stand beside the first rows, and Rigol, which tells a step and no times."""

from collections.abc import Sequence

from harness.io.layout import Head, Layout, rate_of

_BESIDE = 3
"""Columns of settings before time and value."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    if lines and lines[0].startswith("Record Length,"):
        return _tektronix(lines)
    if len(lines) > 2 and lines[0].startswith("X,CH"):
        return _rigol(lines)
    return None


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
    fields, units = (line.rstrip(",").split(",") for line in lines[:2])
    count = sum(field.startswith("CH") for field in fields)
    if len(units) < count + 3 or "Increment" not in fields:
        return None
    step = rate_of(units[fields.index("Increment")])
    names = ("sample", *fields[1 : count + 1], *[""] * (len(lines[2].split(",")) - count - 1))
    found = ("", *("V" if "volt" in unit.lower() else unit for unit in units[1 : count + 1]))
    return Head(first=2, fields=names, units=found, separator=",", rate=None if step is None else 1.0 / step)


LAYOUT = Layout(name="oscilloscope", find=_find)
