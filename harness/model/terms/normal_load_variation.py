"""A normal load that varies in time: 1 + depth cos(Omega t + phase)."""

import math

from harness.core.arrays import FloatArray
from harness.model.evidence import Evidence
from harness.model.law import D_PARAMETER, D_T, VALUE
from harness.model.term import Parameter, Probe, Slot, Term


def law(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + depth cos(Omega t + phase)."""
    depth, omega, phase = theta[o], theta[o + 1], theta[o + 2]
    angle = omega * t + phase
    c, s = math.cos(angle), math.sin(angle)
    out[VALUE] = 1.0 + depth * c
    out[D_T] = -depth * omega * s
    out[D_PARAMETER] = c
    out[D_PARAMETER + 1] = -depth * t * s
    out[D_PARAMETER + 2] = -depth * s


def probes(e: Evidence) -> list[Probe]:
    """Frequencies from one cycle per recording to several times the slider's own."""
    count = max(8, min(90, round(4.0 * e.omega * e.duration / math.pi)))
    top, step = 4.0 * e.omega, 4.0 * e.omega / count
    return [(0.0, top - i * step, phase) for i in range(count) for phase in (0.0, -0.5 * math.pi)]


TERM = Term(
    "normal-load-variation",
    "friction",
    Slot.FRICTION_MODULATION,
    (
        Parameter("depth", "1", -1.0, 1.0, none=0.0),
        Parameter("Omega", "rad/s", 0.0, positive=True),
        Parameter("phase", "rad"),
    ),
    "The normal load varies at {Omega}, and friction with it by a fraction {depth}.",
    law,
    probes,
    amplitude=0,
    phase=2,
)
