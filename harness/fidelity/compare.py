"""Rows against a baseline: what moved, which way, and whether that is a regression."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from harness.fidelity.tolerances import tolerance

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
