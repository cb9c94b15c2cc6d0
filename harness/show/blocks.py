"""What tells a result: blocks (sentences, tables, figures) under headings, made once and drawn by every renderer."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.wording import capitalised
from harness.results.common import P
from harness.show.numbers import NONE, number, quantity, systematic


@dataclass(frozen=True, slots=True)
class Cell:
    """text : the value. notes : small lines below it. grade : 0 (as good as exact) to 4 (far off), None for no colour.

    hint : shown on hovering.
    """

    text: str
    notes: Sequence[str] = ()
    grade: int | None = None
    hint: str = ""


Shown: TypeAlias = Cell | str | float | None
"""What stands for an item in a column: a text, a number, None for a dash."""
_SEVERAL = 2
"""Rows from which on a column of dashes says nothing."""


@dataclass(frozen=True, slots=True)
class Column:
    """head : the heading. of : what stands in it for an item.

    unit : of every value in it. hint : what it means, in a sentence.
    """

    head: str
    of: Callable[[Any], Shown]
    unit: str = ""
    hint: str = ""


@dataclass(frozen=True, slots=True)
class Row:
    """head : what the row is about. note : small, below it. color : of the source. link : of the head."""

    head: str
    cells: Sequence[Cell]
    note: str = ""
    color: str = ""
    link: str = ""


@dataclass(frozen=True, slots=True)
class Table:
    """corner : heading of the row heads. title, caption : above it. footnotes : sentences below.

    compact : it stays whole on a phone, where the notes of its cells are left out.
    """

    corner: str
    columns: Sequence[Column]
    rows: Sequence[Row]
    caption: str = ""
    title: str = ""
    footnotes: Sequence[str] = ()
    compact: bool = False


@dataclass(frozen=True, slots=True)
class Legend:
    """What the colours of cells mean. labels : of the grades 0 to 4."""

    labels: Sequence[str]


@dataclass(frozen=True, slots=True)
class Figure:
    """One plot, on a page or in a trace.

    name : unique among them. traces, layout : plotly's; NumPy arrays may stand for lists. caption : a sentence below.
    group : figures of one group zoom together along x. height : pixels. around : times, s, at which no sample of a
    curve is left out however many it has. least : pixels of its width, below which its place scrolls. Colours may be
    "ink", "muted", "rule" or "middle": the page's own, in light and dark.
    """

    name: str
    traces: Sequence[Mapping[str, Any]]
    layout: Mapping[str, Any]
    caption: str = ""
    group: str = ""
    height: int = 340
    around: FloatArray = field(default_factory=lambda: np.empty(0))
    least: int = 0


@dataclass(frozen=True, slots=True)
class Text:
    """A paragraph. kind : "" or "verdict", "heading", "table-caption". link : text and address at its end."""

    text: str
    kind: str = ""
    link: tuple[str, str] | None = None


@dataclass(frozen=True, slots=True)
class Items:
    """Sentences, one below the other. title : above them. ordered : numbered. small : as footnotes."""

    sentences: Sequence[str]
    title: str = ""
    ordered: bool = False
    small: bool = False


@dataclass(frozen=True, slots=True)
class Facts:
    """Names and what there is to say of each. said : in sentences, else in figures."""

    pairs: Mapping[str, str]
    said: bool = False


@dataclass(frozen=True, slots=True)
class Code:
    """Text to copy. title, intro : above it."""

    text: str
    title: str = ""
    intro: str = ""


@dataclass(frozen=True, slots=True)
class Card:
    """An engine: name, colour, a line, what it ignores in sentences, its settings."""

    head: str
    color: str
    line: str
    ignored: Sequence[str]
    settings: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Cards:
    """Engines side by side."""

    cards: Sequence[Card]


@dataclass(frozen=True, slots=True)
class Zoom:
    """A bar of buttons: a label and a range of time (s) each, for figures of one group. to : what these show."""

    buttons: Sequence[tuple[str, tuple[float, float]]]
    group: str
    to: str = "a reversal"


@dataclass(frozen=True, slots=True)
class Folded:
    """Blocks that are looked at on demand. summary : what they are."""

    summary: str
    blocks: Sequence["Block"]
    open: bool = False


Block: TypeAlias = Text | Items | Facts | Table | Legend | Figure | Code | Cards | Zoom | Folded


@dataclass(frozen=True, slots=True)
class Section:
    """A heading, also in the table of contents, and what stands below it."""

    title: str
    blocks: Sequence[Block]


@dataclass(frozen=True, slots=True)
class Page:
    """title : what it is about. subtitle : one line below it."""

    title: str
    subtitle: str
    sections: Sequence[Section]


def tabulated(
    corner: str,
    columns: Sequence[Column],
    items: Sequence[Any],
    head: Callable[[Any], str],
    note: Callable[[Any], str] = lambda _: "",
    color: Callable[[Any], str] = lambda _: "",
    caption: str = "",
    title: str = "",
    footnotes: Sequence[str] = (),
    reasons: "Reasons | None" = None,
    compact: bool = False,
    link: Callable[[Any], str] = lambda _: "",
) -> Table:
    """A table of a row an item, without columns that have a dash for each of several.

    head, note, color, link : of an item. reasons : footnotes that the columns make.
    """
    cells = [[cell(column.of(one)) for one in items] for column in columns]
    told = [len(items) < _SEVERAL or any(one.text not in ("", "-", NONE) or one.notes for one in own) for own in cells]
    kept = [own for own, tells in zip(cells, told, strict=True) if tells]
    rows = [Row(head(one), [own[i] for own in kept], note(one), color(one), link(one)) for i, one in enumerate(items)]
    said = footnotes if reasons is None else reasons.footnotes
    shown = [column for column, tells in zip(columns, told, strict=True) if tells]
    return Table(corner, shown, rows, caption, title, said, compact)


def by(key: Any, of: Callable[[Any, Any], Shown]) -> Callable[[Any], Shown]:
    """What stands in a column for an item where that depends on the column's own key."""
    return lambda one: of(one, key)


def cell(value: Shown) -> Cell:
    return value if isinstance(value, Cell) else Cell(value if isinstance(value, str) else number(value))


def lines(said: Sequence[str]) -> Cell:
    """Several values below one another."""
    return Cell(said[0], tuple(said[1:])) if said else Cell("-")


class Reasons:
    """Why values of a table are missing: each is marked in its cell and said below the table."""

    def __init__(self, marks: Callable[[int], str] = lambda index: str(index + 1)) -> None:
        self._marks, self._said = marks, list[str]()

    def mark(self, why: str) -> str:
        """What stands for a reason."""
        if why not in self._said:
            self._said.append(why)
        return f"({self._marks(self._said.index(why))})"

    @property
    def footnotes(self) -> list[str]:
        return [f"{self.mark(why)} {why}" for why in self._said]


def measured(p: P | None, reasons: Reasons | None = None, grade: int | None = None) -> Cell:
    """A value with its standard error below it, below that a larger systematic one.

    reasons : where those for what is missing are kept, with the mark of each.
    """
    if p is None:
        return Cell(NONE, grade=grade)
    value, stderr, _ = quantity(p)
    notes = [*([f"± {stderr}"] if stderr else []), *filter(None, [systematic(p)])]
    if reasons is not None and p.why:
        notes.append(reasons.mark(p.why))
    return Cell(value, notes, grade)


def grade(relative: float | None, steps: tuple[float, float, float, float] = (1e-4, 2e-3, 1e-2, 5e-2)) -> int | None:
    """0 to 4: how many of the steps a relative error exceeds; None for none."""
    return None if relative is None else sum(abs(relative) > step for step in steps)


def verdict(
    headline: str, sentences: Sequence[str] = (), about: Sequence[str] = (), heading: str = "What came out"
) -> Section:
    """headline : one or two sentences. sentences : what differs and why.

    about : names; sentences that begin with one of them and a colon are put together.
    """
    grouped: dict[str, list[str]] = {}
    rest = []
    for sentence in sentences:
        who, colon, said = sentence.partition(": ")
        if colon and who in about:
            grouped.setdefault(who, []).append(capitalised(said))
        else:
            rest.append(sentence)
    blocks: list[Block] = [Text(headline, "verdict")] if headline else []
    blocks += [Facts({name: " ".join(said) for name, said in grouped.items()}, said=True)] if grouped else []
    return Section(heading, [*blocks, *([Items(rest)] if rest else [])])
