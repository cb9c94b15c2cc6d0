"""Friction that grows with the load of the spring across a constant one: sqrt(1 + gain_2 x^2)."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.term import AGAIN, LARGER, Parameter, Slot, Term, always


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor sqrt(1 + gain_2 x^2): of two loads at right angles, one of them in proportion to x."""
    gain_2 = theta[o]
    load = math.sqrt(1.0 + gain_2 * x * x)
    out[VALUE] = load
    out[D_X] = gain_2 * x / load
    out[D_PARAMETER] = 0.5 * x * x / load


TERM = Term(
    "load-dependent-friction",
    "friction",
    Slot.FRICTION_MODULATION,
    (Parameter("gain_2", "1/m^2", 0.0, none=0.0),),
    "Friction grows with the load of the spring across a constant one: f_k sqrt(1 + gain_2 x^2), gain_2 = {gain_2}.",
    law,
    amplitude=0,
    needs=("returns",),
    variant="across",
    example=(2.0,),
    place=always("large-displacement", "as a constant load and one in proportion to x add up at right angles"),
    told_from={
        "quadratic-drag": LARGER,
        "friction-drift": AGAIN,
    },
    in_python="(1.0 + gain_2 * x * x) ** 0.5",
    order=57,
)
