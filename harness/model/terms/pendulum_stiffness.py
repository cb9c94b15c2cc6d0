"""A pendulum where a linear spring was assumed: k (sin x - x)."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_STIFFNESS, D_X, STIFFNESS, VALUE
from harness.model.term import Slot, Term, always


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """k (sin x - x); no parameter of its own."""
    k = theta[STIFFNESS]
    out[VALUE] = k * (math.sin(x) - x)
    out[D_X] = k * (math.cos(x) - 1.0)
    out[D_STIFFNESS] = math.sin(x) - x


TERM = Term(
    "pendulum-stiffness",
    "stiffness",
    Slot.SMOOTH,
    (),
    "The restoring force is that of a pendulum, k sin x, and not of a linear spring.",
    law,
    needs=("angle", "returns"),
    place=always("large-displacement", "as x - sin x"),
    order=150,
)
