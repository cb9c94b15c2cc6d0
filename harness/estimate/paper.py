"""The paper's own practice, by name: five-point moving average, first period dropped, single estimates averaged.

Liang, sections 3 and 4.3. Values before and after a jump are the nearest smoothed samples whose five points all lie on
one side of it. Kept as published, with its bias: it is here to be compared with, not to be relied on.

And the isolated cases: cumulative logarithmic decrement (viscous alone), constant decrement (Coulomb alone).
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity
from harness.estimate.result import Estimate, Reversal, damped, quantity

POINTS = 5


def beside(t: FloatArray, a: FloatArray, times: FloatArray, points: int) -> tuple[FloatArray, FloatArray]:
    """Averages of ``points`` samples of a (n,) wholly before and after each of ``times`` (m,); nan at the ends."""
    smooth = np.convolve(a, np.full(points, 1.0 / points), mode="valid")
    tolerance = 1e-9 * float(t[-1] - t[0])
    last = np.searchsorted(t, times - tolerance) - points
    first = np.searchsorted(t, times + tolerance, side="right")
    padded = np.concatenate([smooth, [np.nan]])
    pick = [np.where((i >= 0) & (i < smooth.size), i, smooth.size) for i in (last, first)]
    return np.asarray(padded[pick[0]], dtype=np.float64), np.asarray(padded[pick[1]], dtype=np.float64)


def _zetas(ratios: FloatArray) -> FloatArray:
    """Zeta from values of -exp(-beta pi); those that are none are left out."""
    good = -ratios[np.isfinite(ratios) & (ratios < 0.0)]
    beta = -np.log(good) / math.pi
    return np.asarray(beta / np.sqrt(1.0 + beta**2), dtype=np.float64)


def _ratios(change: FloatArray, before: FloatArray, scale: float) -> FloatArray:
    """change / before (n,), nan where before is nothing but rounding of figures of size ``scale``."""
    real = np.abs(before) > 1e-9 * scale
    return np.where(real, change / np.where(real, before, 1.0), np.nan)


def by_sums(values: FloatArray) -> FloatArray:
    """zeta from three successive figures (n,), the form of eqs. 7 and 13."""
    sums = values[1:] + values[:-1]
    return _zetas(_ratios(sums[1:], sums[:-1], float(np.max(np.abs(values), initial=0.0))))


def by_differences(values: FloatArray) -> FloatArray:
    """zeta from four successive figures (n,), the form of eqs. 8 and 12."""
    differences = values[2:] - values[:-2]
    return _zetas(_ratios(differences[1:], differences[:-1], float(np.max(np.abs(values), initial=0.0))))


def mean_of(values: FloatArray, unit: str, what: str) -> Quantity:
    """Mean of single estimates (n,) with the standard error of their scatter; refused without any of ``what``."""
    if values.size == 0:
        return Quantity.refused(unit, f"{what} gave no figure")
    mean = float(np.mean(values))
    if values.size == 1:
        return Quantity(mean, None, unit, f"{what} gave one figure, which has no scatter")
    return quantity(mean, float(np.std(values, ddof=1)) / math.sqrt(values.size), unit)


def acceleration_paper(
    t: FloatArray,
    a: FloatArray,
    edges: FloatArray,
    omega_d: tuple[float, float],
    points: int = POINTS,
    drop_first: bool = True,
    unit: str = "m",
) -> Estimate:
    """omega_n, zeta and x_k (in ``unit``) from a (n,), m/s^2, at t (n,), s, by eqs. 11, 12 and 13, averaged.

    edges (K+1,) : release (or start), reversals, stop, s. omega_d : from the half-cycle time, rad/s, with its error.
    points : of the moving average (1: no smoothing, as in the paper's simulation). drop_first : leave out the first
    period.
    """
    inner = edges[1:-1]
    if drop_first:
        inner = inner[inner > edges[0] + 1.5 * math.pi / omega_d[0]]
    before, after = beside(t, a, inner, points)
    whole = np.isfinite(before) & np.isfinite(after)
    inner, before, after = inner[whole], before[whole], after[whole]
    if inner.size < 3:
        return Estimate.refused(
            f"{inner.size} reversals are left after the first period, eqs. 12 and 13 need three", unit
        )
    twelve, thirteen = by_differences(before), by_sums(after)
    zeta = mean_of(np.concatenate([twelve, thirteen]), "1", "eqs. 12 and 13")
    if zeta.value is None or abs(zeta.value) >= 1.0:
        return Estimate.refused("eqs. 12 and 13 gave no damping ratio", unit)
    root = math.sqrt(1.0 - zeta.value**2)
    omega_n = omega_d[0] / root
    error = math.hypot(omega_d[1] / root, omega_n * zeta.value / root**2 * (zeta.stderr or 0.0))
    single = np.abs(before - after) / (2.0 * omega_n**2)
    scatter = float(np.std(single, ddof=1))
    return Estimate(
        quantity(omega_n, error, "rad/s"),
        zeta,
        mean_of(single, unit, "eq. 11"),
        inner.size,
        tuple(
            Reversal(float(time), None, float(b), float(p), float(x), scatter)
            for time, b, p, x in zip(inner, before, after, single, strict=True)
        ),
        notes=("as published: standard errors are the scatter of the averaged figures and know nothing of their bias",),
    )


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
