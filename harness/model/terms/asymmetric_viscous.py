"""Viscous damping that depends on the direction: c +- c_diff."""

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_V, VALUE
from harness.model.term import Parameter, Slot, Term


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c_diff |v|."""
    c_diff, s = theta[o], abs(v)
    out[VALUE] = c_diff * s
    out[D_V] = c_diff if v > 0.0 else (-c_diff if v < 0.0 else 0.0)
    out[D_PARAMETER] = s


TERM = Term(
    "asymmetric-viscous",
    "damping",
    Slot.SMOOTH,
    (Parameter("c_diff", "N s/m", none=0.0),),
    "Viscous damping differs by direction: c + c_diff forwards, c - c_diff backwards, c_diff = {c_diff}.",
    law,
    amplitude=0,
    needs=("both-ways",),
    example=(0.3,),
    in_python="c_diff * abs(v)",
    order=100,
)
