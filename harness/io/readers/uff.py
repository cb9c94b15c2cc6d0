"""Universal files of modal analysis (.uff, .unv): time responses, data set 58 in ASCII."""

import re
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.bounded import read_bytes
from harness.core.errors import InputError
from harness.io.reader import Reader
from harness.io.table import ArrayTable, on_one_clock
from harness.io.units import is_unit

_ACCEPTED = "time responses, data set 58 in ASCII"
_HEADER = 11
"""Lines of a data set before its numbers."""
_TIME = "1"
"""The kind of function that is a time response."""
_KINDS = {"8": "displacement", "11": "velocity", "12": "acceleration", "9": "force", "13": "force"}
"""What is measured, by its number in the format."""
_WIDTHS = {("2", True): (13,), ("4", True): (20,), ("2", False): (13, 13), ("4", False): (13, 20)}
"""Characters of each number, by precision and whether samples are even: else a time stands before each."""


def _data_sets(lines: Sequence[str]) -> Iterator[list[str]]:
    """The lines of each data set 58, its number left out."""
    marks = [i for i, line in enumerate(lines) if line.strip() == "-1"]
    for begin, end in pairwise(marks):
        if end - begin > _HEADER + 2 and lines[begin + 1].strip() == "58":
            yield list(lines[begin + 2 : end])


def _numbers(lines: Sequence[str], widths: tuple[int, ...]) -> FloatArray:
    """The numbers (n,) of lines of so many characters each, one behind the other without blanks."""
    found = []
    for line in lines:
        at, k = 0, 0
        while at < len(line.rstrip()):
            width = widths[k % len(widths)]
            found.append(float(line[at : at + width].replace("D", "E")))
            at, k = at + width, k + 1
    return np.array(found, dtype=np.float64)


def _signal(lines: Sequence[str]) -> tuple[str, FloatArray, FloatArray]:
    """Name with its unit, times (n,), s, and values (n,) of a data set. Raises ValueError for what is none."""
    precision, count, even, *_ = lines[6].split()
    start, step = (float(lines[6][at : at + 13]) for at in (30, 43))
    numbers = _numbers(lines[_HEADER:], _WIDTHS[precision, even == "1"])
    y = numbers if even == "1" else numbers[1::2]
    t: FloatArray = start + step * np.arange(y.size, dtype=np.float64) if even == "1" else numbers[::2]
    if y.size != int(count):
        raise ValueError(f"{y.size} of {count} values")
    kind, said = lines[8].split()[0], lines[8][46:67].strip()
    # an entity's name, node and direction
    place = re.sub(r"\W+", " ", lines[5][31:55].replace("NONE", "")).strip()
    return f"{_KINDS.get(kind, 'signal')} {place}".strip() + (f" [{said}]" if is_unit(said) and said else ""), t, y


def open_uff(path: Path, skip_rows: int = 0) -> ArrayTable:
    """Open a universal file. Raises InputError where it holds no time response in ASCII.

    skip_rows : none, it says itself where its numbers begin.
    """
    lines = read_bytes(path).decode("latin-1").splitlines()
    signals = {}
    for number, one in enumerate(_data_sets(lines), 1):
        if one[5].split()[:1] != [_TIME]:
            continue
        try:
            name, t, y = _signal(one)
        except (ValueError, KeyError, IndexError) as error:
            raise InputError(f"{path}: data set {number}", f"damaged ({error})", _ACCEPTED) from None
        signals[name if name not in signals else f"{name} #{number}"] = t, y
    if not signals:
        raise InputError(str(path), "no time response", _ACCEPTED)
    return on_one_clock(path, signals)


UFF = Reader(name="universal files", suffixes=(".uff", ".unv"), open=open_uff, text=True)
