"""A spring that hardens or softens: k3 x^3."""

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.term import LARGER, Element, Parameter, Polynomial, Probe, Slot, Term, always


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k3 x^3."""
    k3, x2 = theta[o], x * x
    out[VALUE] = k3 * x2 * x
    out[D_X] = 3.0 * k3 * x2
    out[D_PARAMETER] = x2 * x


def made_of(values: Probe, k: float) -> tuple[Element, ...]:
    """The third coefficient of a spring."""
    return (Polynomial(stiffness=(0.0, 0.0, values[0])),)


TERM = Term(
    "cubic-stiffness",
    "stiffness",
    Slot.SMOOTH,
    (Parameter("k3", "N/m^3", none=0.0),),
    "The spring is not linear: a cubic force k3 x^3 with k3 = {k3} (above 0 hardens, below 0 softens).",
    law,
    amplitude=0,
    needs=("returns",),
    example=(20.0,),
    place=always("large-displacement", "as x^3"),
    elements=made_of,
    told_from={"end-stop": LARGER, "stiffness-drift": LARGER},
    taken=0.13,
    order=130,
)
