"""Where results go: standard output, a JSON file, a table for people."""

import math
import os
import re
import shlex
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from harness.cli.progress import shown
from harness.core.errors import InputError, visible
from harness.core.quantity import Quantity

if TYPE_CHECKING:
    from harness.app.shared.progress import Progress
    from harness.results.common import P
    from harness.results.robot import PasteResult

R = TypeVar("R")


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


@dataclass(frozen=True, slots=True)
class Output:
    """Where a result goes. out : the folder, None for one named after the time. json_to : "-" is standard output.

    Raises InputError or StoreError for a JSON file that could not be written, before any work is done.
    """

    json_to: str | None
    quiet: bool
    out: Path | None = None

    def __post_init__(self) -> None:
        if self.json_to == STANDARD_OUTPUT and sys.stdout is None:
            raise InputError("--json -", "standard output is closed", "an open one, or a file, is accepted")
        if self.json_to is not None and self.json_to != STANDARD_OUTPUT:
            from harness.app.shared.deliver import check_writable

            check_writable(Path(self.json_to))

    @property
    def tables(self) -> bool:
        """Whether people are to read standard output."""
        return not self.quiet and self.json_to != STANDARD_OUTPUT

    def told(self) -> "AbstractContextManager[Progress]":
        """The Progress that people see, while the block runs."""
        return shown(self.quiet)

    def give(
        self, result: R, tables: Callable[[R], None], text: "Callable[[R], str | Iterable[str]] | None" = None
    ) -> None:
        """Write the result where --json says, and for people what ``tables`` prints.

        text : of what is no Result, as JSON, or pieces of it.
        """
        from harness.app.shared.deliver import to_json, write_text

        if self.json_to is not None:
            said = (text or to_json)(result)  # type: ignore[arg-type]
            if self.json_to != STANDARD_OUTPUT:
                write_text(Path(self.json_to), said)
            else:
                sys.stdout.writelines([said] if isinstance(said, str) else said)
                sys.stdout.flush()
        if self.tables:
            tables(result)


def say(text: str) -> None:
    """Print sentences for people, wrapped at words where a line has a width; nothing in them that a terminal obeys."""
    click.echo(wrapped(visible(text), line_width()))


def say_as_it_is(text: str) -> None:
    """Print what is to be copied: its lines stay as long as they are."""
    click.echo(visible(text))


def say_all(sentences: Iterable[str]) -> None:
    """Print each as an item of a list."""
    for sentence in sentences:
        say(f"- {sentence}")


def say_left_out() -> None:
    """Name the engines that are usually taken and that this Python cannot have."""
    from harness.app.shared.machine import left_out

    say_all(left_out())


def say_paste(paste: "PasteResult") -> None:
    """Print what goes into a robot's model."""
    say("to paste into your model (MJCF; URDF with PyBullet's calls):")
    for line in (paste.mjcf, *paste.urdf.splitlines()):
        say_as_it_is(f"  {line}")


def this_line() -> str:
    """The command line as somebody would type it again; "" when the program was not started by one."""
    is_ours = Path(sys.argv[0]).name in ("harness", "__main__.py")
    return shlex.join(["harness", *sys.argv[1:]]) if is_ours else ""


def figure(value: float | None, spec: str = ".4g", after: str = "", times: float = 1.0, before: str = "") -> str:
    """A number with what stands before and after it, "-" for none."""
    return "-" if value is None else f"{before}{times * value:{spec}}{after}"


def with_error(number: "P | None", said: str = "") -> str:
    """A value to the second digit of its standard error, "-" for one that was refused; said : a unit said elsewhere."""
    if number is None or number.value is None:
        return "-"
    unit = "" if number.unit in ("1", said) else f" {number.unit}"
    if not number.stderr:
        return f"{number.value:.6g}{unit}"
    if number.stderr >= _LARGE:
        return str(Quantity(number.value, number.stderr, unit.strip() or "1"))
    decimals = min(max(1 - math.floor(math.log10(number.stderr)), 0), 12)
    return f"{number.value:.{decimals}f} +- {number.stderr:.{decimals}f}{unit}"
