"""The scorecard: for every engine, route and preset one line, every figure a distance from exact.

A figure is relative: 0 is exact, and 1 is as wrong as the thing measured is large. Position errors are against the
release, rest against x_k, creep in one period against x_k, leads and times against the period.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from harness.engines.base import PRESETS
from harness.fidelity import cases
from harness.fidelity.variants import FINE

Row = Mapping[str, Any]
Scale = Callable[[Row], float]


@dataclass(frozen=True, slots=True)
class Figure:
    """One column: which metric of which scenario, against what, and what a good value is."""

    label: str
    scenario: str
    metric: str
    scale: Scale
    good: str


def _start(row: Row) -> float:
    return abs(float(row["setup"]["release"]["x0"]))


def _x_k(row: Row) -> float:
    return float(row["slider"]["f_k"]) / float(row["slider"]["k"])


def _omega(row: Row) -> float:
    return math.sqrt(float(row["slider"]["k"]) / float(row["slider"]["m"]))


def _creep(row: Row) -> float:
    # a hold's spring is soft; the free decay's is what x_k and the period belong to
    k = float(row["slider"]["k"]) / cases.SOFT
    return float(row["slider"]["f_k"]) / k * math.sqrt(k / float(row["slider"]["m"])) / (2.0 * math.pi)


def _period(row: Row) -> float:
    return 2.0 * math.pi / _omega(row)


def _exact(metric: str) -> Scale:
    return lambda row: float(row["exact"][metric])


def _one(row: Row) -> float:
    return 1.0


def _belt(row: Row) -> float:
    return float(row["setup"]["action"]["speed"])


FIGURES = (
    Figure(
        "integrator", cases.FRICTIONLESS, "max_error_m", _start, "position error without friction, over the release"
    ),
    Figure(
        "position", cases.DECAY, "max_error_m", _start, "position error, over the release; at best the integrator's"
    ),
    Figure("x_k wide", cases.DECAY, "x_k_rel_error", _one, "friction as read outside a guard at each reversal"),
    Figure("x_k narrow", cases.DECAY, "x_k_local_rel_error", _one, "friction as read at the reversal itself"),
    Figure("zeta", cases.DECAY, "zeta_rel_error", _one, "damping ratio as the estimator reads it"),
    Figure("lead", cases.DECAY, "reversal_lead_s", _period, "friction reverses before the speed, over the period"),
    Figure("rest", cases.DECAY, "rest_error_m", _x_k, "place of rest, over x_k"),
    Figure("energy", cases.DECAY, "energy_error", _one, "largest error of the energy balance, over the start's"),
    Figure("creep 50 %", "hold-50", "creep_m_s", _creep, "creep in one period at half of break-away, over x_k"),
    Figure("creep 97 %", "hold-97", "creep_m_s", _creep, "creep in one period at 97 % of break-away, over x_k"),
    Figure("belt period", cases.BELT, "period_s", _exact("period_s"), "period of stick-slip"),
    Figure("stick share", cases.BELT, "stick_fraction", _one, "share of the period that sticks, difference"),
    Figure("stick speed", cases.BELT, "stick_deviation_m_s", _belt, "speed against the belt while it sticks"),
    Figure("forced", cases.HARMONIC, "amplitude_m", _exact("amplitude_m"), "amplitude without stops (Den Hartog)"),
    Figure("forced, stops", cases.STOPS, "amplitude_m", _exact("amplitude_m"), "amplitude with two stops a period"),
    Figure("stop share", cases.STOPS, "stop_fraction", _one, "share of the period that stops, difference"),
    Figure("lift", cases.DECAY, "lift_m", _start, "contact: height over the floor, over the release"),
)
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
    mine = [distance(row, figure) for figure in FIGURES if figure.scenario == row["scenario"]]
    return max((value for value in mine if value is not None), default=0.0)


@dataclass(slots=True)
class Card:
    """One line of the scorecard; values and rows by the labels of FIGURES. errors : reasons of rows that failed."""

    engine: str
    version: str
    route: str
    preset: str
    dt_s: float | None = None
    values: dict[str, float | None] = field(default_factory=dict)
    rows: dict[str, Row] = field(default_factory=dict)
    errors: list[str] = field(default_factory=list)


def is_card_row(row: Row) -> bool:
    """Whether a row belongs to the scorecard: what ships at its own step, or tuned at 1 ms (or its nearest step)."""
    if row["draw"] or row["changed"] or row["preset"] not in PRESETS:
        return False
    own = "dt=own" in row["name"]
    return own if row["preset"] == "as-shipped" else row["dt_s"] is not None


def cards(rows: Iterable[Row]) -> list[Card]:
    """The scorecard, as shipped before tuned, engine by engine and route by route."""
    found: dict[tuple[str, str, str], Card] = {}
    for row in rows:
        if not is_card_row(row):
            continue
        key = (row["engine"], row["route"], row["preset"])
        card = found.setdefault(key, Card(row["engine"], row["version"], row["route"], row["preset"], row["dt_s"]))
        if row["preset"] == "tuned" and _nearer(row["dt_s"], card.dt_s):
            card = found[key] = Card(row["engine"], row["version"], row["route"], row["preset"], row["dt_s"])
        if row["dt_s"] != card.dt_s:
            continue
        if row["error"] is not None:
            card.errors.append(f"{row['scenario']}: {row['error']}")
        for figure in FIGURES:
            if figure.scenario == row["scenario"]:
                card.values[figure.label] = distance(row, figure)
                card.rows[figure.label] = row
    order = {name: place for place, name in enumerate(("joint", "contact", "law"))}
    return sorted(found.values(), key=lambda card: (order.get(card.route, 9), card.engine, PRESETS.index(card.preset)))


def _nearer(dt: float, than: float | None) -> bool:
    """Whether a step is nearer to 1 ms, by ratio."""
    return than is None or abs(math.log(dt / FINE)) < abs(math.log(than / FINE)) - 1e-9
