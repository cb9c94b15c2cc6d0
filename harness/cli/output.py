"""Where results go: standard output, a JSON file, a table for people."""

import math
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.core.errors import InputError
from harness.core.visible import visible

if TYPE_CHECKING:
    from rich.table import Table

    from harness.results.common import P, Result

STANDARD_OUTPUT = "-"


def check_json(json_to: str | None) -> None:
    """Refuse a JSON file that could not be written, before the work is done."""
    if json_to == STANDARD_OUTPUT and sys.stdout is None:
        raise InputError("--json -", "standard output is closed", "an open one, or a file, is accepted")
    if json_to is not None and json_to != STANDARD_OUTPUT:
        from harness.app.shared.deliver import check_target

        check_target(Path(json_to))


def emit_json(result: "Result", json_to: str | None) -> None:
    """Write the result where --json says."""
    if json_to is None:
        return
    from harness.app.shared.deliver import to_json, write_json

    if json_to == STANDARD_OUTPUT:
        sys.stdout.write(to_json(result))
        sys.stdout.flush()
    else:
        write_json(result, Path(json_to))


def shows_tables(json_to: str | None, quiet: bool) -> bool:
    """Whether people are to read standard output."""
    return not quiet and json_to != STANDARD_OUTPUT


def show(table: "Table") -> None:
    """Print a table of plain text, as wide as it needs to be when it goes to a file."""
    from rich.console import Console
    from rich.text import Text

    class Plain(Console):
        """Shows cells as they are: no markup in brackets, no names of emoji, nothing that a terminal would obey."""

        def render_str(self, text: str, **style: Any) -> Text:
            return super().render_str(visible(text), **style)

    width = None if Console().is_terminal else 160
    Plain(width=width, highlight=False, markup=False, emoji=False).print(table)


def say(text: str) -> None:
    """Print a line, or several, for people; nothing in it that a terminal would obey."""
    click.echo(visible(text))


def this_line() -> str:
    """The command line as somebody would type it again; "" when the program was not started by one."""
    is_ours = Path(sys.argv[0]).name in ("harness", "__main__.py")
    return shlex.join(["harness", *sys.argv[1:]]) if is_ours else ""


def with_error(number: "P") -> str:
    """A value to the second digit of its standard error, "-" for one that was refused."""
    if number.value is None:
        return "-"
    unit = "" if number.unit in ("1", "rad/s") else f" {number.unit}"
    if not number.stderr:
        return f"{number.value:.6g}{unit}"
    decimals = min(max(1 - math.floor(math.log10(number.stderr)), 0), 12)
    return f"{number.value:.{decimals}f} +- {number.stderr:.{decimals}f}{unit}"
