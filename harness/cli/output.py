"""Where results go: standard output, a JSON file, a table for people.

Tables are printed as they are where they fit, on their side where they do not. No cell is ever cut.
"""

import math
import os
import re
import shlex
import shutil
import sys
import textwrap
from collections.abc import Callable, Collection, Iterable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from harness.cli.progress import shown
from harness.core.errors import InputError, visible
from harness.core.quantity import Quantity, outweighs

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

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
            raise InputError("--json -", "standard output is closed", "an open one, or a file")
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
    for line in (*paste.mjcf.splitlines(), *paste.urdf.splitlines()):
        say_as_it_is(f"  {line}")
    if paste.isaac:
        say("the page and --json have it for Isaac Lab, Newton, SDF, Genesis, Drake and a ROS 2 controller")


_TYPED: list[str] = []


def typed(words: Sequence[str]) -> None:
    """Keep the command line that is being run, without the program's name."""
    _TYPED[:] = ["harness", *words]


def this_line() -> str:
    """The command line as somebody would type it again; "" where none is being run."""
    return shlex.join(_TYPED)


def figure(value: float | None, spec: str = ".4g", after: str = "", times: float = 1.0, before: str = "") -> str:
    """A number with what stands before and after it, "-" for none."""
    return "-" if value is None else f"{before}{times * value:{spec}}{after}"


def with_error(number: "P | None", said: str = "") -> str:
    """A value to the second digit of its standard error, "-" for one that was refused.

    A systematic error that is larger stands below it. said : a unit said elsewhere.
    """
    if number is None or number.value is None:
        return "-"
    unit = "" if number.unit in ("1", said) else f" {number.unit}"
    if not number.stderr:
        return f"{number.value:.4g}{unit}"
    if number.stderr >= _LARGE:
        return str(Quantity(number.value, number.stderr, unit.strip() or "1"))
    decimals = min(max(1 - math.floor(math.log10(number.stderr)), 0), 12)
    systematic = f"\nsyst. +- {number.systematic:.2g}" if outweighs(number.systematic, number.stderr) else ""
    return f"{number.value:.{decimals}f} +- {number.stderr:.{decimals}f}{unit}{systematic}"


_AMPLE = 10_000
"""A width that every table fits in."""


def show(table: "Table") -> None:
    """Print a table of plain text, without columns that say nothing, within the width there is; as wide as it needs to
    be where nothing sets one.

    One that is too wide has headings of a word a line, and fewer lines between; else its rows as columns; where that
    is too wide as well, each row is a list of "heading: cell".
    """
    width, ample = line_width(), _plain(_AMPLE)
    first, *others = table.columns
    table.columns = [first, *(one for one in others if any(str(cell) not in ("", "-") for cell in one.cells))]
    if table.title:
        _print(wrapped(visible(str(table.title)), width), ample)
        table.title = None
    if width is None or _needs(table, ample) <= width:
        _print(table, ample)
        return
    for turned in (_narrow(table), _turned(table, False), _turned(table, True)):
        if _needs(turned, ample) <= width:
            _print(turned, ample)
            return
    for line in _listed(table):
        _print(wrapped(visible(line), width), ample)


def show_rows(
    headings: Sequence[str], rows: Iterable[Sequence[str]], left: Collection[str] = (), title: str | None = None
) -> None:
    """Print rows under headings; cells below those in ``left`` (the first, where none is named) begin at the left."""
    from rich.table import Table

    table = Table(title=title)
    for heading in headings:
        table.add_column(heading, justify="left" if heading in (left or headings[:1]) else "right")
    for row in rows:
        table.add_row(*row)
    show(table)


def _plain(width: int) -> "Console":
    from rich.console import Console
    from rich.text import Text

    class Plain(Console):
        """Shows cells as they are: no markup in brackets, no names of emoji, nothing that a terminal would obey."""

        def render_str(self, text: str, **style: Any) -> Text:
            return super().render_str(visible(text), **style)

    return Plain(width=width, highlight=False, markup=False, emoji=False)


def _needs(table: "Table", ample: "Console") -> int:
    return ample.measure(table).maximum


def _print(shown: "Table | str", ample: "Console") -> None:
    ample.print(shown, no_wrap=True, overflow="ignore", crop=False)


def _cells(table: "Table") -> tuple[list[str], list[list[str]]]:
    """Headings, and the rows."""
    columns = [[str(cell) for cell in column.cells] for column in table.columns]
    return [str(column.header) for column in table.columns], [list(row) for row in zip(*columns, strict=True)]


def _narrow(table: "Table") -> "Table":
    """The same with headings of a word a line, units whole, and no lines between columns."""
    from rich import box
    from rich.table import Table

    narrow = Table(box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False, padding=(0, 1, 0, 0))
    for column in table.columns:
        said, _, unit = str(column.header).partition(", ")
        heading = "\n".join([*said.split(), *filter(None, [unit])])
        narrow.add_column(heading, justify=column.justify, no_wrap=True)
    for row in _cells(table)[1]:
        narrow.add_row(*row)
    return narrow


def _turned(table: "Table", narrow: bool) -> "Table":
    """Rows as columns, headings as the first of them; narrow has no lines, and headings of a word a line."""
    from rich import box
    from rich.table import Table

    headings, rows = _cells(table)
    turned = Table(box=box.SIMPLE_HEAD if narrow else box.HEAVY_HEAD, show_edge=not narrow, pad_edge=not narrow)
    turned.add_column(headings[0], no_wrap=True)
    for row in rows:
        turned.add_column("\n".join(row[0].split()) if narrow else row[0], justify="right", no_wrap=True)
    for place, heading in enumerate(headings[1:], 1):
        turned.add_row(heading, *(row[place] for row in rows))
    return turned


def _listed(table: "Table") -> list[str]:
    """Each row as its first cell and, below it, what its others are."""
    headings, rows = _cells(table)
    lines = []
    for row in rows:
        first = ", ".join(row[0].split("\n"))
        lines.append(f"{headings[0]}: {first}" if headings[0] else first)
        for heading, cell in zip((" ".join(one.split()) for one in headings[1:]), row[1:], strict=True):
            said = ", ".join(cell.split("\n"))
            if said:
                lines.append(f"  {heading}: {said}" if heading else f"  {said}")
    return lines
