"""Channels as products of the columns of a table and of numbers."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.io.choose import unit_of
from harness.io.columns import Mapping
from harness.io.table import Table
from harness.io.units import Unit


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
