"""Figures of rows as distances from exact, and settings as points: a score over their scenarios, and its cost."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from harness.engines.base import PRESETS
from harness.fidelity.kind import Figure, Row, kind, kinds
from harness.fidelity.matrix import FINE


def figures_of(scenario: str) -> tuple[Figure, ...]:
    """The columns that rows of a scenario fill."""
    return kind(scenario).figures


COLUMNS = tuple((name, figure) for name, one in kinds().items() if one.part == "suite" for figure in one.figures)
"""Every figure of the scorecard with the name of its scenario."""
FIGURES = tuple(figure for _, figure in COLUMNS)
LABELS = tuple(figure.label for figure in FIGURES)


def distance(row: Row, figure: Figure) -> float | None:
    """How far a row is from exact in this figure; None when it has none."""
    value = row["metrics"].get(figure.metric)
    if value is None:
        return None
    scale = figure.scale(row)
    return abs(value - float(row["exact"].get(figure.metric, 0.0))) / scale if scale > 0.0 else None


def badness(row: Row) -> float:
    """The worst figure of a row, inf for one that could not be run; what "worst rows" are sorted by."""
    if row["error"] is not None:
        return math.inf
    mine = [distance(row, figure) for figure in figures_of(row["scenario"])]
    return max((value for value in mine if value is not None), default=0.0)


@dataclass(slots=True)
class Card:
    """One line of the scorecard; values and rows by the labels of FIGURES. errors : reasons of rows that failed."""

    engine: str
    version: str
    environment: str
    route: str
    preset: str
    dt_s: float | None = None
    values: dict[str, float | None] = field(default_factory=dict)
    rows: dict[str, Row] = field(default_factory=dict)
    errors: list[str] = field(default_factory=list)


def of_suite(row: Row) -> bool:
    """Whether the scenario of a row is one of the suite, which scores are made of."""
    return kind(row["scenario"]).part == "suite"


def is_card_row(row: Row) -> bool:
    """Whether a row belongs to the scorecard: what ships at its own step, or tuned at 1 ms (or its nearest step)."""
    if row["draw"] or row["changed"] or row["preset"] not in PRESETS or not of_suite(row):
        return False
    own = "dt=own" in row["name"]
    return own if row["preset"] == "as-shipped" else row["dt_s"] is not None


def cards(rows: Iterable[Row]) -> list[Card]:
    """The scorecard, as shipped before tuned, engine by engine and route by route."""
    found: dict[tuple[str, ...], Card] = {}
    for row in rows:
        if not is_card_row(row):
            continue
        key = (row["engine"], row["version"], row["environment"], row["route"], row["preset"])
        card = found.setdefault(key, Card(*key, row["dt_s"]))
        if row["preset"] == "tuned" and _nearer(row["dt_s"], card.dt_s):
            card = found[key] = Card(*key, row["dt_s"])
        if card.dt_s is None:  # the first could not be run, and does not know the engine's own step
            card.dt_s = row["dt_s"]
        if row["dt_s"] not in (None, card.dt_s):
            continue
        if row["error"] is not None:
            card.errors.append(f"{row['scenario']}: {row['error']}")
        for figure in figures_of(row["scenario"]):
            card.values[figure.label] = distance(row, figure)
            card.rows[figure.label] = row
    order = {name: place for place, name in enumerate(("joint", "contact", "law"))}

    def place(card: Card) -> tuple[int, str, str, str, int]:
        return order.get(card.route, 9), card.engine, card.version, card.environment, PRESETS.index(card.preset)

    return sorted(found.values(), key=place)


def _nearer(dt: float, than: float | None) -> bool:
    """Whether a step is nearer to 1 ms, by ratio."""
    return than is None or abs(math.log(dt / FINE)) < abs(math.log(than / FINE)) - 1e-9


FLOOR = 1e-6
"""Distances below this are as good as exact: a score is not improved by a creep of 1e-16."""


@dataclass(slots=True)
class Point:
    """One set of settings. logs : log of every distance. cost : wall s per s of motion, over scenarios."""

    row: Row
    logs: list[float] = field(default_factory=list)
    wall: float = 0.0
    motion: float = 0.0
    scenarios: set[str] = field(default_factory=set)

    def add(self, row: Row) -> None:
        if row["error"] is not None:
            return
        self.scenarios.add(row["scenario"])
        self.wall += row["wall_s"] or 0.0
        self.motion += row["setup"]["duration_s"]
        for figure in figures_of(row["scenario"]):
            value = distance(row, figure)
            if value is not None:
                self.logs.append(math.log(max(value, FLOOR)))

    @property
    def score(self) -> float:
        """Geometric mean of the distances; lower is better, FLOOR is exact."""
        return math.exp(sum(self.logs) / len(self.logs)) if self.logs else math.inf

    @property
    def cost(self) -> float:
        """Wall time for one second of motion, s."""
        return self.wall / self.motion if self.motion else math.inf


def points(rows: Iterable[Row]) -> list[Point]:
    """The suite's own sliders by settings; those that ran fewer scenarios than others of their route are left out."""
    found: dict[tuple[Any, ...], Point] = {}
    for row in rows:
        if not row["draw"] and of_suite(row):
            key = (
                row["engine"],
                row["version"],
                row["environment"],
                row["route"],
                row["preset"],
                repr(row["changed"]),
                row["dt_s"],
            )
            found.setdefault(key, Point(row)).add(row)
    most: dict[str, int] = {}
    for point in found.values():
        most[point.row["route"]] = max(most.get(point.row["route"], 0), len(point.scenarios))
    return [point for point in found.values() if len(point.scenarios) == most[point.row["route"]] and point.wall > 0.0]


def front(candidates: list[Point]) -> list[Point]:
    """Those that nothing beats in both score and cost."""
    best: list[Point] = []
    for point in sorted(candidates, key=lambda one: (one.cost, one.score)):
        if not best or point.score < best[-1].score:
            best.append(point)
    return best


def settings_of(row: Row) -> str:
    """The settings of a row in one line: preset, integrator, step, and what was changed."""
    changed = ", ".join(f"{name} {_text(value)}" for name, value in row["changed"].items() if name != "integrator")
    step = "" if row["dt_s"] is None else f"{row['dt_s'] * 1e3:.4g} ms"
    return ", ".join(filter(None, (row["preset"], row["integrator"], step, changed)))


def _text(value: object) -> str:
    if isinstance(value, list):
        return " ".join(_text(inner) for inner in value)
    return f"{value:.5g}" if isinstance(value, float) else str(value)
