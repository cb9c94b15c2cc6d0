"""A log in several files, each with one signal of all joints: q.csv, dq.csv, tau.csv."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from harness.core.errors import InputError
from harness.io.logs.raw import named
from harness.io.logs.tables import time_of
from harness.io.registry import kind_of, reader_for
from harness.io.table import Held, Table, held, table_of_arrays

_ACCEPTED = "text tables called by what they hold, such as q.csv, dq.csv and tau.csv"


def joined(paths: Sequence[Path], skip_rows: int) -> Table:
    """One table of the columns of all; what a column does not say of itself its file's name does.

    Columns without names are the joints in their order, or those that another file names. A file with times of its own
    is read at those of the first that has some. Raises InputError for a file that cannot be read, that says nowhere
    what it is, or whose times are in another unit.
    """
    tables = [_opened(path, skip_rows) for path in paths]
    clocks = [_clock(table) for table in tables]
    own = [[i for i in range(len(table.names)) if i != at] for table, at in zip(tables, clocks, strict=True)]
    called = next(
        ([table.names[i] for i in some] for table, some in zip(tables, own, strict=True) if _joints(table, some)), []
    )
    header, t, columns, mended = "", np.zeros(0), dict[str, Held](), list[str]()
    for table, some, at in zip(tables, own, clocks, strict=True):
        values = table.read(some)
        if at is not None:
            (stamps,) = table.read([at])
            if not header:
                header, t = table.headers[at], stamps
            elif table.headers[at] != header:
                raise InputError(str(table.path), f"times in {table.headers[at]}, not {header}", "one")
            elif not np.array_equal(stamps, t):
                values = [np.interp(t, stamps, y, np.nan, np.nan) for y in values]
                mended.append(f"{table.path.name} has times of its own, and is read at those of the first file.")
        for name, y in zip(_names(table, some, called), values, strict=True):
            if name in columns:
                raise InputError(str(table.path), f"{name}, which another file has too", _ACCEPTED)
            columns[name] = held(y)
    found = table_of_arrays(tables[0].path, {header: held(t), **columns} if header else columns)
    found.mended += mended
    return found


def _clock(table: Table) -> int | None:
    """Which column has the times."""
    clock = time_of(table)[0]
    return None if clock is None else table.position(clock.names[0])


def _opened(path: Path, skip_rows: int) -> Table:
    reader = reader_for(path)
    if reader is None or not reader.text:
        raise InputError(f"--join {path}", f"the format {kind_of(path) or 'without a name'}", _ACCEPTED)
    return reader.open(path, skip_rows)


def _joints(table: Table, some: Sequence[int]) -> bool:
    """Whether columns are called by joints alone."""
    return bool(some) and all(table.names[i] and named(table.names[i]) is None for i in some)


def _names(table: Table, some: Sequence[int], called: Sequence[str]) -> list[str]:
    """Of columns, with what they hold."""
    found = [named(table.names[i]) if table.names[i] else None for i in some]
    if all(one is not None for one in found):
        return [table.headers[i] for i in some]
    stem = table.path.name.partition(".")[0]
    what = named(stem)
    if what is None:
        raise InputError(str(table.path), f"neither its columns nor its name {stem!r} say what it holds", _ACCEPTED)
    joints = [table.names[i] for i in some] if _joints(table, some) else called
    if len(joints) != len(some):
        return [f"{what.field}[{i}]" for i in range(len(some))]
    units = [f" [{table.units[i]}]" if i in table.units else "" for i in some]
    return [f"{joint}.{what.field}{unit}" for joint, unit in zip(joints, units, strict=True)]
