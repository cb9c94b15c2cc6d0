"""A force that depends on position, as a table: what no law of the catalogue says."""

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.place import always
from harness.model.spline import KNOTS, curve
from harness.model.term import Known, Parameter, Slot, Term

_LOW, _HIGH = KNOTS, KNOTS + 1


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """f(x), a natural cubic spline through f_1 to f_12 at even steps from low to high; beyond, the last value."""
    low, width = theta[o + _LOW], theta[o + _HIGH] - theta[o + _LOW]
    if width <= 0.0:
        return
    step = (KNOTS - 1) / width
    u = (x - low) * step
    value, slope = curve(u, 0, theta, o, out)
    out[VALUE] = value
    out[D_X] = slope * step
    out[D_PARAMETER + _LOW] = slope * step * ((x - low) / width - 1.0)
    out[D_PARAMETER + _HIGH] = -slope * step * (x - low) / width


TERM = Term(
    "tabulated-stiffness",
    "stiffness",
    Slot.SMOOTH,
    (*(Parameter(f"f_{i + 1}", "N") for i in range(KNOTS)), Parameter("low", "m"), Parameter("high", "m")),
    "A force that depends on position, as a table from {low} to {high}.",
    law,
    corner=True,
    example=(9.0, 3.0, -2.0, -3.0, 0.0, 4.0, 3.0, -4.0, -8.0, -5.0, 2.0, 6.0, -1.2, 1.3),
    push=5,
    searched=False,
    known=Known("x", _LOW, _HIGH),
    place=always("throughout", "by position"),
    order=900,
)
