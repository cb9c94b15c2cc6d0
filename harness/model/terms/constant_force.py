"""A constant push: tilt, bias."""

from collections.abc import Mapping

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, VALUE
from harness.model.term import LARGER, REST, Element, Parameter, Probe, Push, Slot, Term


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """-force: it stands on the right side."""
    out[VALUE] = -theta[o]
    out[D_PARAMETER] = -1.0


def made_of(values: Probe, k: float) -> tuple[Element, ...]:
    """A push."""
    return (Push(values[0]),)


def words(values: Probe, k: float) -> Mapping[str, str]:
    """By how much it moves the rest position of a spring."""
    return {"moves": f" (on a linear spring the same as an offset of x by {values[0] / k:.4g})" if k > 0.0 else ""}


TERM = Term(
    "constant-force",
    "environment",
    Slot.SMOOTH,
    (Parameter("force", "N", none=0.0),),
    "A constant force of {force} pushes the slider{moves}.",
    law,
    amplitude=0,
    example=(3.0,),
    needs=("zero",),
    push=0,
    words=words,
    elements=made_of,
    told_from={"sensor-drift": REST, "force-ripple": LARGER},
    order=190,
)
