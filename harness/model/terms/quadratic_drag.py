"""Drag that grows with the square of the speed: c2 |v| v."""

from harness.core.arrays import FloatArray
from harness.model.evidence import Evidence
from harness.model.law import D_PARAMETER, D_V, VALUE
from harness.model.term import Parameter, Probe, Slot, Term


def law(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c2 |v| v."""
    c2, s = theta[o], abs(v)
    out[VALUE] = c2 * s * v
    out[D_V] = 2.0 * c2 * s
    out[D_PARAMETER] = s * v


def probes(e: Evidence) -> list[Probe]:
    """Linear: one look."""
    return [(0.0,)]


TERM = Term(
    "quadratic-drag",
    "damping",
    Slot.SMOOTH,
    (Parameter("c2", "kg/m", none=0.0),),
    "A drag grows with the square of the speed: c2 = {c2}.",
    law,
    probes,
    amplitude=0,
)
