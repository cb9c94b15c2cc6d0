"""Models that the tests of the integrator share: every term of the catalogue, pairs, and driven ones."""

from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.kernels.solve import By, Drive, Effort, Scales, Solution, solve
from harness.model.model import Model, ModelTerm
from harness.model.registry import TERMS
from harness.model.registry import term as find
from harness.model.term import Slot

SHOWN = frozenset({Slot.OBSERVATION, Slot.BREAK_AWAY})
"""Slots without dynamics, and with some only where something is held."""
VALUES = {t.key: t.example for t in TERMS if t.slot not in SHOWN}
"""Parameters of every term with dynamics, large enough to matter."""


def term(key: str, *values: float) -> ModelTerm:
    return ModelTerm(find(key), values or VALUES[key])


def model(*terms: ModelTerm, **base: float) -> Model:
    b = {"m": 1.3, "c": 0.8, "k": 90.0, "f_k": 2.0, "x0": 1.0, "v0": 0.5, **base}
    return Model(b["m"], b["c"], b["k"], b["f_k"], b.get("f_s"), x0=b["x0"], v0=b["v0"], terms=terms)


_KNOTS = np.linspace(0.0, 6.0, 400)
DRIVE = Drive(_KNOTS, 8.0 * np.sin(2.1 * _KNOTS) + 4.0 * np.sin(5.3 * _KNOTS + 1.0))


def value_of(m: Model, by: By) -> float:
    if isinstance(by, tuple):
        return m.terms[by[0]].values[by[1]]
    return 0.0 if "." in by else float(getattr(m, by))


def moved(m: Model, by: By, change: float) -> Model:
    """The model with one parameter changed."""
    if isinstance(by, str) and "." not in by:
        return replace(m, **{by: getattr(m, by) + change})
    terms = list(m.terms)
    if isinstance(by, tuple):
        i, values = by[0], list(m.terms[by[0]].values)
        values[by[1]] += change
        terms[i] = ModelTerm(terms[i].term, tuple(values), terms[i].internal0)
    else:
        i, j = next((i, names.index(by)) for i, names in enumerate(m.internal_names) if by in names)
        start = list(terms[i].internal0)
        start[j] += change
        terms[i] = ModelTerm(terms[i].term, terms[i].values, tuple(start))
    return replace(m, terms=tuple(terms))


def every_parameter(m: Model) -> tuple[By, ...]:
    base = [name for name in ("x0", "v0", "m", "c", "k", "f_k") if not (name == "k" and m.k == 0.0)]
    if m.f_s is not None:
        base.append("f_s")
    starts = [name for names in m.internal_names for name in names]
    own: list[By] = [(i, j) for i, e in enumerate(m.terms) for j in range(len(e.values))]
    return (*base, *own, *starts)


def goal(m: Model) -> float:
    """Error to stay below: at a corner of a law the differences keep the step errors of two motions, or straddle it."""
    smoothed = any(not e.term.internal for e in m.in_slot(Slot.FRICTION_LAW))
    return 3e-5 if smoothed else (1e-5 if any(e.term.corner for e in m.terms) else 2e-6)


def _bends(m: Model, by: By) -> float:
    """How far a bristle bends, by whose deflection differences are taken; 0 for others."""
    whose = (e for e, names in zip(m.terms, m.internal_names, strict=True) if by in names)
    return next((e.presliding(m.f_k) or 0.0 for e in whose), 0.0)


def difference_error(m: Model, t: FloatArray, drive: Drive | None = None) -> tuple[float, str, Solution]:
    """Largest error of dx, dv, da against differences of fourth order, relative to the size of each; where; the motion.

    Left out are samples near an event, where the difference straddles a jump, and those where differences over one and
    two steps do not agree, because they straddle a corner of a law; most must remain.
    """
    scales = Scales.of(m, drive)
    effort = Effort(1e-13, 400_000)
    by = every_parameter(m)
    # wide enough to drown the step errors at the corners of each law, which x keeps and which differ from processor to
    # processor; narrow enough not to move an event past a sample
    relative = 2e-4 * sum(e.term.corner for e in m.terms) or 5e-5
    agree = max(1e-5, goal(m)) if goal(m) > 2e-6 else 1e-4
    s = solve(m, t, by, drive, scales, effort)
    worst, where = 0.0, ""
    clear = np.ones(t.size, dtype=bool)
    for time in s.events.t:
        clear &= np.abs(t - time) > 5e-3 / scales.omega
    for q, name in enumerate(by):
        value = abs(value_of(m, name)) or _bends(m, name)
        step = relative * (value or {"v0": scales.v}.get(str(name), scales.x))
        near = [solve(moved(m, name, i * step), t, (), drive, scales, effort) for i in (1, -1, 2, -2)]
        for channel in ("x", "v", "a"):
            y = [getattr(n, channel) for n in near]
            narrow, wide = (y[0] - y[1]) / (2.0 * step), (y[2] - y[3]) / (4.0 * step)
            got = getattr(s, f"d{channel}")[:, q]
            unit = {"x": scales.x, "v": scales.v, "a": scales.v * scales.omega}[channel]
            size = max(float(np.abs(got).max()), 1e-3 * unit / (value or scales.x))
            usable = clear & (np.abs(narrow - wide) < agree * size)
            assert np.count_nonzero(usable) > 0.5 * t.size, f"differences by {name} do not converge"
            error = float(np.abs((4.0 * narrow - wide) / 3.0 - got)[usable].max()) / size
            if error > worst:
                worst, where = error, f"{name} {channel}"
    return worst, where, s
