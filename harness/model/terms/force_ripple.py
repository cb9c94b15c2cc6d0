"""A force periodic in position: cogging, a ball screw."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.term import Evidence, Extent, Parameter, Probe, Slot, Term


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """amplitude cos(2 pi x/period + phase)."""
    amplitude, period, phase = theta[o], theta[o + 1], theta[o + 2]
    w = 2.0 * math.pi / period
    angle = w * x + phase
    c, s = math.cos(angle), math.sin(angle)
    out[VALUE] = amplitude * c
    out[D_X] = -amplitude * w * s
    out[D_PARAMETER] = c
    out[D_PARAMETER + 1] = amplitude * s * w * x / period
    out[D_PARAMETER + 2] = -amplitude * s


def probes(e: Evidence) -> list[Probe]:
    """Periods at which a force stands out, else all that fit into the travel, evenly spaced in their number."""
    travel = e.high - e.low
    if travel <= 0.0:
        return []
    counts = [0.5 * i for i in range(2, 61)] if not e.driven else [float(i) for i in range(2, 200)]
    periods = e.periods if e.periods else [travel / count for count in counts]
    return [(0.0, period, phase) for period in periods for phase in (0.0, -0.5 * math.pi)]


_LEAST_PERIODS = 1.5
"""Over the travel: two wave numbers nearer than one over the travel are one (Rayleigh), and half of that again."""


def repeats(values: Probe, extent: Extent) -> bool:
    """What does not repeat over the way is a spring's shape."""
    return extent.reach == 0.0 or 2.0 * extent.reach >= _LEAST_PERIODS * values[1]


TERM = Term(
    "force-ripple",
    "environment",
    Slot.SMOOTH,
    (
        Parameter("amplitude", "N", none=0.0),
        Parameter("period", "m", 0.0, positive=True, repeats="travel"),
        Parameter("phase", "rad"),
    ),
    "A force of {amplitude} repeats every {period} of travel.",
    law,
    probes,
    amplitude=0,
    phase=2,
    example=(4.0, 0.35, 0.4),
    push=0,
    as_named=repeats,
    taken=0.1,
    order=200,
)
