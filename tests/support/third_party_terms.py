"""Two terms as another package would have them: a magnet that holds the slider, and friction that is a smooth curve."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_LEVEL, D_PARAMETER, D_V, D_X, VALUE
from harness.model.term import Evidence, Parameter, Place, Probe, Seen, Slot, Term


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """h x exp(-(x/w)^2)."""
    h, w = theta[o], theta[o + 1]
    r2 = (x / w) ** 2
    near = math.exp(-r2)
    out[VALUE] = h * x * near
    out[D_X] = h * near * (1.0 - 2.0 * r2)
    out[D_PARAMETER] = x * near
    out[D_PARAMETER + 1] = 2.0 * h * x * near * r2 / w


def probes(e: Evidence) -> list[Probe]:
    """Linear in h; widths at fractions of the largest displacement."""
    return [(0.0, f * e.x_scale) for f in (0.1, 0.2, 0.4)]


def place(values: Probe, seen: Seen) -> Place:
    """About the magnet."""
    return Place("throughout", f"|x| < {values[1]:.3g} m", seen.where(abs(seen.x) < values[1]))


MAGNET = Term(
    "magnet",
    "stiffness",
    Slot.SMOOTH,
    (Parameter("h", "N/m", none=0.0), Parameter("w", "m", 0.0, positive=True)),
    "A magnet holds the slider within {w} of the middle: h = {h}.",
    law,
    probes,
    amplitude=0,
    example=(60.0, 0.2),
    place=place,
)


def smooth_law(v: float, a: float, level: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """f_k tanh(v/v_r)."""
    share = math.tanh(v / theta[o])
    out[VALUE] = level * share
    out[D_V] = level * (1.0 - share * share) / theta[o]
    out[D_LEVEL] = share
    out[D_PARAMETER] = -level * (1.0 - share * share) * v / theta[o] ** 2


TANH = Term(
    "tanh-friction",
    "friction",
    Slot.FRICTION_LAW,
    (Parameter("v_r", "m/s", 0.0, positive=True),),
    "Friction is a smooth curve over {v_r}.",
    smooth_law,
    lambda e: [(0.1 * e.v_scale,)],
    example=(0.3,),
)
