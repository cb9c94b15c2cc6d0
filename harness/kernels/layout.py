"""A model as arrays: what the compiled integrator reads.

``spec`` holds numbers of laws and places of their parameters; ``theta`` holds every parameter. Terms of one slot stand
one after another, so that a sum of any length costs no branching beyond the dispatch of each law.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.model.law import FIRST_TERM, KINETIC, MASS, STATIC, STIFFNESS, V_SCALE, VISCOUS
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import of_slot
from harness.model.term import Slot

# places in spec
RESTORING: Final = 0
FRICTION: Final = 1
FRICTION_AT: Final = 2
STRIBECK_AT: Final = 3
BREAK_AWAY_AT: Final = 4
N_MODULATION: Final = 5
N_SMOOTH: Final = 6
N_INTERNAL: Final = 7
N_KNOCK: Final = 8
N_STATE: Final = 9
CHANGES_IN_TIME: Final = 10
LISTS: Final = 11

# values of FRICTION
NO_FRICTION, COULOMB, BRISTLE, REGULARISED = range(4)
# values of RESTORING
NO_SPRING, SPRING, PENDULUM = range(3)

_RESTORING = {Restoring.NONE: NO_SPRING, Restoring.SPRING: SPRING, Restoring.PENDULUM: PENDULUM}
_FRICTION = {"presliding": BRISTLE, "regularised-friction": REGULARISED}
_TIME_TERMS = frozenset({"harmonic-force", "stiffness-drift", "friction-drift", "normal-load-variation", "impulse"})
MODULATIONS: Final = of_slot(Slot.FRICTION_MODULATION)
SMOOTH: Final = of_slot(Slot.SMOOTH)
INTERNAL: Final = of_slot(Slot.INTERNAL)


@dataclass(frozen=True, slots=True)
class Layout:
    """Arrays of a model.

    spec : (s,) int64. theta : (P,) float64. names : name of each place in theta ("c", "cubic-stiffness.k3").
    start : (n,) state at release. state_names : "x", "v", then internal states. term_at : first place of each term.
    """

    spec: IntArray
    theta: FloatArray
    names: tuple[str, ...]
    start: FloatArray
    state_names: tuple[str, ...]
    term_at: tuple[int, ...]


def lay_out(model: Model, v_scale: float) -> Layout:
    """Arrays of a model; v_scale is the speed (m/s) that counts as ordinary, for rounding of singular laws."""
    theta = [model.m, model.c, model.k, model.f_k, model.f_k if model.f_s is None else model.f_s, v_scale]
    names = ["m", "c", "k", "f_k", "f_s", "v_scale"]
    assert tuple(range(7)) == (MASS, VISCOUS, STIFFNESS, KINETIC, STATIC, V_SCALE, FIRST_TERM)
    term_at = []
    for entry in model.terms:
        term_at.append(len(theta))
        theta += entry.values
        names += [f"{entry.term.key}.{name}" for name in entry.term.names]

    def place(entry: ModelTerm) -> int:
        return next(at for at, other in zip(term_at, model.terms, strict=True) if other is entry)

    spec = [0] * LISTS
    spec[RESTORING] = _RESTORING[model.restoring]
    laws = model.in_slot(Slot.FRICTION_LAW)
    spec[FRICTION] = _FRICTION[laws[0].term.name] if laws else COULOMB
    spec[FRICTION_AT] = place(laws[0]) if laws else -1
    levels = model.in_slot(Slot.FRICTION_LEVEL)
    spec[STRIBECK_AT] = place(levels[0]) if levels else -1
    static = model.in_slot(Slot.BREAK_AWAY) or levels
    spec[BREAK_AWAY_AT] = place(static[0]) if static else (KINETIC if model.f_s is None else STATIC)
    modulations = [
        (MODULATIONS.index(e.term), place(e), len(e.values)) for e in model.in_slot(Slot.FRICTION_MODULATION)
    ]
    smooth = [(SMOOTH.index(e.term), place(e), len(e.values)) for e in model.in_slot(Slot.SMOOTH)]
    start, state_names = [model.x0, model.v0], ["x", "v"]
    if spec[FRICTION] == BRISTLE:
        start.append(0.0)
        state_names.append("presliding.z")
    internal = []
    for entry in model.in_slot(Slot.INTERNAL):
        internal.append((INTERNAL.index(entry.term), place(entry), len(entry.values), len(start), entry.term.internal))
        start += entry.internal0
        state_names += [f"{entry.term.key}.w{i}" for i in range(entry.term.internal)]
    knocks = sorted(model.in_slot(Slot.EVENT), key=lambda e: e.values[0])
    spec[N_MODULATION], spec[N_SMOOTH] = len(modulations), len(smooth)
    spec[N_INTERNAL], spec[N_KNOCK], spec[N_STATE] = len(internal), len(knocks), len(start)
    spec[CHANGES_IN_TIME] = int(bool(internal) or any(e.term.name in _TIME_TERMS for e in model.terms))
    for group in (*modulations, *smooth, *internal):
        spec += group
    spec += [place(e) for e in knocks]
    return Layout(
        np.array(spec, dtype=np.int64),
        np.array(theta, dtype=np.float64),
        tuple(names),
        np.array(start, dtype=np.float64),
        tuple(state_names),
        tuple(term_at),
    )
