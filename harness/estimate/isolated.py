"""The isolated cases: cumulative logarithmic decrement (viscous alone), cumulative constant decrement (Coulomb
alone).
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity
from harness.estimate.result import Estimate, Reversal, quantity

NO_COULOMB = "the logarithmic decrement assumes that there is no dry friction"
NO_VISCOUS = "the constant decrement assumes that there is no viscous damping"


def _ends(size: FloatArray, variance: FloatArray, parity: int) -> tuple[int, int] | None:
    """First and last turning point of one side that stand above three standard errors, two half-cycles apart or
    more.
    """
    good = [i for i in range(parity, size.size, 2) if size[i] > 3.0 * math.sqrt(variance[i])]
    return (good[0], good[-1]) if len(good) >= 2 else None


def _pooled(figures: list[tuple[float, float]]) -> tuple[float, float]:
    """Mean of peaks' and valleys' figures weighted by variance, and its standard error."""
    value, variance = np.array(figures).T
    weight = 1.0 / np.maximum(variance, 1e-300)
    return float(weight @ value / weight.sum()), math.sqrt(1.0 / float(weight.sum()))


def _rows(times: FloatArray, turning: FloatArray) -> tuple[Reversal, ...]:
    return tuple(Reversal(float(t), float(x)) for t, x in zip(times, turning, strict=True))


def log_decrement(
    times: FloatArray, turning: FloatArray, variance: FloatArray, omega_d: tuple[float, float], unit: str = "m"
) -> Estimate:
    """zeta from the ratio of the first to the last peak, and of the first to the last valley.

    times (n,) s, turning (n,) m, variance (n,) m^2 of successive turning points; omega_d with its standard error,
    rad/s.
    """
    size = np.abs(turning)
    figures = []
    for parity in (0, 1):
        ends = _ends(size, variance, parity)
        if ends is not None:
            first, last = ends
            count = last - first
            spread = variance[first] / size[first] ** 2 + variance[last] / size[last] ** 2
            figures.append((math.log(size[first] / size[last]) / (count * math.pi), spread / (count * math.pi) ** 2))
    if not figures:
        return Estimate.refused("no two peaks or valleys stand above the noise", unit)
    beta, error = _pooled(figures)
    root = math.sqrt(1.0 + beta * beta)
    return Estimate(
        quantity(omega_d[0] * root, math.hypot(omega_d[1] * root, omega_d[0] * beta / root * error), "rad/s"),
        quantity(beta / root, error / root**3, "1"),
        Quantity.refused(unit, NO_COULOMB),
        turning.size - 1,
        _rows(times, turning),
        notes=(NO_COULOMB,),
    )


def constant_decrement(
    times: FloatArray, turning: FloatArray, variance: FloatArray, omega_d: tuple[float, float], unit: str = "m"
) -> Estimate:
    """x_k from the difference of the first and the last peak, and of the first and the last valley.

    Arguments as for log_decrement. With no damping the half-cycle time gives omega_n itself.
    """
    size = np.abs(turning)
    figures = []
    for parity in (0, 1):
        ends = _ends(size, variance, parity)
        if ends is not None:
            first, last = ends
            count = 2.0 * (last - first)  # 2 x_k a half-cycle
            figures.append(((size[first] - size[last]) / count, (variance[first] + variance[last]) / count**2))
    if not figures:
        return Estimate.refused("no two peaks or valleys stand above the noise", unit)
    x_k, error = _pooled(figures)
    return Estimate(
        quantity(*omega_d, "rad/s"),
        Quantity.refused("1", NO_VISCOUS),
        quantity(x_k, error, unit),
        turning.size - 1,
        _rows(times, turning),
        notes=(NO_VISCOUS,),
    )
