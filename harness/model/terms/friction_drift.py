"""Friction that changes with time: wear, warm-up."""

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_T, VALUE
from harness.model.term import AGAIN, Parameter, Place, Probe, Seen, Slot, Term, always


def law(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + rate t."""
    rate = theta[o]
    out[VALUE] = 1.0 + rate * t
    out[D_T] = rate
    out[D_PARAMETER] = t


def place(values: Probe, seen: Seen) -> Place:
    """Everywhere, and late most; where it falls to nothing, up to there."""
    gone = -1.0 / values[0] if values[0] < 0.0 else float("inf")
    first, last = float(seen.t[0]), float(seen.t[-1])
    if not first < gone < last:
        return always("late", "in proportion to t")(values, seen)
    return Place("early", f"until friction is gone at t = {gone:.4g} s", ((first, gone),))


TERM = Term(
    "friction-drift",
    "friction",
    Slot.FRICTION_MODULATION,
    (Parameter("rate", "1/s", none=0.0),),
    "Friction changes with time: f_k (1 + rate t), rate = {rate}.",
    law,
    amplitude=0,
    needs=("returns",),
    example=(-0.2,),
    place=place,
    told_from={"position-dependent-friction": AGAIN, "quadratic-drag": AGAIN},
    taken=0.08,
    in_python="1.0 + rate * t",
    order=70,
)
