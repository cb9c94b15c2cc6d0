"""Tables of a page."""

from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Cell:
    """text : the value. notes : small lines below it. grade : 0 (as good as exact) to 4 (far off), None for no colour.

    hint : shown on hovering.
    """

    text: str
    notes: Sequence[str] = ()
    grade: int | None = None
    hint: str = ""


@dataclass(frozen=True, slots=True)
class Column:
    """head : the heading. unit : of every value in it. hint : what it means, in a sentence."""

    head: str
    unit: str = ""
    hint: str = ""


@dataclass(frozen=True, slots=True)
class Row:
    """head : what the row is about. note : small, below it. color : of the source, "" for none."""

    head: str
    cells: Sequence[Cell]
    note: str = ""
    color: str = ""


@dataclass(frozen=True, slots=True)
class Table:
    """title, caption : above it. corner : heading of the row heads. footnotes : sentences below."""

    corner: str
    columns: Sequence[Column]
    rows: Sequence[Row]
    caption: str = ""
    title: str = ""
    footnotes: Sequence[str] = field(default_factory=tuple)


def grade(relative: float | None, steps: tuple[float, float, float, float] = (1e-4, 2e-3, 1e-2, 5e-2)) -> int | None:
    """0 to 4: how many of the steps a relative error exceeds; None for none."""
    return None if relative is None else sum(abs(relative) > step for step in steps)
