"""Tables in the long format, one value a row beside the name of its signal, as data bases give them, InfluxDB's among
them. The rows of one signal are read: that whose name says a motion, else that of most rows.
"""

from collections import Counter
from collections.abc import Sequence

from harness.io.columns import meaning, word_of
from harness.io.layout import NUMBER, Head, Layout

_WORDS = "signal _field field topic channel tag variable metric parameter measurement key series"
_NAMES = frozenset(_WORDS.split())
_VALUES = frozenset(("value", "_value", "val", "reading"))
_DEEP = 20
"""Lines above the rows at most."""
_LEAST = 5
"""Rows from which a table is known."""
_ORDER = ("x", "v", "a", "u")


def _find(lines: Sequence[str], name: str) -> Head | None:
    for at, line in enumerate(lines[:_DEEP]):
        mark = next((one for one in ("\t", ";", ",") if one in line), "")
        fields = [cell.strip(' "').lower() for cell in line.split(mark)] if mark else []
        named = next((i for i, field in enumerate(fields) if field in _NAMES), None)
        valued = next((i for i, field in enumerate(fields) if field in _VALUES), None)
        if named is not None and valued is not None:
            return _head(lines, at, mark, named, valued)
    return None


def _head(lines: Sequence[str], at: int, mark: str, named: int, valued: int) -> Head | None:
    fields = [cell.strip(' "\r') for cell in lines[at].split(mark)]
    rows = [[cell.strip(' "\r') for cell in line.split(mark)] for line in lines[at + 1 :] if line.strip()]
    rows = [row for row in rows if len(row) == len(fields)]
    counted = Counter(row[named] for row in rows)
    if len(rows) < _LEAST or any(NUMBER.match(signal) for signal in counted):
        return None
    signal = min(counted, key=lambda one: (_rank(one), -counted[one]))

    def plain(line: str) -> str:
        cells = line.split(mark)
        same = len(cells) != len(fields) or cells[named].strip(' "\r') == signal
        return line if same and not line.startswith("#") else ""

    others = ", ".join(one for one in counted if one != signal)
    said = f"Of the signals one below another, {signal} is read, and not {others}." if others else ""
    whole = tuple(signal if i == valued else "" if i == named else field for i, field in enumerate(fields))
    return Head(first=at + 1, fields=whole, separator=mark, plain=plain, said=said)


def _rank(signal: str) -> int:
    means = meaning(signal)
    channel = means.channel if means is not None else word_of(signal)
    return _ORDER.index(channel) if channel in _ORDER else len(_ORDER)


LAYOUT = Layout(name="long format", find=_find)
