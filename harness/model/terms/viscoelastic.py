"""A Maxwell branch in parallel with the spring: k_m y, y' = v - y/tau."""

from harness.core.arrays import FloatArray
from harness.model.evidence import Evidence
from harness.model.law import D_INTERNAL, D_PARAMETER, D_V, VALUE
from harness.model.term import Parameter, Probe, Slot, Term


def law(x: float, v: float, w0: float, w1: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Row 0: force k_m y on the left. Row 1: y' = v - y/tau."""
    k_m, tau = theta[o], theta[o + 1]
    out[0, VALUE] = k_m * w0
    out[0, D_PARAMETER] = w0
    out[0, D_INTERNAL] = k_m
    out[1, VALUE] = v - w0 / tau
    out[1, D_V] = 1.0
    out[1, D_PARAMETER + 1] = w0 / (tau * tau)
    out[1, D_INTERNAL] = -1.0 / tau


def probes(e: Evidence) -> list[Probe]:
    """Linear in k_m; relaxation times about the period (slower is a spring, faster a damper)."""
    return [(0.0, f / e.omega) for f in (0.1, 0.3, 1.0, 3.0, 10.0)]


TERM = Term(
    "viscoelastic",
    "damping",
    Slot.INTERNAL,
    (Parameter("k_m", "N/m", 0.0, none=0.0), Parameter("tau", "s", 0.0, positive=True)),
    "A viscoelastic (Maxwell) branch relaxes within {tau}: k_m = {k_m}.",
    law,
    probes,
    amplitude=0,
    internal=1,
)
