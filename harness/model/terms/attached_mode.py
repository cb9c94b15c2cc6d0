"""A second mass on a spring riding on the slider."""

import math

import numpy as np

from harness.core.arrays import FloatArray, read_only
from harness.core.jit import compiled
from harness.model.law import D_INTERNAL, D_MASS, D_PARAMETER, D_V, MASS, VALUE
from harness.model.term import Evidence, History, Parameter, Probe, Slot, States, Term

_CRITICAL = 1e-12
"""1 - zeta^2 at least: the critical case is the limit of this one."""
_STEP = 1e-6
"""Of differences, relative for a frequency."""


def law(x: float, v: float, w0: float, w1: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """State r = x_2 - x and v_2; row 0: force -m_2 (omega_2^2 r + 2 zeta_2 omega_2 (v_2 - v)) on the left.

    Rows 1 and 2: r' = v_2 - v, v_2' = -omega_2^2 r - 2 zeta_2 omega_2 (v_2 - v).
    """
    omega, ratio, zeta, m = theta[o], theta[o + 1], theta[o + 2], theta[MASS]
    slip = w1 - v
    pull = omega * omega * w0 + 2.0 * zeta * omega * slip
    d_omega = 2.0 * omega * w0 + 2.0 * zeta * slip
    d_zeta = 2.0 * omega * slip
    out[0, VALUE] = -ratio * m * pull
    out[0, D_V] = ratio * m * 2.0 * zeta * omega
    out[0, D_MASS] = -ratio * pull
    out[0, D_PARAMETER] = -ratio * m * d_omega
    out[0, D_PARAMETER + 1] = -m * pull
    out[0, D_PARAMETER + 2] = -ratio * m * d_zeta
    out[0, D_INTERNAL] = -ratio * m * omega * omega
    out[0, D_INTERNAL + 1] = -ratio * m * 2.0 * zeta * omega
    out[1, VALUE] = slip
    out[1, D_V] = -1.0
    out[1, D_INTERNAL + 1] = 1.0
    out[2, VALUE] = -pull
    out[2, D_V] = 2.0 * zeta * omega
    out[2, D_PARAMETER] = -d_omega
    out[2, D_PARAMETER + 2] = -d_zeta
    out[2, D_INTERNAL] = -omega * omega
    out[2, D_INTERNAL + 1] = -2.0 * zeta * omega


def probes(e: Evidence) -> list[Probe]:
    """Frequencies from below the slider's own to several times it; the response decides among them."""
    ratios = (0.6, 0.8, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.5, 8.5)
    return [(ratio * e.omega, 0.0, zeta) for ratio in ratios for zeta in (0.01, 0.05)]


@compiled
def _ride(t: FloatArray, v: FloatArray, at: FloatArray, omega: float, zeta: float, out: FloatArray) -> None:
    """r and r' at the times ``at`` (m,), at rest on the slider at first; out (m, 2).

    r'' = -omega^2 r - 2 zeta omega r' - x'', exact for an acceleration that is constant between samples.
    """
    r, slip, i = 0.0, 0.0, 0
    damped = omega * math.sqrt(max(1.0 - zeta * zeta, _CRITICAL))
    for j in range(at.size):
        while i + 1 < t.size and t[i + 1] <= at[j]:
            h = t[i + 1] - t[i]
            rest = -(v[i + 1] - v[i]) / h / (omega * omega)
            fade = math.exp(-zeta * omega * h)
            turn, swing = math.cos(damped * h), math.sin(damped * h) / damped
            d = r - rest
            r = rest + fade * ((turn + zeta * omega * swing) * d + swing * slip)
            slip = fade * ((turn - zeta * omega * swing) * slip - omega * omega * swing * d)
            i += 1
        out[j, 0], out[j, 1] = r, slip


def _ridden(motion: History, omega: float, zeta: float) -> FloatArray:
    found = np.zeros((motion.at.size, 2))
    _ride(read_only(motion.t), read_only(motion.v), read_only(motion.at), omega, zeta, found)
    return found


def ridden(values: Probe, motion: History) -> States:
    """As the recorded motion has shaken it, at rest on the slider at first; partials by differences."""
    omega, _, zeta = values
    step = _STEP * omega
    by_omega = (_ridden(motion, omega + step, zeta) - _ridden(motion, omega - step, zeta)) / (2.0 * step)
    by_zeta = (_ridden(motion, omega, zeta + _STEP) - _ridden(motion, omega, zeta)) / _STEP
    return States(_ridden(motion, omega, zeta), {0: by_omega, 2: by_zeta})


TERM = Term(
    "attached-mode",
    "environment",
    Slot.INTERNAL,
    (
        Parameter("omega_2", "rad/s", 0.0, positive=True),
        Parameter("mass_ratio", "1", 0.0, 1.0, none=0.0),
        Parameter("zeta_2", "1", 0.0, 1.0),
    ),
    "A second mass of {mass_ratio} of the slider's rides on a spring at {omega_2}.",
    law,
    probes,
    amplitude=1,
    internal=2,
    speeds=(1,),
    needs=("returns",),
    example=(21.0, 0.1, 0.03),
    implied=ridden,
    order=230,
)
