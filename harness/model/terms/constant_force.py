"""A constant push: tilt, bias."""

from harness.core.arrays import FloatArray
from harness.model.evidence import Evidence
from harness.model.law import D_PARAMETER, VALUE
from harness.model.term import Parameter, Probe, Slot, Term


def law(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """-force: it stands on the right side."""
    out[VALUE] = -theta[o]
    out[D_PARAMETER] = -1.0


def probes(e: Evidence) -> list[Probe]:
    """Linear: one look."""
    return [(0.0,)]


TERM = Term(
    "constant-force",
    "environment",
    Slot.SMOOTH,
    (Parameter("force", "N", none=0.0),),
    "A constant force of {force} pushes the slider (on a linear spring the same as an offset of x by {offset}).",
    law,
    probes,
    amplitude=0,
)
