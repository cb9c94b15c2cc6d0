"""Which laws of the catalogue come nearest to a table: the share that each says, with its gauge taken off both."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.outcome import Table
from harness.diagnosis.problem import Problem
from harness.diagnosis.search.screen import applicable
from harness.diagnosis.tables.basis import partials
from harness.kernels.solve import Scales
from harness.model.evidence import Evidence
from harness.model.model import Model, ModelTerm
from harness.model.registry import NAMED
from harness.model.term import Slot, Term

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
