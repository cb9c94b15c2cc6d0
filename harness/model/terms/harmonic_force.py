"""A harmonic force in time: hum, motion of the base."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_T, VALUE
from harness.model.term import Evidence, Parameter, Probe, Slot, Term


def law(x: float, v: float, t: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """-A cos(Omega t + phase): it stands on the right side."""
    a, omega, phase = theta[o], theta[o + 1], theta[o + 2]
    angle = omega * t + phase
    c, s = math.cos(angle), math.sin(angle)
    out[VALUE] = -a * c
    out[D_T] = a * omega * s
    out[D_PARAMETER] = -c
    out[D_PARAMETER + 1] = a * t * s
    out[D_PARAMETER + 2] = a * s


def probes(e: Evidence) -> list[Probe]:
    """Frequencies at which the residual stands out."""
    return [(0.0, omega, phase) for omega in e.frequencies for phase in (0.0, -0.5 * math.pi)]


TERM = Term(
    "harmonic-force",
    "environment",
    Slot.SMOOTH,
    (
        Parameter("A", "N", none=0.0),
        Parameter("Omega", "rad/s", 0.0, positive=True, repeats="time"),
        Parameter("phase", "rad"),
    ),
    "A harmonic force of amplitude {A} acts at {Omega}.",
    law,
    probes,
    amplitude=0,
    phase=2,
    example=(6.0, 13.0, 0.4),
    push=0,
    several=True,
    needs=("one-clock",),
    order=210,
)
