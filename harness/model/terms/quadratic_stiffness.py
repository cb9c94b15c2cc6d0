"""A spring whose two sides differ: k2 x^2."""

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.term import Element, Parameter, Polynomial, Probe, Slot, Term, always


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k2 x^2."""
    k2 = theta[o]
    out[VALUE] = k2 * x * x
    out[D_X] = 2.0 * k2 * x
    out[D_PARAMETER] = x * x


def made_of(values: Probe, k: float) -> tuple[Element, ...]:
    """The second coefficient of a spring."""
    return (Polynomial(stiffness=(0.0, values[0], 0.0)),)


TERM = Term(
    "quadratic-stiffness",
    "stiffness",
    Slot.SMOOTH,
    (Parameter("k2", "N/m^2", none=0.0),),
    "The two sides of the spring differ: a force k2 x^2 with k2 = {k2}.",
    law,
    amplitude=0,
    needs=("returns",),
    example=(20.0,),
    place=always("large-displacement", "as x^2"),
    elements=made_of,
    order=140,
)
