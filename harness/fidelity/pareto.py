"""Settings as points: a score over all their scenarios, and what it costs."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from harness.fidelity.scores import distance, figures_of

Row = Mapping[str, Any]

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
        """Take one row of these settings."""
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
        if not row["draw"]:
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
