"""Friction that falls with speed: f_k + (f_s - f_k) exp(-(v/v_s)^2), break-away at f_s."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_LEVEL, D_PARAMETER, D_V, KINETIC, VALUE
from harness.model.term import Evidence, Extent, Parameter, Place, Probe, Seen, Slot, Term


def law(v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """f_k + (f_s - f_k) exp(-(v/v_s)^2); break-away at f_s."""
    f_s, v_s = theta[o], theta[o + 1]
    ratio, excess = v / v_s, theta[o] - theta[KINETIC]
    # exactly f_s at v = 0, where it is held against the break-away level
    fallen = math.expm1(-ratio * ratio)
    left = 1.0 + fallen
    out[VALUE] = f_s + excess * fallen
    out[D_V] = -2.0 * excess * left * ratio / v_s
    out[D_LEVEL] = -fallen
    out[D_PARAMETER] = left
    out[D_PARAMETER + 1] = 2.0 * excess * left * ratio * ratio / v_s


def probes(e: Evidence) -> list[Probe]:
    """Linear in f_s - f_k; Stribeck speeds at fractions of the largest speed."""
    return [(e.f_k, f * e.v_scale) for f in (0.02, 0.05, 0.1, 0.2, 0.4, 0.7)]


def place(values: Probe, seen: Seen) -> Place:
    """Where more than a fiftieth of what it falls by is left."""
    return Place("low-speed", f"|v| below about {2.0 * values[1]:.3g} m/s", seen.whole)


def falls(values: Probe, extent: Extent) -> bool:
    """Friction that rises with speed is another law's."""
    return values[0] >= extent.f_k


TERM = Term(
    "stribeck",
    "friction",
    Slot.FRICTION_LEVEL,
    (Parameter("f_s", "N", 0.0), Parameter("v_s", "m/s", 0.0, positive=True)),
    "Friction changes with speed (Stribeck): from f_s = {f_s} at rest to f_k, over v_s = {v_s}.",
    law,
    probes,
    amplitude=0,
    example=(5.0, 0.8),
    place=place,
    as_named=falls,
    in_python="f_s + (f_k - f_s) * (1.0 - exp(-((v / v_s) ** 2)))",
    order=10,
)
