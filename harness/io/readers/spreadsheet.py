"""Tables that lie in another file: a sheet of an Excel workbook (extra ``files``), a text in a zip archive.

Both are read as text tables are, so that lines above them, units in a line of their own and empty cells are no harm.
"""

import csv
import io
import zipfile
from datetime import date, datetime, time
from pathlib import Path
from typing import Any

from harness.core.bounded import MOST_BYTES
from harness.core.errors import InputError
from harness.io.reader import Reader
from harness.io.readers.text import TEXT, TextTable
from harness.io.registry import kind_of


def open_workbook(path: Path) -> TextTable:
    """The sheet of a workbook that holds most numbers. Raises InputError for a file that is none."""
    try:
        import openpyxl
    except ImportError:
        found = "a workbook, and no library that reads one (a sheet saved as CSV needs none)"
        raise InputError(str(path), found, "try: pip install 'friction-harness[files]'") from None
    try:
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
        sheets = {sheet.title: list(sheet.iter_rows(values_only=True)) for sheet in book.worksheets}
    except MemoryError:
        raise
    except Exception as error:  # whatever the broken bytes lead zipfile, the XML parser and the library to
        raise InputError(str(path), f"not a workbook ({error})", "an Excel file .xlsx") from None
    title = max(
        sheets, key=lambda name: sum(isinstance(c, float | int) for row in sheets[name] for c in row), default=""
    )
    text = io.StringIO()
    csv.writer(text, delimiter=";", lineterminator="\n").writerows(
        [_cell(cell) for cell in row] for row in sheets.get(title, ()) if any(cell is not None for cell in row)
    )
    return _told(TextTable(path, data=text.getvalue().encode()), f"sheet '{title}'", len(sheets))


def _cell(value: Any) -> str:
    """A cell as text; dates as ISO has them."""
    if isinstance(value, datetime | date | time):
        return value.isoformat()
    return "" if value is None else repr(value) if isinstance(value, float) else str(value)


def open_archive(path: Path) -> TextTable:
    """The largest text table of an archive, what lies in a folder ``meta`` left out.

    Raises InputError for a file that is no archive, or one without a table.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            found = [e for e in archive.infolist() if kind_of(Path(e.filename)) in TEXT.suffixes and not e.is_dir()]
            found = [e for e in found if not {"meta", "__MACOSX"} & set(Path(e.filename).parts)]
            if not found:
                raise InputError(str(path), "an archive without a text table", "one with a .csv or .txt")
            entry = max(found, key=lambda e: e.file_size)
            if entry.file_size > MOST_BYTES:
                raise InputError(str(path), f"{entry.file_size} bytes, unpacked", f"at most {MOST_BYTES}")
            data = archive.read(entry)
    except (zipfile.BadZipFile, OSError, EOFError, NotImplementedError, RuntimeError, ValueError) as error:
        raise InputError(str(path), f"not an archive ({error})", "a whole .zip file") from None
    return _told(TextTable(path, data=data), f"'{entry.filename}'", len(found))


def _told(table: TextTable, which: str, count: int) -> TextTable:
    """The table; of several it is said which."""
    if count > 1:
        table.mended.append(f"Of {count} tables in the file {which} is read, the one that holds most.")
    return table


XLSX = Reader(name="Excel", suffixes=(".xlsx", ".xlsm"), open=open_workbook)
ZIP = Reader(name="zip archives of text tables", suffixes=(".zip",), open=open_archive)
