"""Laws of what is measured beside the motion: a column that pushes, or makes friction or damping more or less.

They are no names of the catalogue: what they are given belongs to a recording. Behind its parameters each finds the
place in theta of its table (``ModelTerm.given``): begin (s), 1 / step, number of values less 1, and the values, the
column less its mean.
"""

from collections.abc import Callable
from typing import Final

from harness.core.arrays import FloatArray
from harness.core.jit import lean
from harness.model.covariate import Acts
from harness.model.law import D_PARAMETER, D_T, D_V, VALUE, VISCOUS
from harness.model.term import Parameter, Slot, Term

BEGIN, RATE, LAST, FIRST_VALUE = range(4)


@lean
def change(t: float, theta: FloatArray, at: int) -> tuple[float, float]:
    """Value and slope of a table at t, s, linear between its values and constant outside."""
    u = (t - theta[at + BEGIN]) * theta[at + RATE]
    last = theta[at + LAST]
    # nan too: it must not become a place in memory
    if not u > 0.0:
        return theta[at + FIRST_VALUE], 0.0
    if u >= last:
        return theta[at + FIRST_VALUE + int(last)], 0.0
    i = int(u)
    low, high = theta[at + FIRST_VALUE + i], theta[at + FIRST_VALUE + i + 1]
    return low + (u - i) * (high - low), (high - low) * theta[at + RATE]


def force(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """-(level + gain (P - mean)): it stands on the right side."""
    value, rate = change(t, theta, int(theta[o + 2]))
    out[VALUE] = -(theta[o + 1] + theta[o] * value)
    out[D_T] = -theta[o] * rate
    out[D_PARAMETER] = -value
    out[D_PARAMETER + 1] = -1.0


def friction(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + gain (P - mean), never below 0."""
    value, rate = change(t, theta, int(theta[o + 1]))
    factor = 1.0 + theta[o] * value
    if factor > 0.0:
        out[VALUE] = factor
        out[D_T] = theta[o] * rate
        out[D_PARAMETER] = value


def damping(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c gain (P - mean) v, which with c v is never below 0 times it."""
    value, rate = change(t, theta, int(theta[o + 1]))
    c, more = theta[VISCOUS], theta[o] * value
    if more > -1.0:
        out[VALUE] = c * more * v
        out[D_V] = c * more
        out[D_T] = c * theta[o] * rate * v
        out[D_PARAMETER] = c * value * v
    else:
        out[VALUE] = -c * v
        out[D_V] = -c


def _given(acts: Acts, family: str, slot: Slot, said: str, law: Callable[..., None], *more: Parameter) -> Term:
    parameters = (Parameter("gain", "1", none=0.0), *more)
    nothing = (0.0,) * len(parameters)
    return Term(f"given-{acts}", family, slot, parameters, said, law, example=nothing, searched=False)


_LEVEL = Parameter("level", "N", none=0.0)
GIVEN: Final = {
    Acts.FORCE: _given(Acts.FORCE, "environment", Slot.SMOOTH, "A measured column pushes the slider.", force, _LEVEL),
    Acts.FRICTION: _given(
        Acts.FRICTION, "friction", Slot.FRICTION_MODULATION, "Friction depends on a measured column.", friction
    ),
    Acts.DAMPING: _given(Acts.DAMPING, "damping", Slot.SMOOTH, "Damping depends on a measured column.", damping),
}
"""The law of each way in which a covariate may act."""
