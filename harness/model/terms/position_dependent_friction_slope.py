"""Friction that changes along the rail: 1 + slope x."""

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.term import Parameter, Slot, Term


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + slope x."""
    slope = theta[o]
    out[VALUE] = 1.0 + slope * x
    out[D_X] = slope
    out[D_PARAMETER] = x


TERM = Term(
    "position-dependent-friction",
    "friction",
    Slot.FRICTION_MODULATION,
    (Parameter("slope", "1/m", none=0.0),),
    "Friction changes along the rail: f_k (1 + slope x), slope = {slope}.",
    law,
    amplitude=0,
    needs=("returns",),
    example=(0.4,),
    taken=0.08,
    in_python="1.0 + slope * x",
    order=50,
)
