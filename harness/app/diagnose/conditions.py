"""Under which conditions recordings were made: a table with a row a file, of a temperature, a load, a density."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from harness.core.bounded import MEBIBYTE, read_bytes
from harness.core.errors import InputError

Conditions = Mapping[str, Mapping[str, float]]
"""By a recording's file name, numbers by name."""
_FILE = (
    "file",
    "filename",
    "recording",
    "datei",
    "dateiname",
    "fichier",
    "archivo",
    "bestand",
    "fil",
    "plik",
    "файл",
    "文件",
)
"""What the column of files is called."""


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


def refuse_conditions(known: Conditions, files: Sequence[str]) -> None:
    """Raise InputError for a table that has no row of any recording."""
    given = in_order(known, files).values()
    if known and all(value is None for values in given for value in values):
        found = f"rows of {', '.join(known)}, which are none of the recordings"
        accepted = f"a row each of {', '.join(Path(file).name for file in files)}"
        raise InputError("--conditions", found, accepted)


def read_conditions(path: Path) -> dict[str, dict[str, float]]:
    """Conditions of logs from a CSV with a column ``file``, in one of a few languages, and numbers (temperature, day,
    hours run); with semicolons or tabs numbers may have a decimal comma.

    Raises InputError naming the file, and the line or column that is wrong.
    """
    try:
        text = read_bytes(path, MEBIBYTE).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(str(path), "no text", "a CSV with a column file") from None
    mark = next((one for one in ";\t" if one in text.partition("\n")[0]), ",")
    rows = csv.DictReader(text.splitlines(), delimiter=mark)
    fields = list(rows.fieldnames or ())
    of_files = next((field for field in fields if field.strip().lower() in _FILE), None)
    if of_files is None:
        found = f"columns {', '.join(fields) or 'none'}"
        raise InputError(str(path), found, "a CSV with a column file and others of numbers")
    found_of: dict[str, dict[str, float]] = {}
    for number, row in enumerate(rows, 2):
        name = Path(row.pop(of_files) or "").name
        found_of[name] = {}
        for column, value in row.items():
            if column is None or value in (None, ""):
                continue
            try:
                found_of[name][column] = float(str(value) if mark == "," else str(value).replace(",", "."))
            except ValueError:
                where = f"{path}, line {number}, column {column}"
                raise InputError(where, repr(value), "a number, or nothing") from None
    return found_of
