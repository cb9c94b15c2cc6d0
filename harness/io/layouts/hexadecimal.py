"""Tables whose counts stand as registers do, ``0x0633``."""

import re
from collections.abc import Sequence

from harness.io.layout import Head, Layout

_CELL = re.compile(r"(?<![\w.])0[xX]([0-9a-fA-F]{1,16})(?!\w)")
_MOST, _LEAST = 0.8, 5
"""Share of the lines that are so, and of how many at least."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    said = [line for line in lines if line.strip()]
    found = sum(bool(_CELL.search(line)) for line in said)
    return Head(plain=_plain) if found >= max(_MOST * len(said), _LEAST) else None


def _plain(line: str) -> str:
    return _CELL.sub(lambda cell: str(int(cell[1], 16)), line)


LAYOUT = Layout(name="hexadecimal", find=_find)
