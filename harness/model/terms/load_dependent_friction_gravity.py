"""Friction that grows with the torque of gravity on a bearing: 1 + gain |sin x|."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.term import AGAIN, LARGER, Parameter, Slot, Term, always


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + gain |sin x|."""
    gain = theta[o]
    s = math.sin(x)
    out[VALUE] = 1.0 + gain * math.fabs(s)
    out[D_X] = math.copysign(gain, s) * math.cos(x)
    out[D_PARAMETER] = math.fabs(s)


TERM = Term(
    "load-dependent-friction",
    "friction",
    Slot.FRICTION_MODULATION,
    (Parameter("gain", "1", 0.0, none=0.0),),
    "Friction grows with the torque of gravity: f_k (1 + gain |sin x|), gain = {gain}.",
    law,
    amplitude=0,
    corner=True,
    needs=("angle", "returns"),
    variant="gravity",
    example=(0.8,),
    place=always("large-displacement", "in proportion to |sin x|"),
    told_from={
        "quadratic-drag": LARGER,
        "friction-drift": AGAIN,
    },
    in_python="1.0 + gain * abs(sin(x))",
    order=56,
)
