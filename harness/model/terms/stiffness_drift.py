"""A spring whose stiffness changes with time: k rate t x."""

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_STIFFNESS, D_T, D_X, STIFFNESS, VALUE
from harness.model.term import Parameter, Slot, Term, always


def law(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k rate t x."""
    rate, k = theta[o], theta[STIFFNESS]
    out[VALUE] = k * rate * t * x
    out[D_X] = k * rate * t
    out[D_T] = k * rate * x
    out[D_STIFFNESS] = rate * t * x
    out[D_PARAMETER] = k * t * x


TERM = Term(
    "stiffness-drift",
    "stiffness",
    Slot.SMOOTH,
    (Parameter("rate", "1/s", none=0.0),),
    "The stiffness changes with time, by a fraction {rate}.",
    law,
    amplitude=0,
    needs=("spring", "returns"),
    example=(-0.1,),
    place=always("late", "in proportion to t"),
    told_from={"clock-drift": "the same decay with its acceleration measured besides, or by a clock that is known"},
    taken=0.14,
    order=180,
)
