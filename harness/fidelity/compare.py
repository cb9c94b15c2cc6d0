"""Rows against a baseline: what moved, which way, and whether that is a regression."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal


@dataclass(frozen=True, slots=True)
class Tolerance:
    """A move counts when it exceeds relative x |baseline| + absolute. steps : plus so many simulation steps, s."""

    relative: float
    absolute: float
    origin: str
    steps: float = 0.0

    def allows(self, before: float, after: float, dt: float | None) -> bool:
        """Whether a metric that was ``before`` may be ``after`` at a step of ``dt`` (s)."""
        return abs(after - before) <= self.relative * abs(before) + self.absolute + self.steps * (dt or 0.0)


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
    "mu_v_over_g_s": Tolerance(1e-3, 1e-12, _LAST_BITS),
}
"""By metric. Speed (steps_per_s, wall_s) is no metric: it is noise, and never gates."""

DEFAULT = Tolerance(1e-3, 1e-9, "a metric without an entry of its own")


def tolerance(metric: str) -> Tolerance:
    """The tolerance of a metric."""
    return TOLERANCES.get(metric, DEFAULT)


Row = Mapping[str, Any]
Verdict = Literal["worse", "better", "lost", "gained", "fails", "works", "missing", "new"]
REGRESSIONS: frozenset[str] = frozenset({"worse", "lost", "fails", "missing"})

KEPT = ("engine", "version", "environment", "route", "scenario", "dt_s", "metrics", "exact", "error")
"""What a baseline keeps of a row; never how fast it was."""


@dataclass(frozen=True, slots=True)
class Move:
    """One thing that changed. metric : "" for a whole row. before, after : the metric, None where there is none.

    why : the tolerance with its origin, or the reason of a row that fails.
    """

    name: str
    metric: str
    before: float | None
    after: float | None
    verdict: Verdict
    why: str


def kept(row: Row) -> dict[str, Any]:
    """The part of a row that goes into a baseline."""
    return {name: row[name] for name in KEPT}


def moves(name: str, before: Row | None, after: Row | None) -> Iterator[Move]:
    """What changed in one row; nothing when all is within tolerance."""
    if before is None or after is None:
        if after is not None:
            yield Move(name, "", None, None, "new", "the baseline does not have this row")
        else:
            yield Move(name, "", None, None, "missing", "the matrix does not have this row any more")
        return
    if before["error"] or after["error"]:
        if after["error"] and not before["error"]:
            yield Move(name, "", None, None, "fails", str(after["error"]))
        elif before["error"] and not after["error"]:
            yield Move(name, "", None, None, "works", f"it failed before: {before['error']}")
        return
    for metric in dict.fromkeys([*before["metrics"], *after["metrics"]]):
        move = _moved(name, metric, before, after)
        if move is not None:
            yield move


def _moved(name: str, metric: str, before: Row, after: Row) -> Move | None:
    old, new = before["metrics"].get(metric), after["metrics"].get(metric)
    limit = tolerance(metric)
    if old is None and new is None:
        return None
    if old is None or new is None:
        return Move(name, metric, old, new, "lost" if new is None else "gained", limit.origin)
    if limit.allows(old, new, after["dt_s"]):
        return None
    # an exact value makes "worse" mean farther from it; errors and creep are measured from 0
    truth = float(after["exact"].get(metric, 0.0))
    steps = f" + {limit.steps:g} steps" if limit.steps else ""
    allowed = f"{limit.relative:g} x baseline + {limit.absolute:g}{steps} ({limit.origin})"
    return Move(name, metric, old, new, "worse" if abs(new - truth) > abs(old - truth) else "better", allowed)
