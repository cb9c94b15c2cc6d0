"""Frames of a CAN bus as can-utils' candump writes them, into a file (``(1.005) can0 181#33060000``) or on the screen
(``(1.005)  can0  181   [4]  33 06 00 00``). Nobody says what their bytes are: each pair and each four are a column,
with the low byte first (``int16_0``) and with the high one (``int16be_0``), by the byte at which they begin.
"""

import re
from collections import Counter
from collections.abc import Sequence

from harness.io.layout import Head, Layout

_FRAME = re.compile(
    r"^\s{0,9}(?:\((?P<t>[\d:. -]{1,40})\)\s{1,9})?[a-z]{1,9}\d{1,3}\s{1,9}(?:(?:[RT]X|-)\s{1,9}){0,9}"
    r"(?P<id>[0-9A-F]{3,8})(?:#(?P<data>(?:[0-9A-F]{2}){1,8})"
    r"|\s{1,9}\[\d{1,2}\]\s{1,9}(?P<bytes>[0-9A-F]{2}(?: [0-9A-F]{2}){0,63}))(?!\S)"
)
_MOST, _LEAST = 0.8, 5
"""Share of the lines that are so, and of how many at least."""
_SIZES, _ORDERS = (2, 4), (("", False), ("be", True))
"""Bytes of a number, and the order in which they stand, by name and whether the high one is first."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    frames = [_FRAME.match(line) for line in lines if line.strip()]
    found = [frame for frame in frames if frame]
    if len(found) < max(_MOST * len(frames), _LEAST):
        return None
    bytes_of = {one: {_bytes(frame) for frame in found if frame["id"] == one} for one in {f["id"] for f in found}}
    count = Counter(frame["id"] for frame in found)
    # what stays is a status
    ident = min(bytes_of, key=lambda one: (len(bytes_of[one]) < _LEAST, -count[one], one))
    size = Counter(map(len, bytes_of[ident])).most_common(1)[0][0]
    timed = next(frame for frame in found if frame["id"] == ident)["t"] is not None
    places = [
        (width, begin, high) for _, high in _ORDERS for width in _SIZES for begin in range(0, size - width + 1, width)
    ]
    names = {high: name for name, high in _ORDERS}

    def plain(line: str) -> str:
        frame = _FRAME.match(line)
        if frame is None or frame["id"] != ident or len(data := _bytes(frame)) != size:
            return ""
        numbers = [_number(data[begin : begin + width], high) for width, begin, high in places]
        return ";".join([*([frame["t"]] if timed else []), *map(str, numbers)])

    others = ", ".join(sorted(one for one in bytes_of if one != ident))
    said = (
        f"Frames of {ident} are read, and not those of {others}: grep leaves those of one in a file." if others else ""
    )
    fields = tuple(f"int{8 * width}{names[high]}_{begin}" for width, begin, high in places)
    clock = ("t",) if timed else ()
    units = ("s",) * timed + ("",) * len(fields)
    return Head(first=0, fields=(*clock, *fields), units=units, separator=";", plain=plain, said=said)


def _bytes(frame: "re.Match[str]") -> bytes:
    return bytes.fromhex(frame["data"] or frame["bytes"])


def _number(data: bytes, high: bool) -> int:
    return int.from_bytes(data, "big" if high else "little", signed=True)


LAYOUT = Layout(name="candump", find=_find)
