"""What is known of how a program lays out a table in text; a file in harness/io/layouts makes one."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

DECIMAL_COMMA = re.compile(r"^[+-]?(?:\d+|\d{1,3}(?:\.\d{3})+),\d+([eE][+-]?\d+)?$")
_THOUSANDS = re.compile(r"^[+-]?\d{1,3}(?:,\d{3})+\.\d+$")
"""A number that says that a comma parts thousands."""
_WHOLE = re.compile(r"^[+-]?(?:\d{1,3}(?:,\d{3})+|\d+)$")
NUMBER = re.compile(r"^[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?$|^nan$", re.IGNORECASE)


@dataclass(frozen=True, slots=True, kw_only=True)
class Head:
    """Where a table stands in a text.

    first : index of its first row among the lines; None where it is to be looked for. fields, units : of its
    columns, a unit "" where none is said. separator : "" for runs of blanks. decimal : mark. rate : Hz, where the
    file says its step and gives no time. said : what else there is, a sentence for people. own : whether x, v, a
    may be taken for this program's names. plain : what each line is to be replaced by first.
    """

    first: int | None = None
    fields: tuple[str, ...] = ()
    units: tuple[str, ...] = ()
    separator: str = "\t"
    decimal: str = "."
    rate: float | None = None
    own: bool = True
    plain: Callable[[str], str] | None = None
    said: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """How a program lays out a table. name : as messages say it. find : the table by the first lines and the name of
    the file, None where they are none of it; it must bear whatever stands in them.
    """

    name: str
    find: Callable[[Sequence[str], str], Head | None]


def separator_of(lines: Sequence[str]) -> tuple[str, str]:
    """The separator and decimal mark of lines, the last of which is a row."""
    last = lines[-1]
    cells = [cell.strip('"') for cell in re.split(r"[;\t\s]+", last)]
    pointed = any(map(_THOUSANDS.match, cells))
    commas = [cell for cell in cells if DECIMAL_COMMA.match(cell) and not pointed]
    text = any(character.isalpha() for character in lines[0])
    if "," not in lines[0] and text and all(map(DECIMAL_COMMA.match, lines[1:])):
        # one name above each pair of digits: a single column
        return ";", ","
    quoted = re.findall(r'"([^"]*)"', last) if not pointed else []
    if ";" not in last and "\t" not in last and any(map(DECIMAL_COMMA.match, quoted)):
        return ",", "," if not all(map(_WHOLE.match, quoted)) else "."
    for separator in (";", "\t", ","):
        # tabs and blanks may part the numbers of one line
        mixed = separator == "\t" and any(len(cell.split()) > 1 and is_row(cell.split()) for cell in last.split("\t"))
        if separator in last and not mixed:
            return separator, "," if separator != "," and commas else "."
    # a single column's name may have blanks
    single = len(last.split()) == 1 and not any("," in line for line in lines)
    return ";" if single else "", "."


def rate_of(text: str) -> float | None:
    """A rate or a step that a header tells, with its unit or without; None for what is no number above 0."""
    found = re.match(r"\s*(\d{0,12}[.,]?\d{1,12}(?:[eE][+-]?\d{1,3})?)", text)
    value = float(found[1].replace(",", ".")) if found else 0.0
    return value if value > 0.0 else None


def is_row(cells: Sequence[str]) -> bool:
    """Whether these are numbers, or empty, and not all of them empty."""
    return any(cell.strip() for cell in cells) and all(not c.strip() or NUMBER.match(c.strip()) for c in cells)
