"""Samples of a free decay with their derivatives to omega_n, zeta, x_k, x_0, v_0 and t_0."""

from harness.core.arrays import FloatArray
from harness.exact import partials
from harness.exact.decay import Decay, check_outputs, check_times, read_only
from harness.exact.partials import PARAMETERS

__all__ = ["PARAMETERS", "fill_sensitivities"]


def fill_sensitivities(
    decay: Decay,
    t: FloatArray,
    x: FloatArray,
    v: FloatArray,
    a: FloatArray,
    dx: FloatArray,
    dv: FloatArray,
    da: FloatArray,
) -> None:
    """Write x, v, a, each (n,), and their derivatives dx, dv, da, each (n, 6), at times ``t`` (n,) in s.

    Columns as in PARAMETERS, SI units; t_0 is the time of the start (here 0): its column is minus the time derivative.
    From rest the derivative to v_0 is the one along the motion. x_s has none: it decides only whether the slider
    sticks. Times do not decrease. At a time of an event the derivative is the one after it.
    """
    n = t.size
    check_outputs((n,), t, x, v, a)
    check_outputs((n, len(PARAMETERS)), dx, dv, da)
    check_times(decay, t)
    partials.fill_sensitivities(*decay.arguments, read_only(t), x, v, a, dx, dv, da)
