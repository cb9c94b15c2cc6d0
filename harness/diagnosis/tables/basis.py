"""Tables on a motion: their ends, their values at the samples, the gauge, and the roughness that is penalised.

The gauge says what is not the table's: what the spring, the damping, the friction, the zero and the named terms of the
model say themselves. Over the samples of the motion the table has none of it.

What is tabulated: a force by position, by speed, by a sum of both, a resistance by position, a force over both.

How rough tables are: integrals of squared second derivatives, knots of a curve one apart.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.kernels.layout import lay_out
from harness.kernels.solve import Scales
from harness.model.law import D_PARAMETER, INTERNAL_COLUMNS
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import TERMS
from harness.model.spline import BENDING, KNOTS, SIDE, weight
from harness.model.term import Slot, Term


@dataclass(frozen=True, slots=True)
class Rung:
    """Tables that are fitted together.

    said : in words. on : rungs that it holds, and must improve on.
    """

    said: str
    terms: tuple[Term, ...]
    on: tuple[str, ...] = ()


def _table(of: str, slot: Slot = Slot.SMOOTH) -> Term:
    return next(t for t in TERMS if t.known is not None and t.known.of == of and t.slot is slot)


_BY_PLACE, _BY_SPEED = _table("x"), _table("|v|")
_RUBS, _BOTH = "g(x) sgn v", "f(x, v)"
RUNGS = (
    Rung("f(x)", (_BY_PLACE,)),
    Rung("f(|v|) sgn v", (_BY_SPEED,)),
    Rung(_RUBS, (_table("x", Slot.FRICTION_MODULATION),)),
    Rung("f(v)", (_table("v"), _table("-v")), ("f(|v|) sgn v",)),
    Rung("f(x) + f(v)", (_BY_PLACE, _BY_SPEED), ("f(x)", "f(|v|) sgn v")),
)
"""Simple ones first."""
OF_PLACE, OF_SPEED, OF_FRICTION = RUNGS[:1], (RUNGS[1], RUNGS[3]), RUNGS[2:3]
"""Forces of the place alone and of the speed alone, and friction that changes along the way."""
_PLANE = _table("x, v")


def over_plane(kept: Sequence[Rung]) -> tuple[Rung, ...]:
    """The last rungs, on those that stay, the best of them first: a force of position and speed that no sum says.

    Beside it stand the tables of the best sum, and friction by position only where that stays and adds to it.
    """
    total = next((r.terms for r in kept if r.said != _RUBS), ())
    rubs = next((r.terms for r in kept if r.said == _RUBS), ())
    on = tuple(r.said for r in kept)
    alone = Rung(_BOTH, (*total, _PLANE), on)
    return (alone, Rung(f"{_BOTH} + {_RUBS}", (*total, *rubs, _PLANE), (*on, _BOTH))) if rubs else (alone,)


_FINE = 40
"""Places between two knots at which a plane's integrals are summed."""


def roughness(counts: list[int]) -> FloatArray:
    """Rows whose squares add up to the roughness of all tables, of so many values each."""
    parts = [_of_plane() if count == SIDE * SIDE else _of_curve(count) for count in counts]
    found, row, at = np.zeros((sum(p.shape[0] for p in parts), sum(counts))), 0, 0
    for part in parts:
        found[row : row + part.shape[0], at : at + part.shape[1]] = part
        row, at = row + part.shape[0], at + part.shape[1]
    return found


def _of_curve(count: int) -> FloatArray:
    """Rows (KNOTS, count) of a curve; one of fewer values than knots begins with a value that is 0."""
    mass = np.diag(np.full(KNOTS, 2.0 / 3.0)) + np.diag(np.full(KNOTS - 1, 1.0 / 6.0), 1)
    mass += np.diag(np.full(KNOTS - 1, 1.0 / 6.0), -1)
    return np.asarray((np.linalg.cholesky(mass).T @ BENDING)[:, KNOTS - count :], dtype=np.float64)


def _of_plane() -> FloatArray:
    """Rows (3 SIDE^2, SIDE^2) of a plane: second derivatives along both sides, and twice the mixed one.

    In the units of curves of KNOTS knots, and a mean along the other side, so that a plane without one is a curve.
    """
    places = (np.arange((SIDE - 1) * _FINE) + 0.5) / _FINE
    pairs = np.array([[weight(float(u), j) for j in range(SIDE)] for u in places])
    value, slope = pairs[:, :, 0] / np.sqrt(_FINE), pairs[:, :, 1] / np.sqrt(_FINE)
    bend = np.gradient(pairs[:, :, 1], 1.0 / _FINE, axis=0) / np.sqrt(_FINE)
    g, s, r = (_root(y.T @ y) for y in (value, slope, bend))
    ratio = (SIDE - 1.0) / (KNOTS - 1.0)
    unit = ratio / np.sqrt(KNOTS - 1.0)
    return np.asarray(unit * np.vstack((np.kron(r, g), np.sqrt(2.0) * np.kron(s, s), np.kron(g, r))))


def _root(square: FloatArray) -> FloatArray:
    """A matrix whose square is a symmetric one."""
    values, vectors = np.linalg.eigh(square)
    return np.asarray(np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T, dtype=np.float64)


_MARGIN = 0.01
"""Of the swept range, by which a table reaches beyond it on each side: a fit moves its ends a little."""
_LOOKS = 600
"""Samples at which the gauge is stated."""
_APART = 1e-8
"""Share of the largest singular value below which a gauge says nothing new."""


@dataclass(frozen=True, slots=True)
class Basis:
    """Tables that are fitted together, at rest.

    model : with the tables, their values 0. places : (term, parameter) of each value, K of them. free : (K, q), values
    by the coordinates that the gauge leaves. rough : (r, K), whose squares are the roughness.
    """

    model: Model
    places: tuple[tuple[int, int], ...]
    free: FloatArray
    rough: FloatArray

    def with_values(self, model: Model, values: FloatArray) -> Model:
        """A model of these terms with other values (K,) in its tables."""
        entries = [list(e.values) for e in model.terms]
        for (i, j), value in zip(self.places, values.tolist(), strict=True):
            entries[i][j] = value
        terms = (replace(e, values=tuple(v)) for e, v in zip(model.terms, entries, strict=True))
        return replace(model, terms=tuple(terms))


def basis_of(rung: Rung, model: Model, base: tuple[str, ...], x: FloatArray, v: FloatArray, scales: Scales) -> Basis:
    """The tables of a rung beside a model whose motion is x (n,), v (n,).

    base : names of the base parameters that are fitted.
    """
    moving = np.flatnonzero(v != 0.0)
    at = moving[:: max(1, moving.size // _LOOKS)]
    entries = tuple(_idle(term, x, v) for term in rung.terms)
    with_tables = replace(model, terms=(*model.terms, *entries))
    first = len(model.terms)
    counts = [_values(e.term) for e in entries]
    places = tuple((first + i, j) for i, count in enumerate(counts) for j in range(count))
    shown = np.hstack([partials(with_tables, first + i, x[at], v[at], scales) for i in range(len(entries))])
    offset = np.concatenate(([0], np.cumsum(counts)))
    owned = _gauges(rung, model, base, x[at], v[at], scales)
    for i in (i for i, e in enumerate(entries) if e.term.known is not None and e.term.known.of == "x, v"):
        # of the place alone, of the speed alone, and friction: what sums say is not the plane's
        square = shown[:, offset[i] : offset[i + 1]].reshape(-1, SIDE, SIDE)
        owned.append(((i,), [*square.sum(axis=2).T, *square.sum(axis=1).T, np.sign(v[at])]))
    held: list[FloatArray] = []
    for group, functions in owned:
        mask = np.zeros(shown.shape[1])
        for i in group:
            mask[offset[i] : offset[i + 1]] = 1.0
        held += [(f / (np.linalg.norm(f) or 1.0)) @ shown * mask for f in functions]
    rough = roughness(counts)
    for i, e in enumerate(entries):
        if e.term.slot is Slot.FRICTION_MODULATION:
            # a factor on friction is as rough as its force
            rough[:, offset[i] : offset[i + 1]] *= model.f_k
    free = np.eye(shown.shape[1])
    if held:
        # values that none of the functionals sees
        _, size, rows = np.linalg.svd(np.array(held))
        free = np.asarray(rows[int(np.count_nonzero(size > _APART * size[0])) :].T, dtype=np.float64)
    return Basis(with_tables, places, free, rough)


def partials(model: Model, index: int, x: FloatArray, v: FloatArray, scales: Scales) -> FloatArray:
    """Partials (n, p) of a term's force, or factor, by its parameters along a motion; of a table, by its values."""
    entry = model.terms[index]
    laid = lay_out(model, scales.v)
    law, o = entry.term.law, laid.term_at[index]
    count = _values(entry.term) if entry.term.known is not None else len(entry.values)
    found, row = np.zeros((x.size, count)), np.zeros(INTERNAL_COLUMNS)
    assert law is not None
    for i, (position, speed) in enumerate(zip(x.tolist(), v.tolist(), strict=True)):
        row[:] = 0.0
        law(position, speed, laid.theta, o, row)
        found[i] = row[D_PARAMETER : D_PARAMETER + count]
    return found


def _values(term: Term) -> int:
    """Values of a table: its parameters but for its ends."""
    assert term.known is not None
    return min(term.known.places)


def _idle(term: Term, x: FloatArray, v: FloatArray) -> ModelTerm:
    """A table without effect over what was swept."""
    known = term.known
    assert known is not None
    values = [0.0] * len(term.parameters)
    if known.of in ("x", "x, v"):
        reach = _MARGIN * float(np.ptp(x))
        assert known.low is not None
        values[known.low], values[known.high] = float(x.min()) - reach, float(x.max()) + reach
        if known.fast is not None and known.reach is not None:
            values[known.fast] = (1.0 + _MARGIN) * float(np.max(np.abs(v)))
            values[known.reach] = (1.0 + _MARGIN) * float(np.max(known.out(tuple(values), x, v)))
    else:
        values[known.high] = (1.0 + _MARGIN) * float(np.max(_speeds(known.of, v)))
    return ModelTerm(term, tuple(values))


def _speeds(of: str, v: FloatArray) -> FloatArray:
    """What a table of "|v|", "v" or "-v" is over."""
    return {"|v|": np.abs(v), "v": v, "-v": -v}[of]


def is_swept(rung: Rung, v: FloatArray) -> bool:
    """Whether a motion of speeds v (n,) has any of each table's direction."""
    sides = [t.known.of for t in rung.terms if t.known is not None and not t.known.of.startswith("x")]
    return all(float(np.max(_speeds(of, v))) > 0.0 for of in sides)


def _gauges(
    rung: Rung, model: Model, base: tuple[str, ...], x: FloatArray, v: FloatArray, scales: Scales
) -> list[tuple[tuple[int, ...], list[FloatArray]]]:
    """For groups of tables (their numbers) the functions over the samples that are not theirs."""
    named = [
        (e.term.slot, column)
        for i, e in enumerate(model.terms)
        if e.term.slot in (Slot.SMOOTH, Slot.FRICTION_MODULATION) and not e.term.changes_in_time
        for column in partials(model, i, x, v, scales).T
    ]
    kinds = ["" if t.known is None else t.known.of for t in rung.terms]
    by_place = [i for i, of in enumerate(kinds) if of == "x"]
    by_speed = tuple(i for i, of in enumerate(kinds) if of not in ("x", "x, v"))
    found: list[tuple[tuple[int, ...], list[FloatArray]]] = []
    for i in by_place:
        slot = rung.terms[i].slot
        own = [column for of, column in named if of is slot]
        if slot is Slot.FRICTION_MODULATION:
            own.append(np.ones(x.size))
        else:
            own += [np.sin(x) if model.restoring is Restoring.PENDULUM else x] if "k" in base else []
            own += [np.ones(x.size)] if "offset" in base or model.has_level else []
        found.append(((i,), own))
    if by_speed:
        own = [column for of, column in named if of is Slot.SMOOTH]
        found.append((by_speed, [*own, v]))
    return found
