"""A dead zone in the spring: no restoring force within the gap."""

from harness.core.arrays import FloatArray
from harness.model.evidence import Evidence
from harness.model.law import D_PARAMETER, D_STIFFNESS, D_X, STIFFNESS, VALUE
from harness.model.term import Parameter, Probe, Slot, Term


def law(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """-k clip(x, -gap, gap)."""
    gap, k = theta[o], theta[STIFFNESS]
    clipped = min(max(x, -gap), gap)
    out[VALUE] = -k * clipped
    out[D_X] = -k if -gap < x < gap else 0.0
    out[D_STIFFNESS] = -clipped
    out[D_PARAMETER] = 0.0 if -gap < x < gap else (-k if x > 0.0 else k)


def probes(e: Evidence) -> list[Probe]:
    """Nearly linear in the gap while it is small."""
    return [(f * e.x_scale,) for f in (0.003, 0.02, 0.08)]


TERM = Term(
    "backlash",
    "stiffness",
    Slot.SMOOTH,
    (Parameter("gap", "m", 0.0, none=0.0, positive=True),),
    "The spring has a dead zone of {gap} either side of the middle.",
    law,
    probes,
    needs=("spring",),
)
