"""A normal load that varies in time: 1 + depth cos(Omega t + phase)."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_T, VALUE
from harness.model.term import Evidence, Parameter, Probe, Slot, Term


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
    """Frequencies worth a look: load and friction multiply, so sidebands of the slider's own are among them."""
    return [(0.0, float(omega), phase) for omega in (*e.of_friction, *e.frequencies) for phase in (0.0, -0.5 * math.pi)]


TERM = Term(
    "normal-load-variation",
    "friction",
    Slot.FRICTION_MODULATION,
    (
        Parameter("depth", "1", -1.0, 1.0, none=0.0),
        Parameter("Omega", "rad/s", 0.0, positive=True, repeats="time"),
        Parameter("phase", "rad"),
    ),
    "The normal load varies at {Omega}, and friction with it by a fraction {depth}.",
    law,
    probes,
    amplitude=0,
    phase=2,
    example=(0.3, 7.0, 0.2),
    needs=("one-clock",),
    in_python="1.0 + depth * cos(Omega * t + phase)",
    order=80,
)
