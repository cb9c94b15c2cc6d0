"""A force that depends on position and speed at once, as a table over both: what no sum of a law of each says."""

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_V, D_X, VALUE
from harness.model.spline import SIDE, surface
from harness.model.term import Known, Parameter, Slot, Term, always

_LOW, _HIGH, _FAST, _REACH = range(SIDE * SIDE, SIDE * SIDE + 4)


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """f(x, v), a natural cubic spline along both through f_1_1 to f_6_6, over low to high and -fast to fast.

    f_i_j is its value at step i of x, which are even, and step j of v = fast s/(2 - |s|), s at even steps from -1 to 1.
    Beyond, it keeps the value at its edge. It is known where ((x - mid)/half)^2 + (v/fast)^2 is at most reach^2.
    """
    low, width, fast = theta[o + _LOW], theta[o + _HIGH] - theta[o + _LOW], theta[o + _FAST]
    if width <= 0.0 or fast <= 0.0:
        return
    step, half = (SIDE - 1) / width, 0.5 * (SIDE - 1)
    # knots lie closer at low speeds, where friction changes most
    r = v / fast
    size = 1.0 + abs(r)
    value, by_p, by_q = surface((x - low) * step, half * (1.0 + 2.0 * r / size), theta, o, out)
    slope, rate = by_p * step, by_q * 2.0 * half / (size * size)
    out[VALUE] = value
    out[D_X] = slope
    out[D_V] = rate / fast
    out[D_PARAMETER + _LOW] = slope * ((x - low) / width - 1.0)
    out[D_PARAMETER + _HIGH] = -slope * (x - low) / width
    out[D_PARAMETER + _FAST] = -rate * r / fast


def _example() -> tuple[float, ...]:
    """Damping that grows towards one side, and a little of everything else."""
    values = [(0.4 * (i - 2.0)) * (j - 2.5) + 0.1 * ((i * j) % 3) for i in range(SIDE) for j in range(SIDE)]
    return (*values, -1.2, 1.3, 12.0, 1.4)


TERM = Term(
    "tabulated-force",
    "friction",
    Slot.SMOOTH,
    (
        *(Parameter(f"f_{i + 1}_{j + 1}", "N") for i in range(SIDE) for j in range(SIDE)),
        *(Parameter("low", "m"), Parameter("high", "m"), Parameter("fast", "m/s", 0.0, positive=True)),
        Parameter("reach", "1", 0.0),
    ),
    "A force that depends on position and speed at once, as a table from {low} to {high} and up to {fast}.",
    law,
    example=_example(),
    corner=True,
    push=SIDE * 2 + 2,
    searched=False,
    known=Known("x, v", _LOW, _HIGH, _FAST, _REACH),
    place=always("throughout", "by position and speed"),
    order=920,
)
