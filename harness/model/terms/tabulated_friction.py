"""Friction as a table: by speed, in both directions alike or in one of them, or by position."""

from collections.abc import Callable
from typing import Literal

from harness.core.arrays import FloatArray
from harness.core.jit import lean
from harness.model.law import D_PARAMETER, D_V, D_X, VALUE
from harness.model.spline import KNOTS, curve
from harness.model.term import Known, Parameter, Placed, Slot, Term, always

_HIGH = KNOTS - 1
"""Place of the fastest speed known: the value at rest is 0 and no parameter."""
_FROM, _TO = KNOTS, KNOTS + 1


@lean
def by_speed(v: float, side: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """The table at v = side |v|."""
    high, speed = theta[o + _HIGH], side * v
    if high <= 0.0:
        return
    # knots lie closer at low speeds, where friction changes most and a decay lasts longest
    r = speed / high
    u = 2.0 * (KNOTS - 1) * r / (1.0 + r)
    rate = 2.0 * (KNOTS - 1) / (1.0 + r) ** 2
    value, slope = curve(u, 1, theta, o, out)
    for j in range(KNOTS - 1):
        out[D_PARAMETER + j] *= side
    out[VALUE] = side * value
    out[D_V] = slope * rate / high
    out[D_PARAMETER + _HIGH] = -side * slope * rate * r / high


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """f(|v|) sgn v, a natural cubic spline through 0 and f_1 to f_11, at |v|/high = s/(22 - s), s from 0 to 11."""
    by_speed(v, -1.0 if v < 0.0 else 1.0, theta, o, out)


def law_forward(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """f(v) for v > 0, else 0: a spline as in both directions."""
    if v > 0.0:
        by_speed(v, 1.0, theta, o, out)


def law_backward(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """-f(-v) for v < 0, else 0: a spline as in both directions."""
    if v < 0.0:
        by_speed(v, -1.0, theta, o, out)


def law_position(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + g(x), a natural cubic spline through g_1 to g_12 at even steps from low to high; beyond, the last."""
    low, width = theta[o + _FROM], theta[o + _TO] - theta[o + _FROM]
    out[VALUE] = 1.0
    if width <= 0.0:
        return
    step = (KNOTS - 1) / width
    value, slope = curve((x - low) * step, 0, theta, o, out)
    out[VALUE] = 1.0 + value
    out[D_X] = slope * step
    out[D_PARAMETER + _FROM] = slope * step * ((x - low) / width - 1.0)
    out[D_PARAMETER + _TO] = -slope * step * (x - low) / width


def _by(
    variant: str, of: Literal["|v|", "v", "-v"], where: str, law: Callable[..., None], place: Placed, order: int
) -> Term:
    """The table by speed, of both directions or one of them."""
    return Term(
        "tabulated-friction",
        "friction",
        Slot.SMOOTH,
        (*(Parameter(f"f_{i + 1}", "N") for i in range(KNOTS - 1)), Parameter("high", "m/s", 0.0, positive=True)),
        f"A resistance{where} that depends on speed, as a table up to {{high}}.",
        law,
        variant=variant,
        example=(1.0, 3.0, 4.0, 3.5, 2.0, 1.0, 0.0, 1.0, 4.0, 6.0, 9.0, 8.0),
        corner=True,
        searched=False,
        known=Known(of, None, _HIGH),
        place=place,
        order=order,
    )


TERM = _by("", "|v|", "", law, always("throughout", "by speed"), 910)
TERM_FORWARD = _by("forward", "v", " forwards", law_forward, always("one-side", "forwards, by speed"), 911)
TERM_BACKWARD = _by("backward", "-v", " backwards", law_backward, always("one-side", "backwards, by speed"), 912)
TERM_POSITION = Term(
    "tabulated-friction",
    "friction",
    Slot.FRICTION_MODULATION,
    (*(Parameter(f"g_{i + 1}", "1") for i in range(KNOTS)), Parameter("low", "m"), Parameter("high", "m")),
    "Friction that changes along the way, as a table from {low} to {high}: f_k (1 + g(x)).",
    law_position,
    variant="position",
    example=(0.9, 0.3, -0.2, -0.3, 0.0, 0.4, 0.6, 0.3, 0.1, 0.0, 0.2, 0.6, -1.2, 1.3),
    searched=False,
    known=Known("x", _FROM, _TO),
    place=always("throughout", "by position"),
    order=913,
)
