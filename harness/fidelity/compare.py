"""Rows against a baseline: what moved, which way, and whether that is a regression.

Order of convergence in the step, measured from rows that differ in nothing else.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from harness.fidelity.select import Selection
from harness.results.sweep import Convergence, Moved, Verdict


@dataclass(frozen=True, slots=True)
class Tolerance:
    """A move counts when it exceeds relative x |baseline| + absolute. steps : plus so many simulation steps, s."""

    relative: float
    absolute: float
    origin: str
    steps: float = 0.0

    def allowed(self, before: float, dt: float | None) -> float:
        """By how much a metric that was ``before`` may move at a step of ``dt`` (s)."""
        return self.relative * abs(before) + self.absolute + self.steps * (dt or 0.0)


_LAST_BITS = "smooth in the motion; differences of 1e-12 at reversals grow to less than this"
_ESTIMATE = "the guard is found from the data and may move by a sample, which moves an estimate by less than this"
_STEP = "decided sample by sample: an event may fall into the next step"
_SHARE = "a count of samples: one event more or less in the time measured"

TOLERANCES: dict[str, Tolerance] = {
    "max_error_m": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "rest_error_m": Tolerance(1e-3, 1e-8, _LAST_BITS),
    "stick_time_s": Tolerance(0.0, 1e-12, _STEP, steps=1.0),
    "creep_m_s": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "drift_m": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "half_cycles": Tolerance(0.0, 0.0, "a whole number"),
    "reversal_lead_s": Tolerance(1e-3, 1e-9, _STEP, steps=0.5),
    "energy_error": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "x_k_m": Tolerance(2e-3, 1e-8, _ESTIMATE),
    "zeta": Tolerance(2e-3, 1e-7, _ESTIMATE),
    "x_k_local_m": Tolerance(2e-2, 1e-6, "two samples of one reversal: the reversal may fall into the next step"),
    "x_k_rel_error": Tolerance(0.0, 2e-3, _ESTIMATE),
    "zeta_rel_error": Tolerance(0.0, 2e-3, _ESTIMATE),
    "x_k_local_rel_error": Tolerance(0.0, 2e-2, "two samples of one reversal: it may fall into the next step"),
    "period_s": Tolerance(0.0, 1e-12, _STEP, steps=0.5),
    "stick_fraction": Tolerance(0.0, 5e-3, _SHARE),
    "near_belt_fraction": Tolerance(0.0, 5e-3, _SHARE),
    "stop_fraction": Tolerance(0.0, 2e-3, _SHARE),
    "stick_deviation_m_s": Tolerance(1e-2, 1e-9, _LAST_BITS),
    "amplitude_m": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "lift_m": Tolerance(5e-2, 1e-9, "a bouncing box forgets its last bits within a few bounces"),
    "normal_error": Tolerance(1e-1, 1e-9, "a bouncing box forgets its last bits within a few bounces"),
    "deceleration_m_s2": Tolerance(1e-3, 1e-9, _LAST_BITS),
    "mu_v_over_g_s": Tolerance(1e-3, 1e-12, _LAST_BITS),
}
"""By metric. Speed (steps_per_s, wall_s) is no metric: it is noise, and never gates."""

DEFAULT = Tolerance(1e-3, 1e-9, "a metric without an entry of its own")


Row = Mapping[str, Any]
REGRESSIONS: frozenset[str] = frozenset({"worse", "lost", "fails", "missing"})

KEPT = ("engine", "version", "environment", "route", "scenario", "dt_s", "metrics", "exact", "error")
"""What a baseline keeps of a row; never how fast it was."""


def kept(row: Row) -> dict[str, Any]:
    """The part of a row that goes into a baseline."""
    return {name: row[name] for name in KEPT}


def is_regression(moved: Moved) -> bool:
    """Whether it fails a gate: for the worse, and not known."""
    return moved.verdict in REGRESSIONS and moved.expected is None


def moved_rows(before: Mapping[str, Row], after: Mapping[str, Row], rows: Selection | None = None) -> list[Moved]:
    """What changed in every row, by name; rows : which are known to fail."""
    found = [move for name in sorted({*before, *after}) for move in moves(name, before.get(name), after.get(name))]
    if rows is None:
        return found
    return [move.model_copy(update={"expected": rows.expected(move.name)}) for move in found]


def moves(name: str, before: Row | None, after: Row | None) -> Iterator[Moved]:
    """What changed in one row; nothing when all is within tolerance."""

    def whole(verdict: Verdict, why: str) -> Moved:
        return Moved(name=name, metric="", before=None, after=None, verdict=verdict, why=why)

    if before is None or after is None:
        if after is not None:
            yield whole("new", "the baseline does not have this row")
        else:
            yield whole("missing", "the matrix does not have this row any more")
    elif after["error"] and not before["error"]:
        yield whole("fails", str(after["error"]))
    elif before["error"] and not after["error"]:
        yield whole("works", f"it failed before: {before['error']}")
    elif not before["error"]:
        for metric in dict.fromkeys([*before["metrics"], *after["metrics"]]):
            old, new = before["metrics"].get(metric), after["metrics"].get(metric)
            if found := _judged(metric, old, new, after):
                verdict, why, times = found
                yield Moved(name=name, metric=metric, before=old, after=new, verdict=verdict, why=why, times=times)


def _judged(metric: str, old: float | None, new: float | None, after: Row) -> tuple[Verdict, str, float | None] | None:
    """What a metric that moved is, and why: the tolerance with its origin; by how many times that."""
    limit = TOLERANCES.get(metric, DEFAULT)
    if old is None or new is None:
        return None if old is new else ("lost" if new is None else "gained", limit.origin, None)
    change, most = abs(new - old), limit.allowed(old, after["dt_s"])
    if change <= most:
        return None
    # an exact value makes "worse" mean farther from it; errors and creep are measured from 0
    truth = float(after["exact"].get(metric, 0.0))
    steps = f" + {limit.steps:g} steps" if limit.steps else ""
    allowed = f"{limit.relative:g} x baseline + {limit.absolute:g}{steps} ({limit.origin})"
    return "worse" if abs(new - truth) > abs(old - truth) else "better", allowed, change / most if most else None


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


_ABOUT = ("engine", "version", "route", "preset", "integrator", "scenario")


@dataclass(slots=True)
class Ladder:
    """Collects rows of the suite's own sliders one by one: memory grows with the settings, not with random sliders."""

    steps: dict[tuple[str, ...], dict[float, float]] = field(default_factory=dict)

    def add(self, row: Mapping[str, Any]) -> None:
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
        group = (*(str(row[name]) for name in _ABOUT), metric, changed, solver, row["environment"])
        self.steps.setdefault(group, {})[row["dt_s"]] = error

    def orders(self) -> list[Convergence]:
        """The slope of log error over log dt of every setting with enough steps."""
        found = []
        for group, errors in self.steps.items():
            if len(errors) >= FEWEST:
                dt = sorted(errors, reverse=True)
                sizes = [errors[step] for step in dt]
                order, spread = slope(dt, sizes)
                about = dict(zip((*_ABOUT, "metric"), group, strict=False))
                found.append(Convergence(**about, dt_s=dt, error=sizes, order=order, spread=spread))
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
