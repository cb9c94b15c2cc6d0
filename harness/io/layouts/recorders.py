"""Recorders: Yokogawa's text (settings in quotes, then one trace) and Graphtec's (settings, lines of names and units,
a clock of seconds beside one of ms that begins again), which tell their rate.
"""

from collections.abc import Sequence

from harness.io.layout import Head, Layout, rate_of

_DEEP = 60
"""Lines of a header at most."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    if lines and lines[0].startswith('"Header Size"'):
        return _yokogawa(lines)
    if lines and lines[0].startswith("Vendor,GRAPHTEC"):
        return _graphtec(lines)
    return None


def _yokogawa(lines: Sequence[str]) -> Head | None:
    cells = [[cell.strip(' "') for cell in line.split(",")] for line in lines[:_DEEP]]
    said = {one[0]: one[1:] for one in cells if len(one) > 1 and one[0]}
    first = next((i for i, line in enumerate(lines) if line.startswith(",")), None)
    rate, traces = rate_of(said.get("SampleRate", [""])[0]), [one for one in said.get("TraceName", []) if one]
    if first is None or rate is None or not traces:
        return None
    units = (*said.get("VUnit", []), *[""] * len(traces))[: len(traces)]
    return Head(first=first, fields=("", *traces), units=("", *units), separator=",", rate=rate)


def _graphtec(lines: Sequence[str]) -> Head | None:
    said = {line.partition(",")[0]: line.partition(",")[2] for line in lines[:_DEEP]}
    at = next((i for i, line in enumerate(lines) if line.startswith("Number,")), None)
    step = said.get("Sampling interval", "")
    apart = rate_of(step)
    if at is None or at + 2 >= len(lines) or apart is None:
        return None
    clock = ("Number", "Date&Time", "ms")
    fields = ["" if one in clock else one for one in lines[at].split(",")]
    units = ["" if not field else unit for field, unit in zip(fields, lines[at + 1].split(","), strict=False)]
    scale = next((scale for unit, scale in (("us", 1e6), ("ms", 1e3)) if step.endswith(unit)), 1.0)
    return Head(first=at + 2, fields=tuple(fields), units=tuple(units), separator=",", rate=scale / apart)


LAYOUT = Layout(name="recorders", find=_find)
