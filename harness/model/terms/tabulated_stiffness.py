"""A force that depends on position, as a table: what no law of the catalogue says."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.law import COLUMNS, D_PARAMETER, D_X, VALUE
from harness.model.spline import KNOTS, curve
from harness.model.term import Element, Known, Parameter, Polynomial, Probe, Slot, Term, always

_LOW, _HIGH = KNOTS, KNOTS + 1
_POINTS = 8 * KNOTS
"""Places that a polynomial is laid through."""
_AS_GOOD = 0.01
"""Of the table's largest force, what a polynomial may be off anywhere and still be the table in other words: a tenth of
what tables are known to, see the band that they are drawn with."""


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


def made_of(values: Probe, k: float) -> tuple[Element, ...]:
    """A spring's first three coefficients, where these say the whole table to a hundredth; else nothing."""
    low, high = values[_LOW], values[_HIGH]
    reach = max(abs(low), abs(high))
    if not high > low:
        return ()
    x = np.linspace(low, high, _POINTS)
    theta, row, force = np.array(values), np.zeros(COLUMNS), np.empty(_POINTS)
    for i, place in enumerate(x):
        law(float(place), 0.0, theta, 0, row)
        force[i] = row[VALUE]
    powers = np.vander(x / reach, 4)[:, 2::-1]
    found, *_ = np.linalg.lstsq(powers, force, rcond=None)
    if np.max(np.abs(powers @ found - force)) > _AS_GOOD * np.max(np.abs(force)):
        return ()
    a, b, c = (float(one) / reach ** (i + 1) for i, one in enumerate(found))
    return (Polynomial(stiffness=(a, b, c)),)


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
    elements=made_of,
    place=always("throughout", "by position"),
    order=900,
)
