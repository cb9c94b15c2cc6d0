"""Damping that grows with a power of the speed below one."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_V, V_SCALE, VALUE
from harness.model.term import Evidence, Parameter, Probe, Slot, Term

SMOOTHING = 1e-4
"""Fraction of the speed scale below which the law is rounded: its slope at rest is infinite."""


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """c_p |v|^p sgn v, as c_p v (v^2 + e^2)^((p-1)/2) with e far below any speed that matters."""
    c_p, p = theta[o], theta[o + 1]
    e = SMOOTHING * theta[V_SCALE]
    s2 = v * v + e * e
    power = s2 ** (0.5 * (p - 1.0))
    out[VALUE] = c_p * v * power
    out[D_V] = c_p * power * (1.0 + (p - 1.0) * v * v / s2)
    out[D_PARAMETER] = v * power
    out[D_PARAMETER + 1] = 0.5 * c_p * v * power * math.log(s2)


def probes(e: Evidence) -> list[Probe]:
    """Linear in c_p; three exponents inside the range."""
    return [(0.0, 0.3), (0.0, 0.5), (0.0, 0.7)]


TERM = Term(
    "power-law-damping",
    "damping",
    Slot.SMOOTH,
    (Parameter("c_p", "N (s/m)^p", 0.0, none=0.0), Parameter("exponent", "1", 0.2, 0.8)),
    "Damping grows with the power {exponent} of the speed: c_p = {c_p}.",
    law,
    probes,
    amplitude=0,
    example=(0.8, 0.5),
    corner=True,
    in_python="c_p * sign(v) * abs(v) ** exponent",
    order=110,
)
