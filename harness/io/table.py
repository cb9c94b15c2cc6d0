"""A file seen as named columns, read only where somebody asks."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.columns import quoted
from harness.io.units import split_header

MOST_KEPT = 10_000_000
"""Numbers of a table that are kept while it is understood: 80 MB."""


class Table(ABC):
    """Named columns of one file.

    path : the file. names : of the columns in order, units split off, "" where a column has no name.
    units : unit text of columns whose header carries one, by position. headers : as they stand in the file.
    dated : of columns read that are dates or times of day, by position: the first, from which they are counted in s.
    mended : what was left out of the file so that it could be read, one sentence each. rate : Hz, where the file says
    its step and holds no times; said_rate : where a line above the numbers says it. own : whether columns called x, v,
    a are what this program calls so.
    """

    def __init__(
        self, path: Path, names: Sequence[str], units: Mapping[int, str], headers: Sequence[str] | None = None
    ) -> None:
        self.path, self.names, self.units = path, tuple(names), dict(units)
        self.headers = tuple(names if headers is None else headers)
        self.dated: dict[int, str] = {}
        self.mended: list[str] = []
        self.rate: float | None = None
        self.said_rate: float | None = None
        self.own = True
        self._kept: dict[int, FloatArray] = {}

    @abstractmethod
    def read(self, positions: Sequence[int]) -> list[FloatArray]:
        """The columns at these positions (from 0) as float64 vectors; nan where a cell is empty.

        Raises InputError naming row and column where a cell is not a number.
        """

    def columns(self, positions: Sequence[int]) -> list[FloatArray]:
        """As ``read``; what was read before, of a table that is not large, is not read again."""
        if -1 in positions:
            others = self.columns([*(i for i in positions if i >= 0), 0])
            rows = np.arange(others[0].size, dtype=np.float64)
            return [rows if i < 0 else others.pop(0) for i in positions]
        new = [i for i in dict.fromkeys(positions) if i not in self._kept]
        found = self._kept | dict(zip(new, self.read(new) if new else (), strict=True))
        if sum(values.size for values in found.values()) <= MOST_KEPT:
            self._kept = found
        return [found[i] for i in positions]

    def row(self, index: int) -> str:
        """How sample ``index`` (from 0) is called in a message."""
        return f"row {index + 1}"

    def texts(self, positions: Sequence[int]) -> list[str]:
        """What cells of these columns say in every row, "" of one that does not say the same in the first and the last,
        or of a format without text."""
        return [""] * len(positions)

    def position(self, name: str) -> int:
        """Position of a column by its name or as ``#N`` (from 1); of ``#0``, which counts the rows, it is -1.

        Raises InputError listing the columns there are.
        """
        if name.startswith("#"):
            number = int(name[1:])
            if number > len(self.names):
                accepted = f"#1 to #{len(self.names)}"
                raise InputError(f"{self.path}: column {name}", "no such column", accepted)
            return number - 1
        at = [i for i, existing in enumerate(self.names) if existing == name]
        at = at or [i for i, existing in enumerate(self.headers) if existing.strip() == name]
        if not at:
            raise InputError(f"{self.path}: column {name}", "no such column", f"{self.listed()}")
        if len(at) > 1:
            accepted = f"one of {', '.join(f'#{i + 1}' for i in at)}"
            raise InputError(f"{self.path}: column {name}", f"{len(at)} columns of this name", accepted)
        return at[0]

    def quoted(self, position: int) -> str:
        """A column as --columns takes it, by its name where no other has it."""
        name = self.headers[position] if position >= 0 else ""
        return quoted(name if self.headers.count(name) == 1 else "", position)

    def listed(self) -> str:
        """The columns there are, for a message."""
        shown = [name or f"#{i + 1}" for i, name in enumerate(self.names)]
        return ", ".join(shown[:20]) + (", ..." if len(shown) > 20 else "")


@dataclass(frozen=True, slots=True)
class Held:
    """An array that a file holds: its shape and type, and how its numbers are read when they are needed."""

    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    load: Callable[[], Any]


def held(value: object) -> Held:
    """An array that is in memory already."""
    array = np.asarray(value)
    return Held(array.shape, array.dtype, lambda: array)


class ArrayTable(Table):
    """Columns of arrays (.npz, .mat); a column of one value is a constant."""

    def __init__(self, path: Path, columns: Mapping[str, tuple[Held, int | None]], units: Mapping[int, str]) -> None:
        super().__init__(path, list(columns), units)
        self._columns = list(columns.values())

    def read(self, positions: Sequence[int]) -> list[FloatArray]:
        """See Table."""
        found = []
        for source, part in (self._columns[i] for i in positions):
            array = np.asarray(source.load())
            found.append(np.ascontiguousarray(array.ravel() if part is None else array[:, part], np.float64))
        return found


def table_of_arrays(path: Path, arrays: Mapping[str, Held]) -> ArrayTable:
    """Make a table of numeric arrays by name; a matrix becomes one column for each of its columns.

    Vectors of shape (n,), (n, 1) and (1, n) are columns, and where one is as long as the rows of a matrix, and none as
    its columns, the matrix lies on its side; anything that is not numeric is left out.
    Raises InputError when nothing is left.
    """
    columns: dict[str, tuple[Held, int | None]] = {}
    lengths = {max(one.shape) for one in arrays.values() if one.shape and math.prod(one.shape) == max(one.shape) > 1}
    units: dict[int, str] = {}
    for header, given in arrays.items():
        source, shape = given, given.shape
        if source.dtype.kind not in "fiub" or 0 in shape or len(shape) > 2:
            continue
        name, unit = split_header(header)
        if len(shape) == 2 and shape[1] in lengths and shape[0] not in lengths:
            shape = shape[::-1]
            source = Held(shape, given.dtype, lambda given=given: np.asarray(given.load()).T)  # type: ignore[misc]
        parts = [None] if len(shape) < 2 or 1 in shape else list(range(shape[1]))
        for number, part in enumerate(parts, 1):
            if unit is not None:
                units[len(columns)] = unit
            label = name if len(parts) == 1 else f"{name}.{number}"
            columns[label if label not in columns else f"{label}#{len(columns) + 1}"] = source, part
    if not columns:
        raise InputError(str(path), "no numeric array in it", "vectors t and one or more of x, v, a, u")
    return ArrayTable(path, columns, units)


def on_one_clock(path: Path, signals: Mapping[str, tuple[FloatArray, FloatArray]]) -> ArrayTable:
    """A table of signals, each with its times (n,), s, and values (n,): at the times of the one that has most of them.

    The others lie on the lines between their own samples, nan where they have none yet or no longer.
    Raises InputError where there is no signal.
    """
    if not signals:
        raise InputError(str(path), "no signal of numbers in it", "a position, a speed or an acceleration")
    t = max((times for times, _ in signals.values()), key=len)
    columns = {"time [s]": held(t)}
    for name, (times, values) in signals.items():
        same = times.size == t.size and bool(np.all(times == t))
        columns[name] = held(values if same else np.interp(t, times, values, np.nan, np.nan))
    table = table_of_arrays(path, columns)
    if any(times.size != t.size or np.any(times != t) for times, _ in signals.values()):
        table.mended.append("Signals with times of their own are read at those of the one that has most samples.")
    return table
