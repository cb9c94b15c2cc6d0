"""A log from the columns of a table."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.apart import Found
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.columns import Mapping
from harness.io.logs.arrow import ArrowTable
from harness.io.logs.match import Target, by_name, by_option, time_of
from harness.io.logs.raw import Fields, LogOptions, Raw
from harness.io.logs.rules import SI_UNITS, Field
from harness.io.product import products
from harness.io.registry import formats, kind_of, reader_of
from harness.io.stamps import since_first, whole_numbers
from harness.io.table import Table
from harness.io.units import Unit

PARQUET = (".parquet", ".pq")
MIXED = "the units of their headers"
"""Where columns of one field came in several units."""
NEEDED = "columns t and NAME.position, NAME.velocity, NAME.effort (or position[0], x1_rad, actual_q_0, q1)"


def columns_of(path: Path, options: dict[str, Any]) -> Found:
    """What ``raw_of_file`` finds, as a process of its own hands it on."""
    joints = options.pop("joints")
    return raw_of_file(path, LogOptions(joints=None if joints is None else tuple(joints), **options)).found()


def raw_of_file(path: Path, options: LogOptions) -> Raw:
    """The log in a file of any format of tables. Raises InputError for what cannot be read as one."""
    kind = kind_of(path)
    if kind in PARQUET:
        return raw_of(ArrowTable(path), options)
    reader = reader_of(kind)
    if reader is None:
        accepted = f"{formats()}, ROS bags (.bag, .db3, .mcap, a folder) and LeRobot data sets are accepted"
        raise InputError(str(path), f"the format {kind or 'without a name'}", accepted)
    return raw_of(reader.open(path, options.skip_rows) if reader.text else reader.open(path), options)


def raw_of(table: Table, options: LogOptions) -> Raw:
    """The log that the columns of a table make. Raises InputError where they make none."""
    clock, note = time_of(table)
    if options.columns is None:
        targets, numbered = by_name(table)
        if options.rate is not None and clock is not None:
            accepted = "one of the two is accepted (--columns without t leaves the column out)"
            raise InputError("--rate", f"given although a column of {table.path} gives the time", accepted)
    else:
        targets, said = by_option(options.columns)
        clock, note = (clock if said is None and options.rate is None else said), None
        numbered = False
    if not any(target.field == "position" for target in targets):
        found = f"no joint's position among the columns {table.listed()}"
        raise InputError(str(table.path), found, f'{NEEDED}, or --columns "t=...,NAME.position=..." are accepted')
    if clock is None and options.rate is None:
        found = f"no time among the columns {table.listed()}"
        raise InputError(str(table.path), found, "--rate HZ, or a column t, is accepted")
    asked = {str(i): _with_unit(table, target, options) for i, target in enumerate(targets)}
    if clock is not None:
        asked["t"] = clock
    read = products(table, asked)
    sizes = {values.size for values, _ in read.values()}
    if len(sizes) > 1:
        found = f"columns of {min(sizes)} to {max(sizes)} values"
        raise InputError(str(table.path), found, "columns of one length are accepted")
    t, notes = _times(read.get("t"), sizes.pop(), options.rate)
    fields: Fields = {}
    told: dict[str, str] = {}
    for i, target in enumerate(targets):
        values, unit = read[str(i)]
        fields.setdefault(target.field, {})[target.joint] = values
        told[target.field] = unit.text if told.get(target.field, unit.text) == unit.text else MIXED
    notes = [*([] if note is None else [note]), *notes]
    if options.columns is None:
        notes.insert(0, _said(targets, told))
    return Raw(t, fields, {k: v for k, v in told.items() if v not in ("", MIXED)}, "row", numbered, tuple(notes))


def _with_unit(table: Table, target: Target, options: LogOptions) -> Mapping:
    """The product of a target, with the unit that --angle-unit gives where nothing else does."""
    mapping, unit = target.mapping, options.angle_unit
    told = mapping.unit is not None or any(table.position(name) in table.units for name in mapping.names)
    if told or unit is None or target.field not in ("position", "velocity"):
        return mapping
    return replace(mapping, unit=unit if target.field == "position" else f"{unit}/s")


def _times(read: tuple[FloatArray, Unit] | None, size: int, rate: float | None) -> tuple[FloatArray, list[str]]:
    """Times in s, and what is said of them."""
    if read is None:
        assert rate is not None
        return np.arange(size) / rate, []
    stamps, unit = read
    with np.errstate(over="ignore", invalid="ignore"):  # whether it is finite is looked at with the rows
        t, counted = since_first(stamps, unit)
    return t, [note for note in (counted, whole_numbers(t, unit)) if note]


def _said(targets: list[Target], told: dict[str, str]) -> str:
    """Which columns were read as what, in one sentence."""
    parts = []
    for field in dict.fromkeys(target.field for target in targets):
        headers = [target.header for target in targets if target.field == field]
        span = headers[0] if len(headers) == 1 else f"{headers[0]} to {headers[-1]}"
        unit = told[field].replace("*", " ") or f"{SI_UNITS[field]} (no unit given)"
        parts.append(f"{span} as {_CALLED.get(field, field)} in {unit}")
    return f"Read {', '.join(parts)}."


_CALLED: dict[Field, str] = {"magnitude": "effort without its sign"}
