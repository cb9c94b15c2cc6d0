"""What a page is made of: sections, tables, figures."""

import base64
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray


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


@dataclass(frozen=True, slots=True)
class Figure:
    """One plot.

    name : unique on the page. traces, layout : plotly's; NumPy arrays may stand for lists. caption : a sentence below.
    group : figures of one group zoom together along x. height : pixels.
    Colours may be "ink", "muted" or "rule": the page's own, in light and dark.
    """

    name: str
    traces: Sequence[Mapping[str, Any]]
    layout: Mapping[str, Any]
    caption: str = ""
    group: str = ""
    height: int = 340


@dataclass(slots=True)
class Pool:
    """Arrays of a page, each stored once as base64 of little-endian doubles."""

    arrays: dict[str, str] = field(default_factory=dict)

    def add(self, values: FloatArray) -> str:
        """The key under which the page finds these numbers; nan draws a gap."""
        data = np.ascontiguousarray(values, dtype="<f8").tobytes()
        key = hashlib.blake2b(data, digest_size=6).hexdigest()
        self.arrays.setdefault(key, base64.b64encode(data).decode("ascii"))
        return key

    def spec(self, figure: Figure) -> dict[str, Any]:
        """The figure as JSON, arrays replaced by {"$": key}."""
        return {
            "name": figure.name,
            "traces": self._plain(figure.traces),
            "layout": self._plain(figure.layout),
            "group": figure.group,
        }

    def _plain(self, value: object) -> Any:
        if isinstance(value, np.ndarray):
            return {"$": self.add(value)}
        if isinstance(value, np.generic):
            return value.item()
        if isinstance(value, Mapping):
            return {key: self._plain(inner) for key, inner in value.items()}
        if isinstance(value, (list, tuple)):
            return [self._plain(inner) for inner in value]
        return value


def script_json(value: object) -> str:
    """JSON that can stand inside a script element whatever text it holds."""
    return json.dumps(value, allow_nan=False).replace("<", "\\u003c").replace("\u2028", "\\u2028")


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a page: its heading, and in the table of contents; a template and what that shows.

    template : a file in ``templates``, filled with ``context``; ``macros.html.j2`` shows tables and figures.
    """

    title: str
    template: str
    context: Mapping[str, Any]
