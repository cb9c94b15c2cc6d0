"""A Maxwell branch in parallel with the spring: k_m y, y' = v - y/tau."""

import math

import numpy as np

from harness.core.arrays import FloatArray, read_only
from harness.core.jit import compiled
from harness.model.law import D_INTERNAL, D_PARAMETER, D_V, VALUE
from harness.model.term import Evidence, History, Parameter, Probe, Slot, States, Term


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


@compiled
def _stretch(t: FloatArray, v: FloatArray, at: FloatArray, tau: float, out: FloatArray) -> None:
    """y' = v - y/tau and its partial by tau at the times ``at`` (m,), relaxed at first; out (m, 2)."""
    y, slope, i = 0.0, 0.0, 0
    for j in range(at.size):
        while i + 1 < t.size and t[i + 1] <= at[j]:
            h = t[i + 1] - t[i]
            fade = math.exp(-h / tau)
            mean = 0.5 * (v[i] + v[i + 1])
            # exact for a speed that is constant over the interval
            slope = fade * (slope + y * h / (tau * tau)) + mean * ((1.0 - fade) - fade * h / tau)
            y = fade * y + mean * tau * (1.0 - fade)
            i += 1
        out[j, 0], out[j, 1] = y, slope


def stretched(values: Probe, motion: History) -> States:
    """As the recorded speed has left it, relaxed at first."""
    found = np.zeros((motion.at.size, 2))
    _stretch(read_only(motion.t), read_only(motion.v), read_only(motion.at), values[1], found)
    return States(found[:, :1], {1: found[:, 1:]})


TERM = Term(
    "viscoelastic",
    "damping",
    Slot.INTERNAL,
    (Parameter("k_m", "N/m", 0.0, none=0.0), Parameter("tau", "s", 0.0, positive=True, relaxes=True)),
    "A viscoelastic (Maxwell) branch relaxes within {tau}: k_m = {k_m}.",
    law,
    probes,
    amplitude=0,
    internal=1,
    needs=("returns",),
    example=(30.0, 0.1),
    implied=stretched,
    order=120,
)
