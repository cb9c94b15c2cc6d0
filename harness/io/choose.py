"""Which columns of a table are which channels: as --columns says, else by their names."""

from itertools import islice
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.columns import CHANNELS, Mapping, parse_columns
from harness.io.guess import candidates, meaning
from harness.io.options import UNSAID, RefusedError
from harness.io.score import choices
from harness.io.table import Table
from harness.io.units import Unit, parse_unit

_OWN = {"t": ("t",), "x": ("x",), "v": ("v",), "a": ("a",), "u": ("u", "F")}


_MOST_CHOICES, _SHOWN = 6, 8
"""Choices of columns that are tried, and columns that are named at most."""


def chosen(table: Table, columns: str | None, rate: float | None) -> tuple[dict[str, Mapping], frozenset[str]]:
    """What to read for each channel, and the channels that were guessed from names that are not the channel's own.

    columns : the text of --columns. rate : Hz, that of --rate. Raises RefusedError where names leave it open.
    """
    guessed: frozenset[str] = frozenset()
    if columns is not None:
        mappings = parse_columns(columns)
        if "t" not in mappings and rate is None and "t" in table.names:
            mappings["t"] = Mapping("t", ("t",))
    else:
        mappings, guessed = _by_name(table, rate)
    if not set(mappings) & {"x", "v", "a"}:
        hint = "columns named t and one or more of x, v, a, or a choice of them by --columns, is accepted"
        raise RefusedError(str(table.path), f"the columns {table.listed()}", hint, _others(table, rate))
    if "t" not in mappings and rate is None:
        hint = "a column t, or its sampling rate by --rate HZ, is accepted"
        others = _others(table, rate) if columns is None else ()
        raise RefusedError(str(table.path), f"no time among the columns {table.listed()}", hint, others)
    if "t" in mappings and rate is not None:
        accepted = "one of the two is accepted (--columns without t leaves the column out)"
        raise InputError("--rate", f"given although a column of {table.path} gives the time", accepted)
    return mappings, guessed


def _others(table: Table, rate: float | None) -> list[dict[str, Any]]:
    """Choices of columns to try, with a rate to be given where no column is a time."""
    found: list[dict[str, Any]] = [{"columns": text} for text in islice(choices(table, rate is None), _MOST_CHOICES)]
    if found or rate is not None:
        return found
    return [{"columns": text, "rate": UNSAID} for text in islice(choices(table, timed=False), _MOST_CHOICES)]


def _by_name(table: Table, rate: float | None) -> tuple[dict[str, Mapping], frozenset[str]]:
    found = candidates(table.names)
    mappings, guessed = {}, set()
    for channel in (c for c in CHANNELS if c in found):
        positions = found[channel]
        if len(positions) > 1:
            named = ", ".join(table.headers[i] or f"#{i + 1}" for i in positions[:_SHOWN])
            named += ", ..." if len(positions) > _SHOWN else ""
            found_too = f"{len(positions)} columns that may be {channel}: {named}"
            raise RefusedError(str(table.path), found_too, "one of them by --columns is accepted", _others(table, rate))
        name = table.names[positions[0]]
        mappings[channel] = Mapping(channel, (f"#{positions[0] + 1}",))
        if name not in _OWN[channel]:
            guessed.add(channel)
    return mappings, frozenset(guessed)


def unit_of(table: Table, mapping: Mapping, positions: list[int], constants: list[bool]) -> Unit:
    """The unit of a mapping: its own, else what the header of its one column says, in brackets or by its ending."""
    if mapping.unit is not None:
        return parse_unit(f"--columns, channel {mapping.channel}", mapping.channel, mapping.unit)
    moving = [i for i, constant in zip(positions, constants, strict=True) if not constant]
    if len(moving) != 1 or any(constants):
        return parse_unit("", mapping.channel, None)
    header = table.units.get(moving[0])
    means = meaning(table.names[moving[0]])
    if header is None and means is not None and means.channel == mapping.channel:
        header = means.unit or ("rad" if means.angle else None)
    where = f"{table.path}: column {'*'.join(table.names[i] or f'#{i + 1}' for i in positions)}"
    return parse_unit(where, mapping.channel, header)


def quoted_of(table: Table, mapping: Mapping) -> str:
    """A mapping's product as --columns takes it."""
    at = [table.position(name) for name in mapping.names]
    product = "*".join(table.quoted(i) for i in at)
    factor = "" if mapping.factor == 1.0 else f"{mapping.factor:.9g}*"
    return factor + product + ("" if mapping.unit is None else f"[{mapping.unit}]")


def said(table: Table, mappings: dict[str, Mapping], units: dict[str, Unit], guessed: frozenset[str]) -> str | None:
    """What was guessed, in one sentence that ends with the --columns that says the same; None where nothing was."""
    if not guessed:
        return None
    parts, paste = [], []
    for channel in (c for c in CHANNELS if c in mappings):
        position = table.position(mappings[channel].names[0])
        unit = units[channel].text
        shown = unit or {"t": "s", "x": "m", "v": "m/s", "a": "m/s^2", "u": "N"}[channel]
        paste.append(f"{channel}={table.quoted(position)}[{shown}]")
        if channel in guessed:
            parts.append(f"{channel} from {table.headers[position]} in {shown}{'' if unit else ' (no unit given)'}")
    return f'Read {", ".join(parts)}; to say otherwise: --columns "{",".join(paste)}".'


def products(table: Table, mappings: dict[str, Mapping]) -> dict[str, tuple[FloatArray, Unit]]:
    """The values of every channel in SI, those of t as they stand, and the unit they came in; the file is read once.

    Raises InputError where columns of one product are of several lengths, or a unit is none.
    """
    at = {name: table.position(name) for mapping in mappings.values() for name in mapping.names}
    positions = sorted(set(at.values()))
    columns = dict(zip(positions, table.read(positions), strict=True))
    return {channel: _product(table, mapping, at, columns) for channel, mapping in mappings.items()}


def _product(
    table: Table, mapping: Mapping, at: dict[str, int], read: dict[int, FloatArray]
) -> tuple[FloatArray, Unit]:
    positions = [at[name] for name in mapping.names]
    columns = [read[i] for i in positions]
    constants = [column.size == 1 for column in columns]
    unit = unit_of(table, mapping, positions, constants)
    factor = mapping.factor * (1.0 if mapping.channel == "t" else unit.factor)
    values = columns[0]
    with np.errstate(over="ignore", invalid="ignore"):  # what becomes of it is looked at when the rows are checked
        for column in columns[1:]:
            if column.size not in (1, values.size) and values.size != 1:
                found = f"columns of {values.size} and {column.size} values"
                where = f"{table.path}: channel {mapping.channel}"
                raise InputError(where, found, "columns of one length are accepted")
            values = values * column
        return (values if factor == 1.0 else values * factor), unit
