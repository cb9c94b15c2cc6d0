"""The isolated cases: cumulative logarithmic decrement (viscous alone), constant decrement (Coulomb alone)."""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity
from harness.estimate.result import Estimate, Reversal, damped, quantity

ASSUMED = {
    "log-decrement": "the logarithmic decrement assumes that there is no dry friction",
    "constant-decrement": "the constant decrement assumes that there is no viscous damping",
}
"""Method -> what it assumes of the other loss."""


def isolated(
    method: str,
    times: FloatArray,
    turning: FloatArray,
    variance: FloatArray,
    omega_d: tuple[float, float],
    unit: str = "m",
) -> Estimate:
    """zeta, or x_k in ``unit``, from the first and the last peak, and from the first and the last valley.

    method : of ``ASSUMED``. times (n,) s, turning (n,) m, variance (n,) m^2 of successive turning points; omega_d with
    its standard error, rad/s. The logarithmic decrement takes their ratio, the constant one their difference, 2 x_k a
    half-cycle; with no damping the half-cycle time gives omega_n itself.
    """
    viscous, size, found = method == "log-decrement", np.abs(turning), []
    for parity in (0, 1):
        # turning points of one side that stand above three standard errors
        good = [i for i in range(parity, size.size, 2) if size[i] > 3.0 * math.sqrt(variance[i])]
        if len(good) < 2:
            continue
        first, last = good[0], good[-1]
        per = 1.0 / ((last - first) * (math.pi if viscous else 2.0))
        if viscous:
            lost = math.log(size[first] / size[last])
            spread = variance[first] / size[first] ** 2 + variance[last] / size[last] ** 2
        else:
            lost, spread = size[first] - size[last], variance[first] + variance[last]
        found.append((lost * per, spread * per**2))
    if not found:
        return Estimate.refused("no two peaks or valleys stand above the noise", unit)
    figures, spreads = np.array(found).T
    weight = 1.0 / np.maximum(spreads, 1e-300)
    loss = float(weight @ figures / weight.sum()), math.sqrt(1.0 / float(weight.sum()))
    why = ASSUMED[method]
    if viscous:
        omega_n, zeta = damped(omega_d, loss)
        x_k = Quantity.refused(unit, why)
    else:
        omega_n, zeta, x_k = quantity(*omega_d, "rad/s"), Quantity.refused("1", why), quantity(*loss, unit)
    rows = tuple(Reversal(float(t), float(x)) for t, x in zip(times, turning, strict=True))
    return Estimate(omega_n, zeta, x_k, turning.size - 1, rows, notes=(why,))
