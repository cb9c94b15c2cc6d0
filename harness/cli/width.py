"""How wide a line for people may be, and sentences put into that width."""

import os
import re
import shutil
import sys
import textwrap

_TIED = "\N{NO-BREAK SPACE}"
_TOGETHER = re.compile(
    r"(?<=\S) (?=(?:\+-|=)(?: |$))|(?<=\+-) |(?<= =) |(?<=\d) (?=(?:%|[mk]?(?:m|s|N|g|Hz|rad)\b|deg\b))"
)
"""The spaces in "0.05 +- 0.01", "k = 3", "7 %" and "3 mm": what they part is one thing to read."""


def line_width() -> int | None:
    """Characters of a line: COLUMNS where it is set, else those of the terminal; None where neither says anything."""
    said = os.environ.get("COLUMNS", "")
    if said.isdigit() and int(said) > 0:
        return int(said)
    if sys.stdout is None or not sys.stdout.isatty():
        return None
    return shutil.get_terminal_size().columns


def wrapped(text: str, width: int | None) -> str:
    """Each line of ``text`` at most ``width`` characters wide, broken at spaces alone, the rest under its first word.

    A word that is wider by itself (a path) has a line of its own: it is never cut. None leaves the text as it is.
    """
    if width is None:
        return text
    return "\n".join(_line(line, width) for line in text.split("\n"))


def _line(line: str, width: int) -> str:
    if len(line) <= width:
        return line
    body = line.lstrip(" ")
    begins = " " * (len(line) - len(body))
    further = begins + ("  " if body.startswith("- ") else "")
    filled = textwrap.fill(
        _TOGETHER.sub(_TIED, body),
        width,
        initial_indent=begins,
        subsequent_indent=further,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return filled.replace(_TIED, " ")
