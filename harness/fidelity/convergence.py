"""Order of convergence in the step, measured from rows that differ in nothing else."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

ERRORS: dict[str, str] = {
    "free-decay": "max_error_m",
    "free-decay-no-friction": "max_error_m",
    "belt": "period_s",
    "harmonic": "amplitude_m",
}
"""The metric whose error is followed down the steps, by scenario."""

FEWEST = 3
"""Steps an order needs."""
ROUNDING = 1e-12
"""Errors below this share of the exact value (or of 1) are rounding, not the scheme's; they are left out."""


@dataclass(frozen=True, slots=True)
class Order:
    """error ~ dt^order over these steps. spread : largest factor between an error and the fitted line."""

    engine: str
    version: str
    route: str
    preset: str
    integrator: str
    scenario: str
    metric: str
    dt_s: list[float]
    error: list[float]
    order: float
    spread: float


@dataclass(slots=True)
class Ladder:
    """Collects rows of the suite's own sliders one by one: memory grows with the settings, not with random sliders."""

    steps: dict[tuple[str, ...], dict[float, float]] = field(default_factory=dict)

    def add(self, row: Mapping[str, Any]) -> None:
        """Take one row (Row.as_dict)."""
        metric = ERRORS.get(row["scenario"])
        if metric is None or row["draw"] or row["error"] is not None or row["dt_s"] is None:
            return
        value = row["metrics"].get(metric)
        if value is None:
            return
        truth = row["exact"].get(metric, 0.0)
        error = abs(value - truth)
        if error <= ROUNDING * (abs(truth) or 1.0):
            return
        # settings that follow the step are the same settings
        changed = ",".join(sorted(name for name in row["changed"] if not name.startswith("sol") or name == "solver"))
        solver = str(row["settings"].get("solver", ""))
        about = ("engine", "version", "route", "preset", "integrator", "scenario")
        group = (*(str(row[name]) for name in about), metric, changed, solver, row["environment"])
        self.steps.setdefault(group, {})[row["dt_s"]] = error

    def orders(self) -> list[Order]:
        """The slope of log error over log dt of every setting with enough steps."""
        found = []
        for group, errors in self.steps.items():
            if len(errors) >= FEWEST:
                dt = sorted(errors, reverse=True)
                order, spread = slope(dt, [errors[step] for step in dt])
                engine, version, route, preset, scheme, scenario, metric = group[:7]
                sizes = [errors[step] for step in dt]
                found.append(Order(engine, version, route, preset, scheme, scenario, metric, dt, sizes, order, spread))
        return sorted(found, key=lambda one: (one.engine, one.route, one.preset, one.integrator, one.scenario))


def slope(dt: Iterable[float], errors: Iterable[float]) -> tuple[float, float]:
    """Least-squares slope of log error over log dt, and the largest factor between an error and that line.

    Good: the order of the scheme (RK4 4, leapfrog 2) where motion is smooth, 1 where reversals fall between steps.
    """
    x, y = [math.log(step) for step in dt], [math.log(error) for error in errors]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    order = sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y, strict=True)) / sum((a - mean_x) ** 2 for a in x)
    spread = max(abs(b - mean_y - order * (a - mean_x)) for a, b in zip(x, y, strict=True))
    return order, math.exp(spread)
