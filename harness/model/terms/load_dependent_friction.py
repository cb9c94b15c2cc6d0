"""Friction that grows with the load of the spring on its guide: 1 + gain |x|."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.term import AGAIN, LARGER, Parameter, Slot, Term, always


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + gain |x|."""
    gain = theta[o]
    out[VALUE] = 1.0 + gain * math.fabs(x)
    out[D_X] = math.copysign(gain, x)
    out[D_PARAMETER] = math.fabs(x)


TERM = Term(
    "load-dependent-friction",
    "friction",
    Slot.FRICTION_MODULATION,
    (Parameter("gain", "1/m", 0.0, none=0.0),),
    "Friction grows with the load of the spring: f_k (1 + gain |x|), gain = {gain}.",
    law,
    amplitude=0,
    needs=("returns",),
    corner=True,
    example=(0.8,),
    place=always("large-displacement", "in proportion to |x|"),
    told_from={
        "quadratic-drag": LARGER,
        "friction-drift": AGAIN,
    },
    in_python="1.0 + gain * abs(x)",
    order=55,
)
