"""Tables for people: as they are where they fit, on their side where they do not. No cell is ever cut."""

from collections.abc import Collection, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from harness.cli.output import line_width, wrapped
from harness.core.errors import visible

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

_AMPLE = 10_000
"""A width that every table fits in."""


def show(table: "Table") -> None:
    """Print a table of plain text within the width there is; as wide as it needs to be where nothing sets one.

    One that is too wide has its rows as columns; where that is too wide as well, each row is a list of "heading: cell".
    """
    width, ample = line_width(), _plain(_AMPLE)
    if table.title:
        _print(wrapped(visible(str(table.title)), width), ample)
        table.title = None
    if width is None or _needs(table, ample) <= width:
        _print(table, ample)
        return
    for narrow in (False, True):
        if _needs(turned := _turned(table, narrow), ample) <= width:
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


def _turned(table: "Table", narrow: bool) -> "Table":
    """Rows as columns, headings as the first of them; narrow has no lines, and headings of a word a line."""
    from rich import box
    from rich.table import Table

    headings, rows = _cells(table)
    turned = Table(box=box.SIMPLE_HEAD if narrow else box.HEAVY_HEAD, show_edge=not narrow)
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
        lines.append(row[0] if not headings[0] else f"{headings[0]}: {row[0]}")
        for heading, cell in zip(headings[1:], row[1:], strict=True):
            said = ", ".join(cell.split("\n"))
            if said:
                lines.append(f"  {heading}: {said}" if heading else f"  {said}")
    return lines
