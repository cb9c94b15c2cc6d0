"""The paper's own practice, by name: five-point moving average, first period dropped, single estimates averaged.

Liang, sections 3 and 4.3. Values before and after a jump are the nearest smoothed samples whose five points all lie on
one side of it. Kept as published, with its bias: it is here to be compared with, not to be relied on.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity
from harness.estimate.result import Estimate, Reversal, quantity

POINTS = 5


def moving_average(a: FloatArray, points: int = POINTS) -> FloatArray:
    """Centred moving average of an odd number of points, (n - points + 1,): only where all points exist."""
    return np.convolve(a, np.full(points, 1.0 / points), mode="valid")


def beside(t: FloatArray, a: FloatArray, times: FloatArray, points: int) -> tuple[FloatArray, FloatArray]:
    """Averages of ``points`` samples of a (n,) wholly before and wholly after each of ``times`` (m,); nan at the
    ends.
    """
    smooth = moving_average(a, points)
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


def _by_sums(values: FloatArray) -> FloatArray:
    """zeta from three successive figures (n,), the form of eqs. 7 and 13."""
    sums = values[1:] + values[:-1]
    return _zetas(_ratios(sums[1:], sums[:-1], float(np.max(np.abs(values), initial=0.0))))


def _by_differences(values: FloatArray) -> FloatArray:
    """zeta from four successive figures (n,), the form of eqs. 8 and 12."""
    differences = values[2:] - values[:-2]
    return _zetas(_ratios(differences[1:], differences[:-1], float(np.max(np.abs(values), initial=0.0))))


def by_eq_12(before: FloatArray) -> FloatArray:
    """zeta from four successive accelerations before jumps (n,), signed, m/s^2."""
    return _by_differences(before)


def by_eq_13(after: FloatArray) -> FloatArray:
    """zeta from three successive accelerations after jumps (n,), signed, m/s^2."""
    return _by_sums(after)


def _mean(values: FloatArray, unit: str, what: str) -> Quantity:
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
    twelve, thirteen = by_eq_12(before), by_eq_13(after)
    zeta = _mean(np.concatenate([twelve, thirteen]), "1", "eqs. 12 and 13")
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
        _mean(single, unit, "eq. 11"),
        inner.size,
        tuple(
            Reversal(float(time), None, float(b), float(p), float(x), scatter)
            for time, b, p, x in zip(inner, before, after, single, strict=True)
        ),
        notes=("as published: standard errors are the scatter of the averaged figures and know nothing of their bias",),
    )


def displacement_paper(
    t: FloatArray, x: FloatArray, edges: FloatArray, omega_d: tuple[float, float], unit: str = "m"
) -> Estimate:
    """The displacement decrement as the paper used it: largest samples, eqs. 7 and 8 and then 6, first period
    dropped, averaged.

    Arguments as for acceleration_paper, x (n,) in m. Kept for the table that compares with the paper's.
    """
    half = math.pi / omega_d[0]
    times = edges[edges > edges[0] + 1.5 * half]
    turning = []
    for time in times:
        part = x[slice(*np.searchsorted(t, [time - 0.25 * half, time + 0.25 * half]))]
        turning.append(float(part[np.argmax(np.abs(part))]) if part.size else math.nan)
    points = np.array(turning)
    zeta = _mean(np.concatenate([_by_sums(points), _by_differences(points)]), "1", "eqs. 7 and 8")
    if zeta.value is None or abs(zeta.value) >= 1.0:
        return Estimate.refused("eqs. 7 and 8 gave no damping ratio", unit)
    root = math.sqrt(1.0 - zeta.value**2)
    q = math.exp(-math.pi * zeta.value / root)
    single = np.sign(points[:-1]) * (points[1:] + q * points[:-1]) / (1.0 + q)
    omega_n = omega_d[0] / root
    return Estimate(quantity(omega_n, omega_d[1] / root, "rad/s"), zeta, _mean(single, unit, "eq. 6"), points.size)
