"""A file of any accepted format as a validated core Recording."""

import hashlib
from collections import abc
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import Found, read_apart
from harness.core.arrays import FloatArray
from harness.core.bounded import MOST_BYTES, check_size
from harness.core.checks import finite, positive
from harness.core.errors import InputError
from harness.core.recording import LARGEST, LONGEST_TIME, MINIMUM_SAMPLES, Recording
from harness.io.columns import Mapping, parse_columns
from harness.io.registry import formats, reader_of
from harness.io.sampling import sampling_notes
from harness.io.table import Table
from harness.io.units import Unit, parse_unit

_FORCE_NAMES = ("u", "F")


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """How to read a recording.

    columns : the text of --columns. skip_rows : lines before the header. rate : Hz, where no column gives the time.
    start, stop : s, the part to keep (--from, --to).
    """

    columns: str | None = None
    skip_rows: int = 0
    rate: float | None = None
    start: float | None = None
    stop: float | None = None

    def __post_init__(self) -> None:
        if self.skip_rows < 0:
            raise InputError("--skip-rows", f"{self.skip_rows}", "0 or more is accepted")
        if self.rate is not None:
            positive("--rate", self.rate, "Hz")
        for name, value in (("--from", self.start), ("--to", self.stop)):
            if value is not None:
                finite(name, value)
        if self.start is not None and self.stop is not None and self.stop <= self.start:
            raise InputError("--to", f"{self.stop:g} s, not after --from {self.start:g} s", "a later time is accepted")


RrdReader = Callable[[Path], Recording]
"""Reads our own .rrd; passed in, since this room does not know the viewer's library."""


def sha256(path: Path) -> str:
    """The hash of a file, in hex."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _kind(path: Path) -> str:
    """The suffix that says the format."""
    suffixes = [s.lower() for s in path.suffixes]
    if suffixes and suffixes[-1] == ".gz":
        suffixes.pop()
    return suffixes[-1] if suffixes else ""


def _open(path: Path, options: ReadOptions) -> Table:
    kind = _kind(path)
    reader = reader_of(kind)
    if reader is not None and reader.text:
        return reader.open(path, options.skip_rows)
    if options.skip_rows:
        raise InputError("--skip-rows", f"given for the {kind} file {path}", "it is accepted for text tables alone")
    if reader is None:
        raise InputError(str(path), f"the format {kind or 'without a name'}", f"{formats()} are accepted")
    return reader.open(path)


def _mappings(table: Table, options: ReadOptions) -> dict[str, Mapping]:
    """Which columns to read for which channel."""
    if options.columns is not None:
        mappings = parse_columns(options.columns)
        if "t" not in mappings and options.rate is None and "t" in table.names:
            mappings["t"] = Mapping("t", ("t",))
    else:
        mappings = {name: Mapping(name, (name,)) for name in ("t", "x", "v", "a") if name in table.names}
        forces = [name for name in _FORCE_NAMES if name in table.names]
        if forces:
            mappings["u"] = Mapping("u", (forces[0],))
    if not set(mappings) & {"x", "v", "a"}:
        hint = "t and one or more of x, v, a, or others named by --columns, are accepted"
        raise InputError(str(table.path), f"the columns {table.listed()}", hint)
    if "t" not in mappings and options.rate is None:
        raise InputError(
            str(table.path), f"no time among the columns {table.listed()}", "a column t or --rate HZ is accepted"
        )
    if "t" in mappings and options.rate is not None:
        accepted = "one of the two is accepted (--columns without t leaves the column out)"
        raise InputError("--rate", f"given although a column of {table.path} gives the time", accepted)
    return mappings


def _unit(table: Table, mapping: Mapping, positions: Sequence[int], constants: Sequence[bool]) -> Unit:
    """The unit of a mapping: its own, else that of its one column."""
    if mapping.unit is not None:
        return parse_unit(f"--columns, channel {mapping.channel}", mapping.channel, mapping.unit)
    moving = [i for i, constant in zip(positions, constants, strict=True) if not constant]
    header = table.units.get(moving[0]) if len(moving) == 1 and not any(constants) else None
    return parse_unit(f"{table.path}: column {'*'.join(mapping.names)}", mapping.channel, header)


def _channels(table: Table, mappings: dict[str, Mapping]) -> dict[str, tuple[FloatArray, Unit]]:
    """The values of every channel in SI, and the unit they came in; the file is read once."""
    at = {name: table.position(name) for mapping in mappings.values() for name in mapping.names}
    positions = sorted(set(at.values()))
    columns = dict(zip(positions, table.read(positions), strict=True))
    return {channel: _channel(table, mapping, at, columns) for channel, mapping in mappings.items()}


def _channel(
    table: Table, mapping: Mapping, at: dict[str, int], read: dict[int, FloatArray]
) -> tuple[FloatArray, Unit]:
    positions = [at[name] for name in mapping.names]
    columns = [read[i] for i in positions]
    constants = [column.size == 1 for column in columns]
    unit = _unit(table, mapping, positions, constants)
    factor = mapping.factor * unit.factor
    values = columns[0]
    with np.errstate(over="ignore", invalid="ignore"):  # what becomes of it is looked at when the rows are checked
        for column in columns[1:]:
            if column.size not in (1, values.size) and values.size != 1:
                found = f"columns of {values.size} and {column.size} values"
                where = f"{table.path}: channel {mapping.channel}"
                raise InputError(where, found, "columns of one length are accepted")
            values = values * column
        return (values if factor == 1.0 else values * factor), unit


def _check_rows(table: Table, channel: str, values: FloatArray, first: int) -> None:
    largest = LONGEST_TIME if channel == "t" else LARGEST
    bad = np.flatnonzero(~(np.abs(values) <= largest))  # that of nan is not
    if bad.size:
        value = values[bad[0]]
        where = f"{table.path}: {table.row(first + int(bad[0]))}, column {channel}"
        found = "no value or nan" if np.isnan(value) else f"{value:g}"
        accepted = f"at most {largest:g} in size is accepted" if np.isfinite(value) else "a finite number is accepted"
        raise InputError(where, found, accepted)


def _times(table: Table, values: FloatArray) -> None:
    _check_rows(table, "t", values, 0)
    back = np.flatnonzero(np.diff(values) <= 0.0)
    if back.size:
        i = int(back[0]) + 1
        found = f"time {values[i]:.9g} s does not come after {values[i - 1]:.9g} s"
        raise InputError(f"{table.path}: {table.row(i)}, column t", found, "times that increase are accepted")


def _kept(path: Path, t: FloatArray, options: ReadOptions) -> slice:
    """The samples between --from and --to."""
    first = 0 if options.start is None else int(np.searchsorted(t, options.start, "left"))
    last = t.size if options.stop is None else int(np.searchsorted(t, options.stop, "right"))
    count = max(last - first, 0)
    if count < MINIMUM_SAMPLES:
        cut = "" if count == t.size else f" between --from and --to (the file runs from {t[0]:g} s to {t[-1]:g} s)"
        raise InputError(str(path), f"{count} samples{cut}", f"at least {MINIMUM_SAMPLES} are accepted")
    return slice(first, last)


def read_recording(path: Path, options: ReadOptions | None = None, read_rrd: RrdReader | None = None) -> Recording:
    """Read a recording of any accepted format, in SI units.

    With --columns only the channels it names are taken (and a column t, unless --rate is given); without it the columns
    t, x, v, a and u (or F). Values are checked between --from and --to.

    Raises InputError naming the file, row, column or option that is wrong.
    """
    options = options or ReadOptions()
    if not path.is_file():
        found = "a folder" if path.is_dir() else "no such file"
        raise InputError(str(path), found, "a file that can be read is accepted")
    reader = reader_of(_kind(path))
    try:
        if reader is not None and reader.text:
            check_size(path, MOST_BYTES)
        digest = sha256(path)
    except OSError as error:
        raise InputError(str(path), error.strerror or str(error), "a file that can be read is accepted") from None
    if path.suffix.lower() == ".rrd" and read_rrd is not None:
        return _from_rrd(path, digest, options, read_rrd)
    if reader is None or reader.text:
        return _read(path, digest, options)
    accepted = f"a whole {_kind(path)} file is accepted"
    columns, about = read_apart(
        "harness.io.recording:columns_of", path, accepted, digest=digest, options=asdict(options)
    )
    channels = {name: values for name, values in columns.items() if name != "t"}
    return Recording(columns["t"], channels, str(path), digest, **about)


def columns_of(path: Path, digest: str, options: dict[str, Any]) -> Found:
    """What ``read_recording`` finds, as a process of its own hands it on."""
    found = _read(path, digest, ReadOptions(**options))
    return {"t": found.t, **found.channels}, {name: _plain(getattr(found, name)) for name in _ABOUT}


_ABOUT = ("units", "angular", "notes")


def _plain(value: Any) -> Any:
    return dict(value) if isinstance(value, abc.Mapping) else value


def _read(path: Path, digest: str, options: ReadOptions) -> Recording:
    table = _open(path, options)
    read = _channels(table, _mappings(table, options))
    sizes = {channel: values.size for channel, (values, _) in read.items()}
    if len(set(sizes.values())) > 1:
        found = ", ".join(f"{size} values of {channel}" for channel, size in sizes.items())
        raise InputError(str(path), found, "columns of one length are accepted")
    if options.rate is not None:
        with np.errstate(over="ignore"):
            t = np.arange(next(iter(sizes.values())), dtype=np.float64) / options.rate
        _check_rows(table, "t", t, 0)
    else:
        t = read["t"][0]
        _times(table, t)
    keep = _kept(path, t, options)
    channels = {channel: values[keep] for channel, (values, _) in read.items() if channel != "t"}
    for channel, values in channels.items():
        _check_rows(table, channel, values, keep.start)
    return Recording(
        t[keep],
        channels,
        file=str(path),
        sha256=digest,
        units={channel: unit.text for channel, (_, unit) in read.items() if unit.text},
        angular=any(unit.angular for channel, (_, unit) in read.items() if channel in ("x", "a")),
        notes=sampling_notes(t[keep]),
    )


def _from_rrd(path: Path, digest: str, options: ReadOptions, read_rrd: RrdReader) -> Recording:
    for option, value in (
        ("--columns", options.columns),
        ("--rate", options.rate),
        ("--skip-rows", options.skip_rows or None),
    ):
        if value is not None:
            raise InputError(option, f"given for {path}", "a .rrd of ours says this itself; leave the option out")
    whole = read_rrd(path)
    kept = whole.cut(_kept(path, whole.t, options))
    return Recording(kept.t, kept.channels, str(path), digest, kept.units, kept.angular, kept.notes, kept.extra)
