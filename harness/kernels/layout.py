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
_TIME_TERMS = frozenset({"harmonic-force", "stiffness-drift", "friction-drift", "normal-load-variation"})
MODULATIONS: Final = of_slot(Slot.FRICTION_MODULATION)
SMOOTH: Final = of_slot(Slot.SMOOTH)
INTERNAL: Final = of_slot(Slot.INTERNAL)


@dataclass(frozen=True, slots=True)
class Layout:
    """Arrays of a model.

    spec : (s,) int64. theta : (P,) float64. names : name of each place in theta ("c", "cubic-stiffness.k3").
    start : (n,) state at release. state_names : "x", "v", then internal states. speeds : places of the states that are
    speeds. term_at : first place of each term. fastest : largest angular frequency of a force in time, rad/s.
    A second term of a kind has "#2" behind its key in the names.
    """

    spec: IntArray
    theta: FloatArray
    names: tuple[str, ...]
    start: FloatArray
    state_names: tuple[str, ...]
    speeds: tuple[int, ...]
    term_at: tuple[int, ...]
    fastest: float


def lay_out(model: Model, v_scale: float) -> Layout:
    """Arrays of a model; v_scale is the speed (m/s) that counts as ordinary, for rounding of singular laws."""
    theta = [model.m, model.c, model.k, model.f_k, model.f_k if model.f_s is None else model.f_s, v_scale]
    names = ["m", "c", "k", "f_k", "f_s", "v_scale"]
    assert tuple(range(7)) == (MASS, VISCOUS, STIFFNESS, KINETIC, STATIC, V_SCALE, FIRST_TERM)
    term_at: list[int] = []
    labels: list[str] = []
    for i, entry in enumerate(model.terms):
        earlier = sum(other.term is entry.term for other in model.terms[:i])
        labels.append(f"{entry.term.key}#{earlier + 1}" if earlier else entry.term.key)
        term_at.append(len(theta))
        theta += entry.values
        names += [f"{labels[i]}.{name}" for name in entry.term.names]

    def of(*slots: Slot) -> list[tuple[int, ModelTerm]]:
        """Terms in these slots with the places of their parameters."""
        return [(at, e) for at, e in zip(term_at, model.terms, strict=True) if e.term.slot in slots]

    spec = [0] * LISTS
    spec[RESTORING] = _RESTORING[model.restoring]
    laws, levels = of(Slot.FRICTION_LAW), of(Slot.FRICTION_LEVEL)
    spec[FRICTION] = _FRICTION[laws[0][1].term.name] if laws else COULOMB
    spec[FRICTION_AT] = laws[0][0] if laws else -1
    spec[STRIBECK_AT] = levels[0][0] if levels else -1
    static = of(Slot.BREAK_AWAY) or levels
    spec[BREAK_AWAY_AT] = static[0][0] if static else (KINETIC if model.f_s is None else STATIC)
    modulations = [(MODULATIONS.index(e.term), at, len(e.values)) for at, e in of(Slot.FRICTION_MODULATION)]
    smooth = [(SMOOTH.index(e.term), at, len(e.values)) for at, e in of(Slot.SMOOTH)]
    start, state_names, speeds = [model.x0, model.v0], ["x", "v"], [1]
    if spec[FRICTION] == BRISTLE:
        start += laws[0][1].internal0
        state_names.append("presliding.z")
    internal = []
    for at, entry in of(Slot.INTERNAL):
        internal.append((INTERNAL.index(entry.term), at, len(entry.values), len(start), entry.term.internal))
        for i, value in enumerate(entry.internal0):
            state_names.append(f"{labels[term_at.index(at)]}.w{i}")
            if i in entry.term.speeds:
                speeds.append(len(start))
            start.append(value + (model.v0 if i in entry.term.speeds else 0.0))
    knocks = sorted(of(Slot.EVENT), key=lambda found: found[1].values[0])
    spec[N_MODULATION], spec[N_SMOOTH] = len(modulations), len(smooth)
    spec[N_INTERNAL], spec[N_KNOCK], spec[N_STATE] = len(internal), len(knocks), len(start)
    spec[CHANGES_IN_TIME] = int(bool(internal) or any(e.term.name in _TIME_TERMS for e in model.terms))
    for group in (*modulations, *smooth, *internal):
        spec += group
    spec += [at for at, _ in knocks]
    return Layout(
        np.array(spec, dtype=np.int64),
        np.array(theta, dtype=np.float64),
        tuple(names),
        np.array(start, dtype=np.float64),
        tuple(state_names),
        tuple(speeds),
        tuple(term_at),
        max((e.value("Omega") for e in model.terms if "Omega" in e.term.names), default=0.0),
    )
