"""Oscilloscopes: Tektronix, whose settings stand beside the first rows, and Rigol, which tells a step and no times."""

from collections.abc import Sequence

from harness.io.layout import Head, Layout, rate_of

_BESIDE = 3
"""Columns of settings before time and value."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    if lines and lines[0].startswith("Record Length,"):
        return _tektronix(lines)
    if len(lines) > 2 and lines[0].startswith(("X,CH", "CH")) and ",Start,Increment" in lines[0]:
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
