"""What a board's port leaves: the monitor's ``14:03:11.120 -> 40.0``, the plotter's ``t_ms:0 pos_mm:40``, and what
people print, ``t=120 ms, angle=4.2 deg``.
"""

import re
from collections.abc import Sequence

from harness.io.layout import NUMBER, Head, Layout, separator_of

_STAMPED = re.compile(r"^(?P<stamp>\d\d?:\d\d:\d\d[.,]\d{1,6}) -> ?(?P<rest>.*)$")
_LABELLED = re.compile(
    r"([^\W\d][\w.-]*)\s*[:=]\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)(?:\s*([^\W\d_][\w/^]{0,6}|°)(?![\w.-]*\s*[:=]))?(?=[\s,;]|$)"
)
_MOST, _LEAST = 0.8, 5
"""Share of the lines that are so, and of how many at least."""


def _monitor(lines: Sequence[str], name: str) -> Head | None:
    rests = [found["rest"].strip() for line in lines if (found := _STAMPED.match(line.strip()))]
    said = [line for line in lines if line.strip()]
    if len(rests) < max(_MOST * len(said), _LEAST):
        return None
    mark = separator_of(rests[-_LEAST:])[0] or " "
    width = len(rests[-1].split(mark))

    def plain(line: str) -> str:
        found = _STAMPED.match(line.strip())
        if found is None:
            return line
        cells = found["rest"].strip().split(mark)
        if len(cells) != width:
            return found["rest"]
        stamp = found["stamp"].replace(",", ".") if NUMBER.match(cells[0].strip()) else "stamp"
        return mark.join([stamp, *cells])

    return Head(plain=plain)


def _plotter(lines: Sequence[str], name: str) -> Head | None:
    parts = [_LABELLED.findall(line) for line in lines]
    labels = [tuple(label for label, _, _ in found) for found in parts]
    usual = max(set(labels), key=labels.count, default=())
    said = [line for line in lines if line.strip()]
    if not usual or labels.count(usual) < max(_MOST * len(said), _LEAST):
        return None

    def plain(line: str) -> str:
        found = _LABELLED.findall(line)
        whole = tuple(label for label, _, _ in found) == usual
        return ";".join(value for _, value, _ in (found if whole else found[:-1]))

    first = labels.index(usual)
    units = tuple(unit for _, _, unit in parts[first])
    return Head(first=first, fields=usual, units=units, separator=";", plain=plain)


MONITOR = Layout(name="Arduino's monitor", find=_monitor)
PLOTTER = Layout(name="Arduino's plotter", find=_plotter)
