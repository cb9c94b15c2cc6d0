"""A dead zone in the spring: no restoring force within the gap."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_STIFFNESS, D_X, STIFFNESS, VALUE
from harness.model.term import Element, Evidence, Parameter, Place, Polynomial, Probe, Seen, Slot, Term, Zone


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
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


def place(values: Probe, seen: Seen) -> Place:
    """Within the gap."""
    return Place("throughout", f"|x| < {values[0]:.4g} m", seen.where(np.abs(seen.x) < values[0]))


def made_of(values: Probe, k: float) -> tuple[Element, ...]:
    """The spring taken away, and given back outside of the gap."""
    return Polynomial(stiffness=(-k, 0.0, 0.0)), Zone(k, -values[0], values[0])


TERM = Term(
    "backlash",
    "stiffness",
    Slot.SMOOTH,
    (Parameter("gap", "m", 0.0, none=0.0, positive=True),),
    "The spring has a dead zone of {gap} either side of the middle.",
    law,
    probes,
    needs=("spring", "returns"),
    example=(0.06,),
    corner=True,
    place=place,
    elements=made_of,
    taken=0.05,
    order=170,
)
