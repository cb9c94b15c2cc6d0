"""Friction that repeats along the rail: 1 + depth cos(2 pi x/period + phase)."""

import math

from harness.core.arrays import FloatArray
from harness.model.law import D_PARAMETER, D_X, VALUE
from harness.model.term import Evidence, Parameter, Probe, Slot, Term


def law(x: float, v: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """Factor 1 + depth cos(2 pi x/period + phase)."""
    depth, period, phase = theta[o], theta[o + 1], theta[o + 2]
    w = 2.0 * math.pi / period
    angle = w * x + phase
    c, s = math.cos(angle), math.sin(angle)
    out[VALUE] = 1.0 + depth * c
    out[D_X] = -depth * w * s
    out[D_PARAMETER] = c
    out[D_PARAMETER + 1] = depth * s * w * x / period
    out[D_PARAMETER + 2] = -depth * s


def probes(e: Evidence) -> list[Probe]:
    """Periods that fit into the travel a few times; the response decides among them."""
    return [
        (0.0, e.x_scale * f, phase) for f in (0.25, 0.4, 0.6, 0.85, 1.2, 1.7, 2.4) for phase in (0.0, -0.5 * math.pi)
    ]


TERM = Term(
    "position-dependent-friction",
    "friction",
    Slot.FRICTION_MODULATION,
    (
        Parameter("depth", "1", -1.0, 1.0, none=0.0),
        Parameter("period", "m", 0.0, positive=True, repeats="travel"),
        Parameter("phase", "rad"),
    ),
    "Friction repeats every {period} along the rail, by a fraction {depth}.",
    law,
    probes,
    amplitude=0,
    phase=2,
    variant="periodic",
    needs=("returns",),
    example=(0.4, 0.3, 0.3),
    taken=0.08,
    in_python="1.0 + depth * cos(2.0 * pi * x / period + phase)",
    order=60,
)
