"""Tables on a motion: their ends, their values at the samples, the gauge, and the roughness that is penalised.

The gauge says what is not the table's: what the spring, the damping, the friction, the zero and the named terms of the
model say themselves. Over the samples of the motion the table has none of it.
"""

from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.tables.roughness import roughness
from harness.diagnosis.tables.rungs import Rung
from harness.kernels.layout import lay_out
from harness.kernels.solve import Scales
from harness.model.law import D_PARAMETER, INTERNAL_COLUMNS, VALUE
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.spline import SIDE
from harness.model.term import Slot, Term

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
    at = _looks(x, v)
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
    return Basis(with_tables, places, _left_free(held, shown.shape[1]), rough)


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


def force(model: Model, index: int, x: FloatArray, v: FloatArray, scales: Scales) -> FloatArray:
    """What a term's law writes along a motion, (n,)."""
    entry, laid, row = model.terms[index], lay_out(model, scales.v), np.zeros(INTERNAL_COLUMNS)
    found = np.zeros(x.size)
    assert entry.term.law is not None
    for i, (position, speed) in enumerate(zip(x.tolist(), v.tolist(), strict=True)):
        row[:] = 0.0
        entry.term.law(position, speed, laid.theta, laid.term_at[index], row)
        found[i] = row[VALUE]
    return found


def _values(term: Term) -> int:
    """Values of a table: its parameters but for its ends."""
    assert term.known is not None
    return min(term.known.places)


def _looks(x: FloatArray, v: FloatArray) -> IntArray:
    """Samples in motion, not too many."""
    moving = np.flatnonzero(v != 0.0)
    return moving[:: max(1, moving.size // _LOOKS)]


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
        fastest = {"|v|": np.abs(v), "v": v, "-v": -v}[known.of]
        values[known.high] = (1.0 + _MARGIN) * float(np.max(fastest))
    return ModelTerm(term, tuple(values))


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


def _left_free(held: list[FloatArray], count: int) -> FloatArray:
    """Orthonormal columns (count, q) of values that none of the functionals ``held`` (count,) sees."""
    if not held:
        return np.eye(count)
    _, size, rows = np.linalg.svd(np.array(held))
    seen = int(np.count_nonzero(size > _APART * size[0]))
    return np.asarray(rows[seen:].T, dtype=np.float64)
