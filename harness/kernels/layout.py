"""A model as arrays: what the compiled integrator reads, and the compiled laws that its dispatch calls.

``spec`` holds numbers of laws and places of their parameters; ``theta`` holds every parameter. Terms of one slot stand
one after another, so that a sum of any length costs no branching beyond the dispatch of each law.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.errors import InputError
from harness.core.jit import compiled
from harness.model.covariate import GIVEN, Acts
from harness.model.law import FIRST_TERM, KINETIC, MASS, STATIC, STIFFNESS, V_SCALE, VISCOUS
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import of_slot
from harness.model.term import Slot, Term

# places in spec
RESTORING, FRICTION, FRICTION_LAW, FRICTION_AT, FRICTION_SIZE, LEVEL, LEVEL_AT, LEVEL_SIZE, BREAK_AWAY_AT = range(9)
N_MODULATION, N_SMOOTH, N_INTERNAL, N_KNOCK, N_STATE, CHANGES_IN_TIME, LISTS = range(9, 16)

# values of FRICTION
NO_FRICTION, COULOMB, BRISTLE, REGULARISED = range(4)
# values of RESTORING
NO_SPRING, SPRING, PENDULUM = range(3)

_RESTORING = {Restoring.NONE: NO_SPRING, Restoring.SPRING: SPRING, Restoring.PENDULUM: PENDULUM}
MODULATIONS: Final = (*of_slot(Slot.FRICTION_MODULATION), GIVEN[Acts.FRICTION])
SMOOTH: Final = (*of_slot(Slot.SMOOTH), GIVEN[Acts.FORCE], GIVEN[Acts.DAMPING])
INTERNAL: Final = of_slot(Slot.INTERNAL)
LEVELS: Final = of_slot(Slot.FRICTION_LEVEL)
BRISTLES: Final = tuple(t for t in of_slot(Slot.FRICTION_LAW) if t.internal)
SMOOTHED: Final = tuple(t for t in of_slot(Slot.FRICTION_LAW) if not t.internal)


@dataclass(frozen=True, slots=True)
class Layout:
    """Arrays of a model.

    spec : (s,) int64. theta : (P,) float64, tables that laws are given last. names : name of each place before
    them ("c", "cubic-stiffness.k3").
    start : (n,) state at release. state_names : "x", "v", then internal states. speeds : places of the states that are
    speeds. term_at : first place of each term. fastest : largest angular frequency of a force in time, rad/s.
    """

    spec: IntArray
    theta: FloatArray
    names: tuple[str, ...]
    start: FloatArray
    state_names: tuple[str, ...]
    speeds: tuple[int, ...]
    term_at: tuple[int, ...]
    fastest: float


@dataclass(frozen=True, slots=True)
class _Shape:
    """What all models of the same laws have in common; see Layout.

    terms : which these are, kept so that what they are known by stays theirs. pointers : places in theta that say where
    a table begins. starts : of each internal state, its term, its place among that term's own, and whether it is a
    speed. knocks : terms that are, whose places end spec in the order of their times.
    """

    terms: tuple[Term, ...]
    spec: IntArray
    names: tuple[str, ...]
    state_names: tuple[str, ...]
    speeds: tuple[int, ...]
    term_at: tuple[int, ...]
    pointers: tuple[tuple[int, int], ...]
    starts: tuple[tuple[int, int, bool], ...]
    knocks: tuple[int, ...]


_SHAPES: dict[tuple[object, ...], _Shape] = {}
_MOST_SHAPES = 4096


def _shape_of(model: Model) -> _Shape:
    """By the terms themselves: a fit lays out one shape of model thousands of times."""
    laws = [(id(e.term), len(e.given), len(e.internal0)) for e in model.terms]
    made_of = (model.restoring, model.f_s is None, *laws)
    found = _SHAPES.get(made_of)
    if found is None:
        if len(_SHAPES) >= _MOST_SHAPES:
            _SHAPES.clear()
        found = _SHAPES[made_of] = _shaped(model)
    return found


def _shaped(model: Model) -> _Shape:
    names = ["m", "c", "k", "f_k", "f_s", "v_scale"]
    assert tuple(range(7)) == (MASS, VISCOUS, STIFFNESS, KINETIC, STATIC, V_SCALE, FIRST_TERM)
    term_at: list[int] = []
    pointers: list[tuple[int, int]] = []
    for i, (label, entry) in enumerate(zip(model.labels, model.terms, strict=True)):
        term_at.append(len(names))
        names += [f"{label}.{name}" for name in entry.term.names]
        if entry.given:
            pointers.append((len(names), i))
            names.append(f"{label}.given")

    def of(slot: Slot) -> list[tuple[int, int, ModelTerm]]:
        """Terms in a slot with their numbers and the places of their parameters."""
        return [(i, term_at[i], e) for i, e in enumerate(model.terms) if e.term.slot is slot]

    spec = [0] * LISTS
    spec[RESTORING] = _RESTORING[model.restoring]
    laws, levels = of(Slot.FRICTION_LAW), of(Slot.FRICTION_LEVEL)
    spec[FRICTION], spec[FRICTION_AT], spec[LEVEL_AT] = COULOMB, -1, -1
    for _, at, entry in laws:
        of_kind = BRISTLES if entry.term.internal else SMOOTHED
        spec[FRICTION] = BRISTLE if entry.term.internal else REGULARISED
        spec[FRICTION_LAW], spec[FRICTION_AT] = of_kind.index(entry.term), at
        spec[FRICTION_SIZE] = len(entry.values)
    for _, at, entry in levels:
        spec[LEVEL], spec[LEVEL_AT], spec[LEVEL_SIZE] = LEVELS.index(entry.term), at, len(entry.values)
    static = of(Slot.BREAK_AWAY) or levels
    spec[BREAK_AWAY_AT] = static[0][1] if static else (KINETIC if model.f_s is None else STATIC)
    modulations = [(MODULATIONS.index(e.term), at, len(e.values)) for _, at, e in of(Slot.FRICTION_MODULATION)]
    smooth = [(SMOOTH.index(e.term), at, len(e.values)) for _, at, e in of(Slot.SMOOTH)]
    state_names, speeds, starts = ["x", "v"], [1], []
    inside = any(e.term.internal for e in model.terms)
    own_names = model.internal_names if inside else ()
    if spec[FRICTION] == BRISTLE:
        starts += [(laws[0][0], j, False) for j in range(len(laws[0][2].internal0))]
        state_names += own_names[laws[0][0]]
    internal = []
    for i, at, entry in of(Slot.INTERNAL):
        internal.append((INTERNAL.index(entry.term), at, len(entry.values), 2 + len(starts), entry.term.internal))
        state_names += own_names[i]
        for j in range(len(entry.internal0)):
            if j in entry.term.speeds:
                speeds.append(2 + len(starts))
            starts.append((i, j, j in entry.term.speeds))
    knocks = tuple(i for i, _, _ in of(Slot.EVENT))
    spec[N_MODULATION], spec[N_SMOOTH] = len(modulations), len(smooth)
    spec[N_INTERNAL], spec[N_KNOCK], spec[N_STATE] = len(internal), len(knocks), 2 + len(starts)
    spec[CHANGES_IN_TIME] = int(bool(internal) or any(e.term.changes_in_time for e in model.terms))
    for group in (*modulations, *smooth, *internal):
        spec += group
    spec += [term_at[i] for i in knocks]
    return _Shape(
        tuple(e.term for e in model.terms),
        np.array(spec, dtype=np.int64),
        tuple(names),
        tuple(state_names),
        tuple(speeds),
        tuple(term_at),
        tuple(pointers),
        tuple(starts),
        knocks,
    )


def lay_out(model: Model, v_scale: float) -> Layout:
    """Arrays of a model; v_scale is the speed (m/s) that counts as ordinary, for rounding of singular laws."""
    shape = _shape_of(model)
    theta = [model.m, model.c, model.k, model.f_k, model.f_k if model.f_s is None else model.f_s, v_scale]
    for entry in model.terms:
        theta += entry.values
        if entry.given:
            theta.append(0.0)
    for pointer, i in shape.pointers:
        theta[pointer] = float(len(theta))
        theta += model.terms[i].given
    start = [model.x0, model.v0]
    for i, j, is_speed in shape.starts:
        start.append(model.terms[i].internal0[j] + (model.v0 if is_speed else 0.0))
    spec = shape.spec
    if len(shape.knocks) > 1:
        spec = spec.copy()
        in_turn = sorted(shape.knocks, key=lambda i: model.terms[i].values[0])
        spec[-len(in_turn) :] = [shape.term_at[i] for i in in_turn]
    return Layout(
        spec,
        np.array(theta, dtype=np.float64),
        shape.names,
        np.array(start, dtype=np.float64),
        shape.state_names,
        shape.speeds,
        shape.term_at,
        max((e.repeats("time") or 0.0 for e in model.terms), default=0.0),
    )


def laws(terms: tuple[Term, ...], *keys: str) -> tuple[Callable[..., None], ...]:
    """The compiled laws of ``terms``, which the dispatch numbers as ``keys``.

    Raises InputError when the two differ: a term was installed or taken away since the dispatch was written.
    """
    here = [term.key for term in terms]
    if here != list(keys):
        parts = [("without", set(here) - set(keys)), ("with", set(keys) - set(here))]
        found = ", ".join(f"{word} {', '.join(sorted(some))}" for word, some in parts if some) or "in another order"
        accepted = "what python -m harness.kernels.generate writes"
        raise InputError("harness/kernels/dispatch.py", f"written {found}", accepted)
    return tuple(compiled(term.law, lean=True) for term in terms if term.law is not None)
