"""A law beside its recording: force over what it depends on, as recorded, as fitted, and as the base model has it.

What the recording shows is the fitted law plus the force that the fitted model leaves over (a partial residual; Larsen
and McCleary 1972), smoothed no more than the base model's left-over force asks for.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.explain.force_map import ForceMap
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.problems.asked import inverse_force
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.term import Slot

Over: TypeAlias = Literal["v", "x", "t"]
_CELLS = 32
"""Of the range that was covered; half of them for each direction of motion."""
_FEWEST = 3
"""Samples of a cell that is shown."""
_BETWEEN = 150
"""Speeds of a line in one direction."""
_BY_SPEED = (Slot.FRICTION_LAW, Slot.FRICTION_LEVEL, Slot.BREAK_AWAY)
_STILL = 1e-9
"""Share of a change of force that is none."""


@dataclass(frozen=True, slots=True)
class ModelForces:
    """Forces of the refined and of the base model, N, at speeds (n,), m/s."""

    at: FloatArray
    fitted: FloatArray
    base: FloatArray


@dataclass(frozen=True, slots=True)
class SeenLaw:
    """Force on the left of the equation of motion, N, per unit mass where the mass is unknown.

    names : of the catalogue. over : "v" (all friction and damping), "x" (what the spring is not), or "t". level :
    whether it is the level of dry friction, against the motion. at (m,) : where, m, m/s or s. seen, stderr, fitted,
    base (m,) : means of the recording with one standard error, of the refined and of the base model. between : of a
    friction curve, whose every row is a cell of its own, both models over speeds between its rows.
    """

    names: tuple[str, ...]
    over: Over
    level: bool
    at: FloatArray
    seen: FloatArray
    stderr: FloatArray
    fitted: FloatArray
    base: FloatArray
    between: ModelForces | None = None


def curve_law(outcome: Outcome, left: ForceMap) -> SeenLaw:
    """All friction over speed, of a friction curve. left : of the refined model, per unit mass."""
    model, base, v = outcome.refined.model, outcome.base.model, left.at_v
    speeds = np.abs(v)
    grid = np.geomspace(np.min(speeds), np.max(speeds), _BETWEEN)
    sides = [side * grid[:: int(side)] for side in (-1.0, 1.0) if np.any(np.sign(v) == side)]
    fine = np.concatenate(sides)

    def force(of: Model, at: FloatArray) -> FloatArray:
        return _force(of, {"t": np.zeros(at.size), "x": np.zeros(at.size), "v": at})

    names = tuple(dict.fromkeys(entry.term.name for entry in model.terms))
    fitted, error = force(model, v), model.m * left.stderr
    between = ModelForces(fine, force(model, fine), force(base, fine))
    return SeenLaw(names, "v", False, v, fitted + model.m * left.force, error, fitted, force(base, v), between)


def seen_laws(outcome: Outcome, left: ForceMap) -> tuple[SeenLaw, ...]:
    """One for each thing that fitted laws depend on. left : of the refined model, per unit mass."""
    model, base = outcome.refined.model, outcome.base.model
    groups: dict[tuple[Over, bool], list[ModelTerm]] = {}
    moving = np.isfinite(left.force)
    if outcome.problem.alone or not np.any(moving):
        return ()
    motion = {"t": left.t[moving], "x": left.at_x[moving], "v": left.at_v[moving]}
    for entry in model.terms:
        over = _over(model, entry, motion)
        if over is not None:
            groups.setdefault((over, entry.term.slot is Slot.FRICTION_MODULATION), []).append(entry)
    found = []
    for (over, level), terms in groups.items():
        fitted = _force(_part(model, over, level, terms), motion)
        before = _force(_part(base, over, level, ()), motion)
        if over == "x" and not level:
            before = _force(_spring(base), motion) - _force(_spring(model), motion)
        side = np.sign(motion["v"]) if level else 1.0
        seen = side * (fitted + model.m * left.force[moving])
        columns = (seen, model.m * left.stderr[moving], side * fitted, side * before)
        names = tuple(dict.fromkeys(entry.term.name for entry in terms))
        found.append(SeenLaw(names, over, level, *_cells(motion[over], *columns)))
    return tuple(one for one in found if one.at.size > 1)


def _over(model: Model, entry: ModelTerm, motion: Mapping[str, FloatArray]) -> Over | None:
    """What a term's force depends on; None where it is no function of the moment, no force, or a table."""
    term = entry.term
    if term.known is not None:
        return None
    if term.slot in _BY_SPEED:
        return "v"
    if term.slot not in (Slot.SMOOTH, Slot.FRICTION_MODULATION):
        return None
    if term.changes_in_time:
        return "t"
    part = _part(model, "x", term.slot is Slot.FRICTION_MODULATION, (entry,))
    fast = np.full(motion["x"].size, float(np.max(np.abs(motion["v"]))))
    along = np.abs(_force(part, {**motion, "v": fast}))
    return "x" if np.ptp(along) > _STILL * max(float(np.max(along)), 1e-300) else "v"


def _part(model: Model, over: Over, level: bool, terms: Sequence[ModelTerm]) -> Model:
    """What of a model is shown over this."""
    rubs = over == "v" or level
    return replace(
        model,
        c=model.c if over == "v" else 0.0,
        k=0.0,
        restoring=Restoring.NONE,
        f_k=model.f_k if rubs else 0.0,
        f_s=model.f_s if over == "v" else None,
        terms=tuple(terms),
    )


def _spring(model: Model) -> Model:
    return replace(model, c=0.0, f_k=0.0, f_s=None, terms=())


def _force(part: Model, motion: Mapping[str, FloatArray]) -> FloatArray:
    """Without inertia, (n,)."""
    return inverse_force(part, motion["t"], motion["x"], motion["v"], np.zeros(motion["t"].size))


def _cells(
    at: FloatArray, seen: FloatArray, error: FloatArray, fitted: FloatArray, base: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Means over cells; samples of one visit share one error, and visits that differ say how well a cell is known."""
    low, high = float(at.min()), float(at.max())
    if low < 0.0 < high:
        # no cell holds both directions
        half = max(-low, high)
        low, high = -half, half
    cell = np.minimum(((at - low) / max(high - low, 1e-300) * _CELLS).astype(np.int64), _CELLS - 1)
    visit = np.cumsum(np.concatenate(([0], (np.diff(cell) != 0).astype(np.int64))))
    size = np.bincount(visit).astype(np.float64)
    owner = cell[np.concatenate(([0], np.flatnonzero(np.diff(cell)) + 1))]
    count = np.bincount(cell, minlength=_CELLS)
    weight = np.maximum(count, 1)

    def mean(y: FloatArray) -> FloatArray:
        return np.bincount(cell, y, _CELLS) / weight

    middle, visits = mean(seen), np.bincount(owner, minlength=_CELLS)
    noise = np.sqrt(np.bincount(owner, (np.bincount(visit, error)) ** 2, _CELLS)) / weight
    apart = np.bincount(visit, seen) / size - middle[owner]
    scatter = np.sqrt(np.bincount(owner, size * apart**2, _CELLS) / weight / np.maximum(visits - 1, 1))
    there = count >= _FEWEST
    return mean(at)[there], middle[there], np.maximum(noise, scatter)[there], mean(fitted)[there], mean(base)[there]
