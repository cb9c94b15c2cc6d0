"""Where results go: standard output, a JSON file, a table for people."""

import math
import os
import re
import shlex
import shutil
import sys
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.core.errors import InputError, visible
from harness.core.quantity import Quantity

if TYPE_CHECKING:
    from harness.results.common import P, Result


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


STANDARD_OUTPUT = "-"
_LARGE = 1e6
"""A standard error from which digits of the value say nothing."""


def check_json(json_to: str | None) -> None:
    """Refuse a JSON file that could not be written, before the work is done."""
    if json_to == STANDARD_OUTPUT and sys.stdout is None:
        raise InputError("--json -", "standard output is closed", "an open one, or a file, is accepted")
    if json_to is not None and json_to != STANDARD_OUTPUT:
        from harness.app.shared.deliver import check_writable

        check_writable(Path(json_to))


def emit_json(result: "Result", json_to: str | None) -> None:
    """Write the result where --json says."""
    if json_to is None:
        return
    from harness.app.shared.deliver import to_json, write_text

    if json_to == STANDARD_OUTPUT:
        sys.stdout.write(to_json(result))
        sys.stdout.flush()
    else:
        write_text(Path(json_to), to_json(result))


def shows_tables(json_to: str | None, quiet: bool) -> bool:
    """Whether people are to read standard output."""
    return not quiet and json_to != STANDARD_OUTPUT


def say(text: str) -> None:
    """Print sentences for people, wrapped at words where a line has a width; nothing in them that a terminal obeys."""
    click.echo(wrapped(visible(text), line_width()))


def say_as_it_is(text: str) -> None:
    """Print what is to be copied: its lines stay as long as they are."""
    click.echo(visible(text))


def say_left_out() -> None:
    """Name the engines that are usually taken and that this Python cannot have."""
    from harness.app.shared.machine import left_out

    for sentence in left_out():
        say(f"- {sentence}")


def this_line() -> str:
    """The command line as somebody would type it again; "" when the program was not started by one."""
    is_ours = Path(sys.argv[0]).name in ("harness", "__main__.py")
    return shlex.join(["harness", *sys.argv[1:]]) if is_ours else ""


def with_error(number: "P", said: str = "") -> str:
    """A value to the second digit of its standard error, "-" for one that was refused; said : a unit said elsewhere."""
    if number.value is None:
        return "-"
    unit = "" if number.unit in ("1", said) else f" {number.unit}"
    if not number.stderr:
        return f"{number.value:.6g}{unit}"
    if number.stderr >= _LARGE:
        return str(Quantity(number.value, number.stderr, unit.strip() or "1"))
    decimals = min(max(1 - math.floor(math.log10(number.stderr)), 0), 12)
    return f"{number.value:.{decimals}f} +- {number.stderr:.{decimals}f}{unit}"
