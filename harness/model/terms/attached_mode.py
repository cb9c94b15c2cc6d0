"""A second mass on a spring riding on the slider."""

from harness.core.arrays import FloatArray
from harness.model.evidence import Evidence
from harness.model.law import D_INTERNAL, D_MASS, D_PARAMETER, D_V, MASS, VALUE
from harness.model.term import Parameter, Probe, Slot, Term


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
    example=(21.0, 0.1, 0.03),
    hidden=True,
    order=230,
)
