"""What a board's port leaves: the monitor's ``14:03:11.120 -> 40.0``, the plotter's ``t_ms:0 pos_mm:40``, and what
people print, ``t=120 ms, angle=4.2 deg``; behind a logger's stamp, ``I (120) imu: 4.2``, ``[ 0.120] pos=4.2``.
"""

import re
from collections.abc import Sequence

from harness.io.layout import NUMBER, Head, Layout, separator_of

_STAMPED = re.compile(
    r"^(?:(?P<stamp>\d\d?:\d\d:\d\d[.,]\d{1,6}) -> ?"
    r"|[VDIWE] \((?P<ms>\d{1,12})\) (?:[\w.-]{1,40}: ?)?"
    r"|\[ {0,11}(?:(?P<count>\d{1,12})|(?P<s>\d{1,9}\.\d{1,9}))\] ?"
    r"|\[?(?P<date>(?:\d{4}-\d\d-\d\d[ T])?\d\d:\d\d:\d\d[.,]\d{3}(?:,?\d{3})?)\]? (?:- )?)(?P<rest>.*)$"
)
"""Before a line: the monitor's time of day, ESP-IDF's level and ms, a kernel's count of ms or s, a logger's date."""
_TAGS = re.compile(
    r"^(?:[\[<(]?(?:[A-Z]{4,8}|inf|dbg|wrn|err)[\])>]?[:,]?\s+(?:- )?(?:[\w.]{1,40}: (?!\S+ [^\W\d_]\S{0,7}$))?)?"
)
"""What loggers put between the stamp and the text: INFO enc:, <inf> main:; what stands before one number with its unit
is its name."""
_LABELLED = re.compile(
    r"([^\W\d][\w.-]*)\s*[:=]\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)(?:\s*([^\W\d_][\w/^]{0,6}|°)(?![\w.-]*\s*[:=]))?(?=[\s,;]|$)"
)
_MOST, _LEAST = 0.8, 5
"""Share of the lines that are so, and of how many at least."""


def _parted(line: str) -> tuple[str, str, str] | None:
    """The stamp of a line, its unit, "" for a time of day, and what stands behind it; None where there is none."""
    found = _STAMPED.match(line.strip())
    if found is None:
        return None
    rest = _TAGS.sub("", found["rest"].strip(), count=1)
    for name, unit in (("ms", "ms"), ("count", "ms"), ("s", "s")):
        if found[name]:
            return found[name], unit, rest
    stamp = found["stamp"] or found["date"]
    whole, mark, parts = stamp.rpartition(".") if "." in stamp else stamp.rpartition(",")
    return f"{whole}.{parts.replace(',', '')}" if mark else stamp, "", rest


def _monitor(lines: Sequence[str], name: str) -> Head | None:
    rests = [found[2] for line in lines if (found := _parted(line))]
    said = [line for line in lines if line.strip()]
    if len(rests) < max(_MOST * len(said), _LEAST):
        return None
    mark = separator_of(rests[-_LEAST:])[0] or " "
    width = len(rests[-1].split(mark))
    if any(_LABELLED.search(rest) for rest in rests[-_LEAST:]):
        return None

    def plain(line: str) -> str:
        found = _parted(line)
        if found is None:
            return line
        stamp, unit, rest = found
        cells = rest.split(mark)
        if len(cells) != width:
            return rest
        stamp = stamp if NUMBER.match(cells[0].strip()) else f"stamp_{unit}" if unit else "stamp"
        return mark.join([stamp, *cells])

    return Head(plain=plain)


def _plotter(lines: Sequence[str], name: str) -> Head | None:
    stamps = [_parted(line) for line in lines]
    stamped = sum(map(bool, stamps)) >= _MOST * len(lines)
    parts = [
        _LABELLED.findall(found[2] if stamped and found else line) for line, found in zip(lines, stamps, strict=True)
    ]
    labels = [tuple(label for label, _, _ in found) for found in parts]
    usual = max(set(labels), key=labels.count, default=())
    said = [line for line in lines if line.strip()]
    if not usual or labels.count(usual) < max(_MOST * len(said), _LEAST):
        return None

    def plain(line: str) -> str:
        before = _parted(line) if stamped else None
        found = _LABELLED.findall(before[2] if before else line)
        whole = tuple(label for label, _, _ in found) == usual
        values = [value for _, value, _ in (found if whole else found[:-1])]
        return ";".join([before[0], *values] if before else values)

    first = labels.index(usual)
    units = tuple(unit for _, _, unit in parts[first])
    begun = stamps[first]
    if not stamped or begun is None:
        return Head(first=first, fields=usual, units=units, separator=";", plain=plain)
    return Head(first=first, fields=("stamp", *usual), units=(begun[1], *units), separator=";", plain=plain)


MONITOR = Layout(name="Arduino's monitor", find=_monitor)
PLOTTER = Layout(name="Arduino's plotter", find=_plotter)
