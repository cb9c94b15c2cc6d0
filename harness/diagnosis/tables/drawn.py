"""Tables that stay, as people see them: curves and a surface with bands, in words, beside the nearest laws.

A fitted table over position and speed as a surface: what it says where the motion was, with one standard error.

Which laws of the catalogue come nearest to a table: the share that each says, with its gauge taken off both.
"""

from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.outcome import Surface, Table
from harness.diagnosis.problem import Problem
from harness.diagnosis.search.screen import applicable
from harness.diagnosis.tables.basis import partials
from harness.diagnosis.tables.curve import errors, table_of
from harness.diagnosis.tables.describe import described
from harness.diagnosis.tables.fitted import TableFit
from harness.diagnosis.tables.selection import Tabulated
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm
from harness.model.registry import NAMED
from harness.model.term import Evidence, Slot, Term

POINTS = 41
"""Along each side of a surface."""
_CELLS = 12
"""Along each side: a point is known where the motion was in its cell."""
_MOSTLY = 0.85
"""Share of squares from which a surface is called one of resistance, or one of a force."""


def surface_of(found: TableFit, strokes: Strokes, scales: Scales, number: int, held: float, angular: bool) -> Surface:
    """The table at a place among the model's terms, which is one over both.

    strokes : of the residual. held : held-out error with it, over that without. angular : rad and not m.
    """
    entry = found.model.terms[number]
    known = entry.term.known
    assert known is not None
    assert known.fast is not None
    low, high = known.ends(entry.values)
    fast = entry.values[known.fast]
    x, v = np.linspace(low, high, POINTS), np.linspace(-fast, fast, POINTS)
    mine = [c for c, (i, _) in enumerate(found.basis.places) if i == number]
    free = found.basis.free[mine]
    columns = partials(found.model, number, np.tile(x, POINTS), np.repeat(v, POINTS), scales) @ free
    seen = _seen(x, v, found.look.x, found.look.v)
    force = (columns @ found.at).reshape(POINTS, POINTS)
    size = float(np.sqrt(np.mean(force[seen] ** 2))) if np.any(seen) else 0.0
    stderr = errors(found, strokes, columns, size, held).reshape(POINTS, POINTS)
    said = plane_described(x + found.model.offset, v, force, seen, "rad" if angular else "m")
    return Surface(x, v, force, stderr, seen, said)


def _seen(x: FloatArray, v: FloatArray, at_x: FloatArray, at_v: FloatArray) -> BoolArray:
    """Which points (k, m) of a grid lie in a cell in which the motion (n,) was."""

    def cell(y: FloatArray, side: FloatArray) -> IntArray:
        share = (y - side[0]) / (side[-1] - side[0])
        return np.asarray(np.clip(_CELLS * share, 0.0, _CELLS - 1.0), dtype=np.int64)

    was = np.zeros((_CELLS, _CELLS), dtype=np.bool_)
    was[cell(at_v, v), cell(at_x, x)] = True
    return np.asarray(was[np.ix_(cell(v, v), cell(x, x))], dtype=np.bool_)


def plane_described(x: FloatArray, v: FloatArray, force: FloatArray, seen: BoolArray, unit: str) -> str:
    """Whether it resists or pushes, and where most; force, seen (k, m), at v (k,) and x (m,) as a sensor shows it."""
    both = seen & seen[::-1]
    odd, even = (np.where(both, 0.5 * (force + sign * force[::-1]), 0.0) for sign in (-1.0, 1.0))
    whole = float(np.sum(odd**2) + np.sum(even**2))
    if whole <= 0.0:
        return "nothing stands out"
    share = float(np.sum(odd**2)) / whole
    if share <= _MOSTLY:
        kind = "a force that is the same in both directions" if share < 1.0 - _MOSTLY else "a force"
        return f"{kind} that no sum of one of position and one of speed says"
    drag = np.sum(odd * np.sign(v)[:, None], axis=0) / np.maximum(np.sum(both, axis=0), 1)
    inside = np.sum(both, axis=0) > 0
    most = int(np.argmax(np.where(inside, drag, -np.inf)))
    return f"a resistance that depends on the place too, more than elsewhere about x = {x[most]:.2g} {unit}"


_NEAR = 0.5
"""Share of squares below which a law is not near."""
_MOST = 3
"""Names that are told."""


def nearest(
    table: Table, model: Model, problem: Problem, scales: Scales, seen: Evidence
) -> tuple[tuple[str, float], ...]:
    """Names and shares, nearest first. model : without the table."""
    x, v = (table.swept, np.ones(table.swept.size)) if table.of == "x" else (np.zeros(table.swept.size), table.swept)
    slot = Slot.FRICTION_MODULATION if table.form.startswith("g") else Slot.SMOOTH
    target = ungauged(table, np.interp(table.swept, table.at, table.force))
    whole = float(target @ target)
    best: dict[str, float] = {}
    for term in NAMED:
        if term.slot is not slot or term.amplitude is None or term.changes_in_time:
            continue
        if whole <= 0.0 or not applicable(term, model, problem):
            continue
        for shapes in _shapes(term, model, seen, x, v, scales):
            if not any(np.ptp(s) > 0.0 for s in shapes):
                continue  # a law of the other quantity
            columns = np.column_stack([ungauged(table, s) for s in shapes])
            left = target - columns @ np.linalg.lstsq(columns, target, rcond=1e-10)[0]
            share = 1.0 - float(left @ left) / whole
            best[term.name] = max(best.get(term.name, 0.0), share)
    near = sorted(((n, s) for n, s in best.items() if s >= _NEAR), key=lambda one: -one[1])
    return tuple(near[:_MOST])


def _shapes(
    term: Term, model: Model, seen: Evidence, x: FloatArray, v: FloatArray, scales: Scales
) -> list[list[FloatArray]]:
    """What a law looks like at each of its probes: one curve, or a cosine and a sine."""
    assert term.amplitude is not None
    found = []
    for values in term.probes(seen):
        with_it = model.with_terms(ModelTerm(term, values))
        found.append(partials(with_it, 0, x, v, scales)[:, term.amplitude])
    if term.phase is None:
        return [[shape] for shape in found]
    return [[found[i], found[i + 1]] for i in range(0, len(found), 2)]


def ungauged(table: Table, force: FloatArray) -> FloatArray:
    """A force (l,) at the swept places with what the gauge leaves to the base taken off."""
    columns = [] if table.has_constant else [np.ones(force.size)]
    columns += [table.swept] if "line" in table.gauge else []
    if not columns:
        return force
    held = np.column_stack(columns)
    return np.asarray(force - held @ np.linalg.lstsq(held, force, rcond=None)[0], dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Drawn:
    """What a rung's tables look like. tables : curves, each with its places among the model's terms.

    surface : the same of the one that hangs on both; None where there is none.
    """

    tables: tuple[tuple[tuple[int, ...], Table], ...]
    surface: tuple[int, Surface] | None

    @classmethod
    def of(
        cls,
        first: Tabulated,
        start: Model,
        problem: Problem,
        strokes: Strokes,
        scales: Scales,
        held: float,
        seen: Evidence,
    ) -> "Drawn":
        """The tables of a rung, on top of ``start``.

        strokes : of the residual. scales : what they were fitted in. held : held-out error with them, over that
        without. seen : of what ``start`` leaves, for laws that are near.
        """
        found, named = first.fit, len(start.terms)
        tables = []
        for numbers, form in curves(first, named):
            table = table_of(found, strokes, scales, numbers, form, held)
            said = described(table, found.model, problem.angular)
            tables.append(
                (numbers, replace(table, described=said, nearest=nearest(table, start, problem, scales, seen)))
            )
        both = _plane(first, named)
        if both is None:
            return cls(tuple(tables), None)
        return cls(tuple(tables), (both, surface_of(found, strokes, scales, both, held, problem.angular)))


def curves(first: Tabulated, named: int) -> list[tuple[tuple[int, ...], str]]:
    """The tables of a rung that are curves: places among the model's terms, and what each is a function of."""
    found: list[tuple[tuple[int, ...], str]] = []
    for i, term in enumerate(first.rung.terms, start=named):
        assert term.known is not None
        if term.known.of == "-v":
            # the other direction of the one before
            found[-1] = ((*found[-1][0], i), found[-1][1])
        elif term.known.of != "x, v":
            found.append(((i,), _forms(term)))
    return found


def _plane(first: Tabulated, named: int) -> int | None:
    """The place among the model's terms of a rung's table over both, None where it has none."""
    kinds = [term.known.of for term in first.rung.terms if term.known is not None]
    return named + kinds.index("x, v") if "x, v" in kinds else None


def _forms(term: Term) -> str:
    assert term.known is not None
    if term.slot is Slot.FRICTION_MODULATION:
        return "g(x) sgn v"
    return {"x": "f(x)", "v": "f(v)", "|v|": "f(|v|) sgn v"}[term.known.of]
