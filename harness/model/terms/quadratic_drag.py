"""Drag that grows with the square of the speed: c2 |v| v."""

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_V, VALUE
from harness.model.term import Element, Parameter, Polynomial, Probe, Slot, Term, always


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c2 |v| v."""
    c2, s = theta[o], abs(v)
    out[VALUE] = c2 * s * v
    out[D_V] = 2.0 * c2 * s
    out[D_PARAMETER] = s * v


def made_of(values: Probe, k: float) -> tuple[Element, ...]:
    """The second coefficient of a damper."""
    return (Polynomial(damping=(0.0, values[0], 0.0)),)


TERM = Term(
    "quadratic-drag",
    "damping",
    Slot.SMOOTH,
    (Parameter("c2", "kg/m", 0.0, none=0.0),),
    "A drag grows with the square of the speed: c2 = {c2}.",
    law,
    amplitude=0,
    example=(0.2,),
    place=always("high-speed", "as v^2"),
    elements=made_of,
    in_python="c2 * abs(v) * v",
    taken=0.05,
    order=90,
)
