"""Under which conditions recordings were made: a table with a row a file, of a temperature, a load, a density."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.core.bounded import MEBIBYTE, read_bytes
from harness.core.errors import InputError

Conditions = Mapping[str, Mapping[str, float]]
"""By a recording's file name, numbers by name."""
_FILE = "file"


def in_order(known: Conditions, files: Sequence[str]) -> dict[str, list[float | None]]:
    """Each condition, one a file, None where it is not known. A part of a file ("swings.csv decay 2") has its own row
    or that of the file.
    """
    rows: list[Mapping[str, float]] = []
    for file in files:
        name = Path(file).name
        of_file = next((key for key in known if name.startswith(f"{key} ")), name)
        rows.append(known.get(name, known.get(of_file, {})))
    return {name: [row.get(name) for row in rows] for name in dict.fromkeys(n for one in known.values() for n in one)}


def read_conditions(path: Path) -> dict[str, dict[str, float]]:
    """Conditions of logs from a CSV with a column ``file`` and numbers (temperature, day, hours run).

    Raises InputError naming the file, and the line or column that is wrong.
    """
    try:
        text = read_bytes(path, MEBIBYTE).decode()
    except UnicodeDecodeError:
        raise InputError(str(path), "no text", "a CSV with a column file") from None
    rows = csv.DictReader(text.splitlines())
    if _FILE not in (rows.fieldnames or ()):
        found = f"columns {', '.join(rows.fieldnames or ()) or 'none'}"
        raise InputError(str(path), found, "a CSV with a column file and others of numbers")
    found_of: dict[str, dict[str, float]] = {}
    for row in rows:
        name = Path(row.pop(_FILE) or "").name
        found_of[name] = {}
        for column, value in row.items():
            if column is None or value in (None, ""):
                continue
            try:
                found_of[name][column] = float(str(value))
            except ValueError:
                where = f"{path}, line {rows.line_num}, column {column}"
                raise InputError(where, repr(value), "a number, or nothing") from None
    return found_of
