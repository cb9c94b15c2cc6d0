"""Tables that stay, as people see them: curves and a surface with an error, in words, beside the nearest laws.

The error is the larger of two: the penalised fit read as a posterior (Nychka 1988, J. Am. Stat. Assoc. 83, 1134), its
noise as large as the scores of strokes scatter, and those scores through the fit (Liang and Zeger 1986). A misfit
says one thing for half a swing; samples are no independent words. To it is added what else may be in the table: small
effects that it has taken in are held to be as large, in proportion, as what it leaves of blocks left out; and what a
rougher table says otherwise, which the blocks ask for and so few words do not allow. How much all of that falls short
of, simulated machines say (rule table-band).
"""

import math
from dataclasses import replace
from typing import Literal, TypeAlias

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.grading.prediction import blocks_of
from harness.diagnosis.outcome import Surface, Table
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import TABLE_BAND
from harness.diagnosis.search.screen import applicable
from harness.diagnosis.tables.basis import partials
from harness.diagnosis.tables.beside import Tabulated
from harness.diagnosis.tables.describe import described, plane_described
from harness.diagnosis.tables.fitted import TableFit, rougher
from harness.fit.least_squares import inverse_of
from harness.kernels.solve import Scales
from harness.model.model import Model, ModelTerm
from harness.model.registry import NAMED
from harness.model.term import Evidence, Slot

_POINTS, _SIDE, _CELLS = 121, 41, 12
"""Of a curve; along each side of a surface, and cells there: a point is known where the motion was in its cell."""
_LEAST_TAKEN = 0.01
"""Share of the squares that a table takes at least, as the band counts it."""
_NEAR = 0.5
"""Share of squares below which a law is not near."""
_MOST = 3
"""Names that are told."""

Drawn: TypeAlias = tuple[tuple[int, ...], Table | Surface]
"""What a table looks like, with its places among the model's terms."""


def drawn(
    first: Tabulated, start: Model, problem: Problem, strokes: Strokes, scales: Scales, held: float, seen: Evidence
) -> list[Drawn]:
    """The tables of a rung, on top of ``start``: curves, then the surface.

    strokes : of the residual. scales : what they were fitted in. held : held-out error with them, over that without.
    seen : of what ``start`` leaves, for laws that are near.
    """
    found, named, tables = first.fit, len(start.terms), list[Drawn]()
    for numbers, form in curves(first, named):
        table = table_of(found, strokes, scales, numbers, form, held)
        said = described(table, found.model, problem.angular)
        near = _nearest(table, start, problem, scales, seen)
        tables.append((numbers, replace(table, described=said, nearest=near)))
    both = [i for i, term in enumerate(first.rung.terms, named) if term.known is not None and term.known.of == "x, v"]
    surface = [((i,), surface_of(found, strokes, scales, i, held, problem.angular)) for i in both[:1]]
    return [*tables, *surface]


def curves(first: Tabulated, named: int) -> list[tuple[tuple[int, ...], str]]:
    """The tables of a rung that are curves: places among the model's terms, and what each is a function of."""
    forms = {"x": "f(x)", "v": "f(v)", "|v|": "f(|v|) sgn v"}
    found: list[tuple[tuple[int, ...], str]] = []
    for i, term in enumerate(first.rung.terms, start=named):
        assert term.known is not None
        if term.known.of == "-v":
            # the other direction of the one before
            found[-1] = ((*found[-1][0], i), found[-1][1])
        elif term.known.of != "x, v":
            found.append(((i,), "g(x) sgn v" if term.slot is Slot.FRICTION_MODULATION else forms[term.known.of]))
    return found


def table_of(
    found: TableFit, strokes: Strokes, scales: Scales, numbers: tuple[int, ...], said: str, held: float
) -> Table:
    """Some of the tables of a fit as one curve.

    strokes : of the residual, (n,). numbers : of the tables, places among the model's terms. held : held-out error with
    them, over that without.
    """
    strips = sorted((_strip(found, i, scales) for i in numbers), key=lambda one: float(one[0][0]))
    at, columns = np.concatenate([s for s, _ in strips]), np.vstack([c for _, c in strips])
    first = found.model.terms[numbers[0]].term
    unit_force = first.slot is Slot.SMOOTH
    kind = "" if first.known is None else first.known.of
    of: Literal["x", "v", "|v|"] = "x" if kind == "x" else "v" if kind in ("v", "-v") or len(strips) > 1 else "|v|"
    level = math.inf if unit_force else found.model.f_k
    factor = 1.0 if unit_force else level
    x, v = found.look.x, found.look.v
    quantity = {"x": x, "|v|": np.abs(v), "v": v}[of]
    # in the middle of parts of equal counts: their mean is the motion's
    looks = np.quantile(quantity[v != 0.0], (np.arange(_POINTS) + 0.5) / _POINTS)
    # friction is never below none
    force = np.maximum(factor * (columns @ found.at), -level)
    size = float(np.sqrt(np.mean(np.interp(looks, at, force) ** 2)))
    # a modulation of no friction is no force, and its error none
    stderr = factor * _errors(found, strokes, columns, size / factor if factor > 0.0 else 0.0, held)
    names = {f.name for f in found.free}
    gauge: tuple[str, ...] = ("line",) if of != "x" else ("constant",)
    if of == "x" and unit_force:
        constant = ("constant",) if "offset" in names else ("level",) if found.model.has_level else ()
        gauge = (*constant, *(("line",) if "k" in names else ()))
    return Table(said, of, at, force, stderr, looks, gauge)


def _strip(found: TableFit, number: int, scales: Scales) -> tuple[FloatArray, FloatArray]:
    """One table over the range in which it is known, (m,), and the fit's partials (m, q) of its force there."""
    entry = found.model.terms[number]
    known = entry.term.known
    assert known is not None
    at, side = np.linspace(*known.ends(entry.values), _POINTS), -1.0 if known.of == "-v" else 1.0
    x, v = (at, np.ones(_POINTS)) if known.of == "x" else (np.zeros(_POINTS), side * at)
    rows = partials(found.model, number, x, v, scales) @ found.basis.free[_own(found, number)]
    return (at, rows) if side > 0.0 else (-at[::-1], rows[::-1])


def _own(found: TableFit, number: int) -> list[int]:
    """Places of a table's values among those of all."""
    return [c for c, (i, _) in enumerate(found.basis.places) if i == number]


def _errors(found: TableFit, strokes: Strokes, columns: FloatArray, size: float, held: float) -> FloatArray:
    """One standard error of what tables say, (m,), by their partials (m, q); size : rms of it over the motion."""
    b, curvature = len(found.free), found.curvature
    inverse = inverse_of(curvature.at(found.strength))
    cluster, count = strokes.of, strokes.count
    n, p = cluster.size, found.jacobian.shape[1]
    scores = np.zeros((count, p))
    for i in range(found.residual.size // n):
        rows = slice(i * n, (i + 1) * n)
        each = found.jacobian[rows] * found.residual[rows, None]
        scores += np.column_stack([np.bincount(cluster, each[:, j], count) for j in range(p)])
    # the fit has taken its own share of what the strokes say
    taken = b + curvature.effective(found.strength)
    meat = scores.T @ scores * count / max(count - taken, 1.0)
    inflated = float(np.trace(inverse @ meat)) / max(float(np.trace(inverse @ curvature.seen)), 1e-300)
    spread = [
        np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", columns, one[b:, b:], columns), 0.0))
        for one in (inverse * inflated, inverse @ meat @ inverse)
    ]
    beside = size * held / math.sqrt(max(1.0 - held**2, _LEAST_TAKEN))
    smoothed = columns @ (rougher(found, blocks_of(strokes)) - found.at)
    said = np.hypot(np.hypot(np.maximum(*spread), beside), smoothed)
    return np.asarray(TABLE_BAND.value * said, dtype=np.float64)


def surface_of(found: TableFit, strokes: Strokes, scales: Scales, number: int, held: float, angular: bool) -> Surface:
    """The table at a place among the model's terms, which is one over both.

    strokes : of the residual. held : held-out error with it, over that without. angular : rad and not m.
    """
    entry = found.model.terms[number]
    known = entry.term.known
    assert known is not None
    assert known.fast is not None
    fast = entry.values[known.fast]
    x, v = np.linspace(*known.ends(entry.values), _SIDE), np.linspace(-fast, fast, _SIDE)
    grid = partials(found.model, number, np.tile(x, _SIDE), np.repeat(v, _SIDE), scales)
    columns = grid @ found.basis.free[_own(found, number)]
    seen = _seen(x, v, found.look.x, found.look.v)
    force = (columns @ found.at).reshape(_SIDE, _SIDE)
    size = float(np.sqrt(np.mean(force[seen] ** 2))) if np.any(seen) else 0.0
    stderr = _errors(found, strokes, columns, size, held).reshape(_SIDE, _SIDE)
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


def _nearest(
    table: Table, model: Model, problem: Problem, scales: Scales, seen: Evidence
) -> tuple[tuple[str, float], ...]:
    """Laws of the catalogue, nearest first, with the share of the table that each says, the gauge taken off both.

    model : without the table.
    """
    x, v = (table.swept, np.ones(table.swept.size)) if table.of == "x" else (np.zeros(table.swept.size), table.swept)
    slot = Slot.FRICTION_MODULATION if table.form.startswith("g") else Slot.SMOOTH
    target = ungauged(table, np.interp(table.swept, table.at, table.force))
    whole, best = float(target @ target), dict[str, float]()
    for term in NAMED:
        if term.slot is not slot or term.amplitude is None or term.changes_in_time:
            continue
        if whole <= 0.0 or not applicable(term, model, problem):
            continue
        probes = (model.with_terms(ModelTerm(term, values)) for values in term.probes(seen))
        looks = [partials(with_it, 0, x, v, scales)[:, term.amplitude] for with_it in probes]
        # what a law looks like at each of its probes: one curve, or a cosine and a sine
        step = 1 if term.phase is None else 2
        for shapes in (looks[i : i + step] for i in range(0, len(looks), step)):
            if not any(np.ptp(s) > 0.0 for s in shapes):
                continue  # a law of the other quantity
            columns = np.column_stack([ungauged(table, s) for s in shapes])
            left = target - columns @ np.linalg.lstsq(columns, target, rcond=1e-10)[0]
            best[term.name] = max(best.get(term.name, 0.0), 1.0 - float(left @ left) / whole)
    near = sorted(((n, s) for n, s in best.items() if s >= _NEAR), key=lambda one: -one[1])
    return tuple(near[:_MOST])


def ungauged(table: Table, force: FloatArray) -> FloatArray:
    """A force (l,) at the swept places with what the gauge leaves to the base taken off."""
    columns = [] if table.has_constant else [np.ones(force.size)]
    columns += [table.swept] if "line" in table.gauge else []
    if not columns:
        return force
    held = np.column_stack(columns)
    return np.asarray(force - held @ np.linalg.lstsq(held, force, rcond=None)[0], dtype=np.float64)
