"""LabVIEW measurement files (.lvm): a header of the file, one of the segment, names, rows; a step in place of times.

Also a waveform saved as text: ``waveform``, ``t0``, ``delta t``, names, rows of a date and a value.
"""

from collections.abc import Sequence

from harness.io.layout import Head, Layout, rate_of

_END = "***End_of_Header***"


def _find(lines: Sequence[str], name: str) -> Head | None:
    if lines and lines[0].startswith("waveform"):
        return _waveform(lines)
    if not lines or not lines[0].startswith("LabVIEW Measurement"):
        return None
    separator = "," if any(line.split() == ["Separator", "Comma"] for line in lines) else "\t"
    said = {cells[0]: cells[1:] for line in lines if len(cells := line.split(separator)) > 1}
    at = max((i for i, line in enumerate(lines) if line.startswith(_END)), default=len(lines)) + 1
    if at + 1 >= len(lines):
        return None
    rows = [line.split(separator) for line in lines[at + 1 :] if line.strip()]
    width = min(map(len, rows[:3]), default=0)
    units = ["s", *said.get("Y_Unit_Label", ())][:width]
    times = bool(rows) and bool(rows[0][0].strip())
    return Head(
        first=at + 1,
        fields=tuple(lines[at].split(separator))[:width],
        units=tuple(units + [""] * (width - len(units))),
        separator=separator,
        decimal=said.get("Decimal_Separator", ["."])[0] or ".",
        rate=None if times else _rate(said.get("Delta_X", ())),
    )


def _waveform(lines: Sequence[str]) -> Head | None:
    said = {line.partition("\t")[0]: line.partition("\t")[2] for line in lines[:8]}
    at = next((i for i, line in enumerate(lines) if line.startswith("time")), None)
    if at is None or at + 1 >= len(lines):
        return None
    value = lines[at + 1].rpartition("\t")[2]
    decimal = "," if "," in value else "."
    fields = tuple(lines[at].split("\t"))
    return Head(first=at + 1, fields=fields, decimal=decimal, rate=_rate([said.get("delta t", "")]))


def _rate(steps: Sequence[str]) -> float | None:
    step = rate_of(steps[0]) if steps else None
    return None if step is None else 1.0 / step


LAYOUT = Layout(name="LabVIEW", find=_find)
