"""Racelogic's VBOX: sections of names and data, and times of day that are written as hhmmss.ss, in its own files and in
tables made of them.
"""

import re
from collections.abc import Callable, Sequence

from harness.io.layout import Head, Layout

_CLOCK = re.compile(r"(\d\d?)([0-5]\d)([0-5]\d(?:[.,]\d{1,9})?)")
_SAID = re.compile(r"(?<!\s)\s*[\[(]\s*hhmmss(?:\.s{1,6})?\s*[\])]", re.IGNORECASE)
"""What a header says of such a time; a run of blanks is looked through once, however long."""


def _find(lines: Sequence[str], name: str) -> Head | None:
    sections = [line.strip().lower() for line in lines]
    if {"[column names]", "[data]"} <= set(sections):
        short = lines[sections.index("[column names]") + 1].split()
        fields = [one.strip() for one in _section(lines, sections, "[header]")]
        fields = fields if len(fields) == len(short) else short
        at = next((i for i, field in enumerate(fields) if field.lower() == "time"), len(fields))
        first = sections.index("[data]") + 1
        return Head(first=first, fields=tuple(fields), separator="", plain=_clocked(at, " ")) if fields else None
    said = next((line for line in lines if _SAID.search(line)), "")
    separator = next((one for one in (";", "\t", ",") if one in said), "")
    if not separator:
        return None
    at = next(i for i, cell in enumerate(said.split(separator)) if _SAID.search(cell))
    return Head(plain=_clocked(at, separator))


def _section(lines: Sequence[str], sections: Sequence[str], of: str) -> list[str]:
    begin = sections.index(of) + 1 if of in sections else len(sections)
    end = next((i for i in range(begin, len(sections)) if sections[i].startswith("[")), begin)
    return [line for line in lines[begin:end] if line.strip()]


def _clocked(at: int, separator: str) -> Callable[[str], str]:
    """Writes a time of a line as hh:mm:ss, and takes its form out of a header."""

    def plain(line: str) -> str:
        cells = _SAID.sub("", line).strip("\r").split(separator)
        if at < len(cells) and (found := _CLOCK.fullmatch(cells[at].strip())):
            cells[at] = ":".join((found[1], found[2], found[3]))
        return separator.join(cells)

    return plain


LAYOUT = Layout(name="Racelogic VBOX", find=_find)
