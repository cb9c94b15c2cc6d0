"""Tables in text: CSV with any usual separator, plain whitespace tables, both also gzipped."""

import csv
import math
import re
from array import array
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.bounded import read_bytes, unpacked
from harness.core.errors import InputError
from harness.io.columns import meaning, unit_ending, word_of
from harness.io.layout import NUMBER, Head, is_row, rate_of, separator_of
from harness.io.reader import Reader
from harness.io.table import Table
from harness.io.times import Clock
from harness.io.units import is_unit, split_header, split_headers

_HEAD = 1 << 16
MOST_ROWS = 20_000_000
"""Of a text table: with the bound on its bytes, what keeps the memory it takes below 2 GiB."""
_BLOCK = 1 << 22
"""Bytes that are read at a time."""
_LONGEST_LINE = 1 << 20
_UTF_16 = (b"\xff\xfe", b"\xfe\xff")
"""Its mark, in either order of bytes."""
_CODINGS = ("cp932", "gb18030", "cp949", "cp1251", "cp1250")
"""In which texts that are not UTF-8 are tried, for a word of theirs that says a channel, before they are Latin."""
_WRAPPED = 10
"""Lines over which the names of a table go at most."""
_LOOKED, _ROWS, _HEADS = 60, 3, 2
"""Lines at the beginning in which a table's first is looked for, rows that make one, and lines of names and units."""
_DEEP = 200
"""Lines in which a program's own header is looked for."""
_MOST_ODD = 0.05
"""Lines of another width that are left out, for each row before them."""
_MOST_BELOW = 20
"""Lines that may stand below the rows."""
_COMMENT = ("#", "%")
_NOT_LATIN, _LONGEST_NAME = re.compile(r"[^\x00-\xff]"), 100
_RATE = re.compile(
    r"(?:\bf_?s\b|sampl\w{0,6}|abtast|scan|data|update|frame)[ _-]?(?:rate|freq\w{0,6}|hz)?\s?[:=;,\t ]\s{0,9}"
    r"(?P<rate>\d[\d.,]{0,12})\s?(?P<unit>k?hz|sps|s/s|fps)\b",
    re.IGNORECASE,
)
"""A line above the numbers that says how many samples there are a second."""
_STEP = re.compile(
    r"\bsampl\w{0,6}[ _-]?(?:cycle|interval|period|time|pitch|step)\s?[:=;,\t ]\s{0,9}"
    r"(?P<step>\d[\d.,]{0,12})\s?(?P<unit>ms|us|µs|s)\b",
    re.IGNORECASE,
)
"""One that says how far apart they are."""
_IS_RATE = re.compile(r"^(?:sampl\w{0,6}|scan|data|frame)[ _-]?(?:rate|freq\w{0,6})(?:[ _-]?hz)?$", re.IGNORECASE)
_UNIT_WORDS = frozenset(("unit", "units", "einheit", "unité", "unidad", "unità"))
_NEAR = 0.05
"""Share by which a first sample may differ from what a run was to start with."""
_BRACKETS = re.compile(r"^[\[(]\s*([^\[\]()]*?)\s*[\])]$")
_FORTRAN = re.compile(r"^([+-]?\d*\.?\d+|[+-]?\d+\.)[dD]([+-]?\d{1,3})$")
_WITHOUT = (
    "na n/a null none nil - -- --- ? . *** overload overflow over ovld ovf ovrng ol #n/a #num! #value! #div/0! #nv "
    "<na> 1.#qnan -1.#ind 1.#inf -1.#inf \N{INFINITY} -\N{INFINITY}"
)
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?P<mark>[.,'’ \u00a0\u202f])\d{3}(?:(?P=mark)\d{3})*(?:[.,]\d*)?")
"""Numbers whose thousands are parted: 1,234.5, 1.234,5, 1'234."""
_WHOLE = re.compile(r"[+-]?[1-9]\d{0,2}\.\d{3}")
"""A whole number beside decimal commas, where all with a point are so and others have none."""
_MISSING = frozenset(_WITHOUT.split())
"""What loggers write for no value, besides nothing and nan."""


@dataclass(frozen=True, slots=True)
class _Layout:
    """How a text table is laid out: separator and decimal mark, header fields, units of their own line, its numbers."""

    separator: str  # "" for runs of blanks
    decimal: str
    fields: tuple[str, ...]
    offset: int  # of the first data row, in bytes
    line: int  # number of that line, from 1
    units: tuple[str, ...] = ()  # "" where that line says none


def _number(cell: str, decimal: str = ".") -> float | None:
    """The value of a cell; nan when it is empty, None when it is text."""
    text = cell.strip()
    if not text or text.lower() in _MISSING:
        return float("nan")
    if "_" in text:
        return None
    try:
        return float(text.replace(",", ".") if decimal == "," else text)
    except ValueError:
        # as typesetters (a true minus) and Fortran (5.0D-02) write it
        plain = _FORTRAN.sub(r"\1e\2", text.replace("\N{MINUS SIGN}", "-"))
        if (parted := _THOUSANDS.fullmatch(plain)) and parted["mark"] != decimal:
            plain = plain.replace(parted["mark"], "")
        return None if plain == text or plain in _MISSING else _number(plain, decimal)


def _cells(where: str, line: str, separator: str) -> list[str]:
    if not separator:
        return line.split()
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True))]
    except csv.Error as error:
        accepted = f"cells of at most {csv.field_size_limit()} characters"
        raise InputError(where, f"unreadable ({error})", accepted) from None


def _known(data: bytes | bytearray, name: str) -> Head | None:
    """The table of a text that one of the layouts knows; None where none does."""
    from harness.io.registry import all_layouts

    lines = [_decode(line).rstrip("\r") for line in bytes(data[:_HEAD]).split(b"\n")[:_DEEP]]
    return next((head for layout in all_layouts() if (head := layout.find(lines, name)) is not None), None)


def _layout(path: Path, data: bytes | bytearray, skip_rows: int) -> tuple[_Layout, str | None]:
    """How a table is laid out, and the sentence that says what was passed over before it."""
    head = bytes(data[:_HEAD])
    lines = head.split(b"\n")
    if len(data) > _HEAD and len(lines) > 1:
        lines.pop()
    if skip_rows >= len(lines) and skip_rows > 0:
        found = f"{skip_rows} of {len(lines)} lines"
        raise InputError(f"{path}: --skip-rows", found, "fewer than there are")
    offset = sum(len(line) + 1 for line in lines[:skip_rows])
    shown: list[tuple[int, int, str]] = []
    tabbed = False
    for number, raw in enumerate(lines[skip_rows:], skip_rows + 1):
        text = _decode(raw).strip()
        if text:
            # an empty last cell, where tabs part the names
            shown.append((number, offset, _decode(raw).strip(" \r") if tabbed or "\t" in text else text))
            tabbed = tabbed or "\t" in shown[-1][2]
        offset += len(raw) + 1
    body = [entry for entry in shown if not entry[2].startswith(_COMMENT)]
    if not body:
        raise InputError(str(path), "no rows", "a header and at least 50 rows")
    separator, decimal = separator_of([text for _, _, text in body[:_LOOKED]])
    below = _heading(path, [(n, text) for n, _, text in body[:_LOOKED]], separator, decimal)
    if below is not None:
        names, said, begin = below
        number, start, _ = body[begin]
        more = begin - len({names, said} - {("",) * len(names), ()})
        lines_are = "1 line above the numbers, neither names nor units, is" if more == 1 else ""
        lines_are = lines_are or f"{more} lines above the numbers, neither names nor units, are"
        passed = f"{lines_are} passed over." if more else None
        return _Layout(separator, decimal, names, start, number, said), passed
    number, start, text = body[0]
    where = f"{path}: line {number}"
    cells = _cells(where, text, separator)
    if _has_number(cells, decimal):
        comments = [text.lstrip("#% ") for n, _, text in shown if n < number and text.startswith(_COMMENT)]
        named = _header(where, comments[-1], separator) if comments else []
        fields = tuple(named) if len(named) == len(cells) else ("",) * len(cells)
        return _Layout(separator, decimal, fields, start, number), None
    cells = _header(where, text, separator)
    if len(body) == 1:
        raise InputError(str(path), "0 rows under the header", "at least 50")
    units = _units(cells, [_cells(f"{path}: line {n}", text, separator) for n, _, text in body[1:3]], decimal)
    number, start, _ = body[2] if units else body[1]
    return _Layout(separator, decimal, tuple(cells), start, number, units), None


def _heading(
    path: Path, lines: Sequence[tuple[int, str]], separator: str, decimal: str
) -> tuple[tuple[str, ...], tuple[str, ...], int] | None:
    """Names and units of a table below other lines, and its first row; None where it begins at once.

    lines : number and text of each of the first ones that are no comment. The names are the last line above the units,
    or above the rows, in which one says a channel.
    """
    rows = [_cells(f"{path}: line {n}", text, separator) for n, text in lines]
    heads = [tuple(_header(f"{path}: line {n}", text, separator)) for n, text in lines]
    width = len(rows[-1])
    full = _is_all_numbers(rows[-1], decimal)
    # numbers and words in one line, where the rows have numbers alone: limits, scales, settings
    mixed = full and _has_number(rows[0], decimal) and not _is_all_numbers(rows[0], decimal)
    of_numbers = _is_all_numbers if mixed else _has_number
    numbered = _is_all_numbers(rows[-1][:1], decimal)
    fits = np.array(
        [
            len(row) == width and of_numbers(row, decimal) and _is_all_numbers(row[:1], decimal) == numbered
            for row in rows
        ]
    )
    starts = (i for i in range(fits.size) if np.all(fits[i : i + _ROWS]) and np.mean(fits[i:]) > 1.0 - 2.0 * _MOST_ODD)
    begin = next(starts, len(rows))
    title = width > 1 and sum(map(bool, rows[0])) == 1  # alone in its line, as a spreadsheet's heading is
    two = begin == _HEADS and not any(map(_says_channel, heads[0])) and any(map(_says_channel, heads[1]))
    apart = mixed or title or two or begin > _HEADS or width not in (len(rows[0]), len(heads[0]))
    if not apart or len(rows) - begin < _ROWS:
        return None
    # row names stand below no name, where R writes a table
    heads = [("", *cells) if len(cells) == width - 1 and begin == 1 else cells for cells in heads]
    texts = [i for i in range(begin) if len(heads[i]) == width and not _has_number(heads[i], decimal)]
    of_units = next((i for i in reversed(texts) if _is_of_units(heads[i])), None)
    above = [i for i in texts if of_units is None or i < of_units]
    named = [i for i in above if any(map(_says_channel, heads[i]))]
    names = max(named or above, default=None)
    units = () if of_units is None else tuple(unit if is_unit(unit := _bare(cell)) else "" for cell in heads[of_units])
    return ("",) * width if names is None else heads[names], units, begin


def _says_channel(header: str) -> bool:
    return bool(word_of(header) or meaning(split_header(header)[0]))


def _is_of_units(cells: Sequence[str]) -> bool:
    """Whether a line is one of units: all that stands in it is, or stands in brackets beside one that is."""
    said = [cell for cell in cells if cell]
    units = [is_unit(_bare(cell)) for cell in said]
    return any(units) and all(unit or _BRACKETS.match(cell) for cell, unit in zip(said, units, strict=True))


def _bare(unit: str) -> str:
    """A unit without brackets; nothing of a word that says what its line holds."""
    found = _BRACKETS.sub(r"\1", re.sub(r"^[Uu]nits?: ", "", unit.strip()))
    return "" if found.lower().rstrip(":") in _UNIT_WORDS else found


def _is_all_numbers(cells: Sequence[str], decimal: str) -> bool:
    return all(_number(cell, decimal) is not None for cell in cells)


def _has_number(cells: Sequence[str], decimal: str) -> bool:
    return any(_number(cell, decimal) is not None and cell for cell in cells)


def _units(fields: Sequence[str], below: Sequence[Sequence[str]], decimal: str) -> tuple[str, ...]:
    """Units that stand in a line of their own between names and numbers; () where the line below is none of units.

    fields : the names, of which none says a unit itself. below : cells of the next two lines.
    """
    if len(below) < 2 or any(split_header(field)[1] is not None for field in fields):
        return ()
    said, numbers = below
    of_text = any(said) and all(_number(cell, decimal) is None or not cell for cell in said)
    if len(said) != len(fields) or not of_text or any(Clock().seconds(cell) is not None for cell in said):
        return ()
    if not all(_number(cell, decimal) is not None or Clock().seconds(cell) is not None for cell in numbers):
        return ()
    return tuple(map(_bare, said))


def _header(where: str, line: str, separator: str) -> list[str]:
    """The fields of a header; between blanks, ``x [mm]`` stays together."""
    if separator:
        return _cells(where, line, separator)
    # a unit's text holds no second bracket: what is searched for its end ends at the next one
    found = re.findall(r'"[^"]*"|[^\s\[(]+(?:\s?[\[(][^\[\]()]*[\])])*', " ".join(line.split()))
    return [cell.strip('"') for cell in found]


def _decode(raw: bytes | bytearray) -> str:
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _coding(head: bytes) -> str | None:
    """The coding of a text that is neither UTF-8 nor Latin: the one in which its first lines say a channel."""
    first = head.rpartition(b"\n")[0]
    try:
        first.decode("utf-8-sig")
    except UnicodeDecodeError:
        for coding in _CODINGS:
            with suppress(UnicodeDecodeError):
                cells = re.split(r"[\t;,]", first.decode(coding))
                if any(map(_says_more, (cell for cell in cells if len(cell) < _LONGEST_NAME))):
                    return coding
    return None


def _says_more(cell: str) -> bool:
    """Whether letters that are not Latin say a channel, or the unit of one: not the µ of a western file."""
    latin = _NOT_LATIN.sub(" ", cell)
    unit = split_header(cell)[1] or ""
    return (
        latin != cell
        and bool(word_of(cell))
        and (not word_of(latin) or (_NOT_LATIN.search(unit) is not None and is_unit(unit)))
    )


def _bytes(path: Path) -> bytes | bytearray:
    """The content, unpacked."""
    try:
        with path.open("rb") as file:
            packed = file.read(2) == b"\x1f\x8b"
            file.seek(0)
            return unpacked(path, file) if packed else read_bytes(path)
    except OSError as error:
        raise InputError(str(path), error.strerror or "unreadable", "a file that can be read") from None


def _lines(path: Path, data: bytes | bytearray) -> bytes | bytearray:
    """A text in UTF-8, its lines ended by a line feed whatever system wrote them."""
    if data[:2] in _UTF_16:  # spreadsheets save "Unicode text" so
        try:
            data = data.decode("utf-16").encode("utf-8")
        except UnicodeError:
            accepted = "a text table in UTF-8 or UTF-16"
            raise InputError(str(path), "UTF-16 that is damaged", accepted) from None
    elif (coding := _coding(bytes(data[:_HEAD]))) is not None:
        data = data.decode(coding, "replace").encode("utf-8")
    data = data.rstrip(b"\x00")  # a card's empty blocks, where the logger lost its power
    if b"\x00" in data[:_HEAD]:
        raise InputError(str(path), "binary content", "a text table in UTF-8, or in UTF-16 with its mark")
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    if data[:_HEAD].lstrip(b"\xef\xbb\xbf \t\n")[:1] == b"<" and b">" in data[:_HEAD]:
        raise InputError(str(path), "a page of the web or XML, and no table", "the file itself, as text")
    data = _unwrapped(data)
    rows = data.count(b"\n")
    if rows > MOST_ROWS:
        raise InputError(str(path), f"{rows} lines", f"at most {MOST_ROWS}")
    return data


def _unwrapped(data: bytes | bytearray) -> bytes | bytearray:
    """A text whose first line holds whole cells: where a name stands in quotes over several lines, as spreadsheets wrap
    it, these are one.
    """
    end = data.find(b"\n", 0, _HEAD)
    for _ in range(_WRAPPED):
        if end < 0 or data.count(b'"', 0, end) % 2 == 0:
            return data[:end].replace(b"\n", b" ") + data[end:] if b"\n" in data[: max(end, 0)] else data
        end = data.find(b"\n", end + 1, _HEAD)
    return data


def _single_blanks(data: bytes | bytearray) -> bytes:
    """Lines without blanks at their ends, and one blank between cells."""
    found = bytes(data).replace(b"\t", b" ")
    while b"  " in found:
        found = found.replace(b"  ", b" ")
    return found.replace(b" \n", b"\n").replace(b"\n ", b"\n").strip(b" ")


def _settings(above: str) -> dict[str, float]:
    """What stands above the numbers as a line of names over a line of one number each; {} where nothing does."""
    rows = (re.split(r"[,;\t]", line.strip(" #%\r")) for line in above.split("\n") if line.strip())
    lines = [[cell.strip() for cell in row] for row in rows]
    for names, cells in pairwise(lines):
        if len(names) == len(cells) > 1 and is_row(cells) and not any(NUMBER.match(name) for name in names):
            return {name: float(cell) for name, cell in zip(names, cells, strict=True) if cell}
    return {}


class TextTable(Table):
    """A text table, kept as bytes until its columns are asked for."""

    def __init__(self, path: Path, skip_rows: int = 0, data: bytes | None = None) -> None:
        """data : of a table that lies within the file."""
        self._data = _lines(path, _bytes(path) if data is None else data)
        head = None if skip_rows else _known(self._data, path.name)
        if head is not None and head.plain is not None:
            self._data = "\n".join(map(head.plain, _decode(self._data).split("\n"))).encode()
        if head is None or head.first is None:
            self._layout, passed = _layout(path, self._data, skip_rows)
        else:
            above = self._data[: 2 * _HEAD].split(b"\n")
            offset = sum(len(line) + 1 for line in above[: head.first])
            more = len(_cells(str(path), _decode(above[head.first]).strip(" \r"), head.separator)) - len(head.fields)
            fields = (*head.fields, *[""] * more)
            self._layout = _Layout(head.separator, head.decimal, fields, offset, head.first + 1, head.units)
            passed = None
        names, units = split_headers(self._layout.fields)
        units |= {i: unit for i, unit in enumerate(self._layout.units) if unit}
        below = () if units else self._units_below(len(names))
        super().__init__(path, names, units or dict(enumerate(below)), self._layout.fields)
        self._below = bool(below)
        self.units |= self._units_beside()
        self.mended += [passed] if passed else []
        if head is not None:
            self.rate, self.own = head.rate, head.own
            self.mended += [head.said] if head.said else []
        before = _decode(bytes(self._data[: min(self._layout.offset, _HEAD)]))
        said = _RATE.search(before)
        number = rate_of(said["rate"]) if said else None
        if said and number:
            self.said_rate = number * (1e3 if said["unit"].lower() == "khz" else 1.0)
        if (step := _STEP.search(before)) and not self.said_rate and (apart := rate_of(step["step"])):
            self.said_rate = {"ms": 1e3, "s": 1.0}.get(step["unit"].lower(), 1e6) / apart
        settings = _settings(before)
        self.said_rate = self.said_rate or next((y for name, y in settings.items() if _IS_RATE.search(name)), None)
        if len(self.names) == 1 and not self.units:
            self.units |= self._unit_of_start(settings)

    def _units_beside(self) -> dict[int, str]:
        """Units that stand in a column of their own, right of the numbers; a number there is that of a device."""
        of_units = [i for i, name in enumerate(self.names) if i and name.strip().lower() in _UNIT_WORDS]
        said = zip(of_units, self.texts(of_units) if of_units else (), strict=True)
        return {
            i - 1: unit for i, unit in said if unit and not unit.isdigit() and is_unit(unit) and i - 1 not in self.units
        }

    def _unit_of_start(self, settings: dict[str, float]) -> dict[int, str]:
        """The unit of a lone column whose first value a setting above it tells, by the ending of that one's name."""
        row = self._data[self._layout.offset :].split(b"\n", 1)[0]
        first = _number(_decode(bytes(row)).strip(), self._layout.decimal)
        for name, value in settings.items():
            ending = unit_ending(name)
            if ending and first and abs(abs(value) - abs(first)) < _NEAR * abs(first):
                return {0: ending[1]}
        return {}

    def _units_below(self, width: int) -> tuple[str, ...]:
        """Units that stand in the last line, one a column, below the numbers; () where that is no such line."""
        last = self._data[max(len(self._data) - _HEAD, self._layout.offset) :].rstrip().split(b"\n")[-1]
        cells = [_bare(cell) for cell in _cells("", _decode(last), self._layout.separator)]
        of_units = all(cell and _number(cell, self._layout.decimal) is None and is_unit(cell) for cell in cells)
        return tuple(cells) if len(cells) == width and of_units else ()

    def read(self, positions: Sequence[int]) -> list[FloatArray]:
        """See Table."""
        import pyarrow as pa
        from pyarrow import csv as pacsv

        if self._has_summary():  # in which a column may hold numbers
            return self._read_slowly(positions)
        layout, data = self._layout, memoryview(self._data)[self._layout.offset :]
        if not layout.separator:
            data = memoryview(_single_blanks(self._data[layout.offset :]))
        names = [f"#{i}" for i in range(len(self.names))]
        wanted = list(dict.fromkeys(names[i] for i in positions))
        try:
            table = pacsv.read_csv(
                pa.BufferReader(pa.py_buffer(data)),
                # a pool of threads that a process leaves as soon as it is made may abort it
                read_options=pacsv.ReadOptions(column_names=names, block_size=_BLOCK, use_threads=len(data) > _BLOCK),
                parse_options=pacsv.ParseOptions(delimiter=layout.separator or " "),
                convert_options=pacsv.ConvertOptions(
                    include_columns=wanted,
                    column_types={name: pa.float64() for name in wanted},
                    decimal_point=layout.decimal,
                    null_values=[""],
                    check_utf8=False,
                ),
            )
        except pa.ArrowException:
            return self._read_slowly(positions)
        return [np.asarray(table.column(names[i]).to_numpy(), dtype=np.float64) for i in positions]

    def texts(self, positions: Sequence[int]) -> list[str]:
        """See Table."""
        data = bytes(self._data[self._layout.offset :]).strip(b"\r\n")
        first, last = (_decode(line) for line in (data.split(b"\n", 1)[0], data.rsplit(b"\n", 1)[-1]))
        both = zip(*(_cells(str(self.path), line, self._layout.separator) for line in (first, last)), strict=False)
        same = [one.strip() if one.strip() == other.strip() else "" for one, other in both]
        return [same[i] if i < len(same) else "" for i in positions]

    def _rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line number and cells of every row but those that hold no number at all, a last one that is cut short, and a
        few of another width. Raises InputError where these are more.
        """
        start, line, begun, counted = self._layout.offset, self._layout.line, False, False
        width, odd, rows = len(self.names), 0, 0
        while start < len(self._data):
            end = self._data.find(b"\n", start)
            end = len(self._data) if end < 0 else end
            where = f"{self.path}: line {line}"
            if end - start > _LONGEST_LINE:
                raise InputError(where, f"{end - start} bytes", f"lines of at most {_LONGEST_LINE}")
            text = _decode(self._data[start:end]).strip(" ")
            if text.strip() and not text.startswith(_COMMENT):
                cells = _cells(where, text, self._layout.separator)
                if len(cells) < width and not self._data[end:].strip():
                    self._leave_out(f"Line {line}, the last one, is cut short: skipped.")
                elif len(cells) != width:
                    odd += 1
                    if odd > 1 + _MOST_ODD * rows:
                        accepted = f"{width}, as in the first row"
                        raise InputError(f"{self.path}: row {rows + 1} (line {line})", f"{len(cells)} cells", accepted)
                    self._leave_out(f"Line {line} has {len(cells)} cells where the others have {width}: skipped.")
                elif begun and not any(self._says(cell) for cell in cells):
                    of_units = self._below and not self._data[end:].strip()
                    what = "the last one, holds the units" if of_units else "holds text and no number: skipped"
                    self._leave_out(f"Line {line}{',' * of_units} {what}.")
                elif begun and counted and self._is_summary(cells[0], end):
                    self._leave_out(f"Line {line}, below the rows, begins with '{cells[0][:20]}': skipped.")
                else:
                    counted = counted if begun else _number(cells[0], self._layout.decimal) is not None
                    begun, rows = True, rows + 1
                    yield line, cells
            start, line = end + 1, line + 1

    def _has_summary(self) -> bool:
        """Whether lines near the end begin with words, and the first row with a number."""
        last = self._data[max(len(self._data) - _HEAD, self._layout.offset) :].rstrip().split(b"\n")
        cells = [_cells("", _decode(line), self._layout.separator)[:1] for line in last[-_MOST_BELOW:] if line]
        numbers = [_number(one[0], self._layout.decimal) is not None for one in cells if one]
        return not all(numbers) and any(numbers[:1])

    def _is_summary(self, cell: str, end: int) -> bool:
        """Whether a line near the end of the file, at byte ``end``, begins with a word: a mean, a sum."""
        return not self._says(cell) and self._data.count(b"\n", end) <= _MOST_BELOW

    def _says(self, cell: str) -> bool:
        """Whether a cell is a number, a time, or empty."""
        return _number(cell, self._layout.decimal) is not None or Clock().seconds(cell) is not None

    def _leave_out(self, said: str) -> None:
        if said not in self.mended:
            self.mended.append(said)

    def _read_slowly(self, positions: Sequence[int]) -> list[FloatArray]:
        """Cell by cell: to say where the fast reader stumbled, or to read what only it could not."""
        columns, clocks = [array("d") for _ in positions], [Clock() for _ in positions]
        dots: dict[int, list[int]] = {}
        for row, (line, cells) in enumerate(self._rows(), 1):
            for column, clock, i in zip(columns, clocks, positions, strict=True):
                value = _number(cells[i], self._layout.decimal)
                if value is None and (clock.first or not column):
                    value = clock.seconds(cells[i])
                elif clock.first and value is not None and not math.isnan(value):
                    value = None
                if value is None:
                    where = f"{self.path}: row {row} (line {line}), column {self.names[i] or f'#{i + 1}'}"
                    raise InputError(where, f"the text '{cells[i][:40]}'", "a number")
                column.append(value)
                if self._layout.decimal == "," and "." in cells[i]:
                    dots.setdefault(i, []).append(len(column) - 1 if _WHOLE.fullmatch(cells[i]) else -1)
        for column, i in zip(columns, positions, strict=True):
            if i in dots and -1 not in dots[i] and len(dots[i]) < len(column):  # else a decimal point of its own
                for row in dots[i]:
                    column[row] *= 1e3
        self.dated |= {i: clock.first for i, clock in zip(positions, clocks, strict=True) if clock.first}
        return [np.asarray(column, dtype=np.float64) for column in columns]

    def row(self, index: int) -> str:
        """See Table; the line of the file beside it."""
        for row, (line, _) in enumerate(self._rows()):
            if row == index:
                return f"row {index + 1} (line {line})"
        return f"row {index + 1}"


TEXT = Reader(
    name="text tables, also gzipped",
    suffixes=(".csv", ".txt", ".dat", ".tsv", ".asc", ".tab", ".lvm", ".log", ".prn", ".mot", ".sto", ".vbo"),
    open=TextTable,
    text=True,
)
