"""Method displacement: q from the decrements of the turning points (Liang, eqs. 7 and 8), then x_k from eq. 6.

Eqs. 7 and 8 are eq. 6 with x_k, and with x_k and an offset of the sensor, eliminated. Dividing noisy differences is
what
makes them poor; here the same recursion is fitted to all turning points with their covariance, both ends of each
half-cycle counted, and an offset is kept when the data show one.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.estimate.channel import ChannelFit
from harness.estimate.result import Estimate, Reversal, quantity
from harness.estimate.sequence import Model, SequenceFit, fit_sequence, loss_of, powers, whitening
from harness.estimate.tied import OMEGA
from harness.estimate.turning import TurningPoints, turning_points


def half_cycle_frequency(fit: ChannelFit, times: FloatArray) -> tuple[float, float]:
    """omega_d = pi / half-cycle time and its standard error, rad/s; times (n,) of successive turning points."""
    if fit.holds:
        return fit.omega, math.sqrt(max(float(fit.tied.covariance[OMEGA, OMEGA]) * fit.variance, 0.0))
    index = np.arange(times.size)
    keep = np.isfinite(times)
    keep[[0, -1]] &= times.size < 5  # a release by hand and a stop say least
    if np.count_nonzero(keep) < 2:
        return fit.omega, math.inf
    line = np.polyfit(index[keep], times[keep], 1)
    slope, left = line[0], times[keep] - np.polyval(line, index[keep])
    freedom = max(int(np.count_nonzero(keep)) - 2, 1)
    spread = np.sum((index[keep] - index[keep].mean()) ** 2)
    error = math.sqrt(float(left @ left) / freedom / spread)
    return math.pi / float(slope), math.pi / float(slope) ** 2 * error


def _recursion(sides: FloatArray, offset: bool) -> Model:
    """|X| at both ends of each half-cycle from (q, x_k, A_0[, offset]): A + x_k and q A - x_k, A' = q A - 2 x_k."""

    def model(theta: FloatArray) -> tuple[FloatArray, FloatArray]:
        q, x_k, first = theta[:3]
        power, by_power, total, by_total = powers(float(q), sides.size)
        swing = first * power - 2.0 * x_k * total
        by_q = first * by_power - 2.0 * x_k * by_total
        values = np.stack([swing + x_k, q * swing - x_k], axis=1)
        slope = np.zeros((sides.size, 2, theta.size))
        slope[:, 0, 0], slope[:, 1, 0] = by_q, swing + q * by_q
        slope[:, 0, 1], slope[:, 1, 1] = 1.0 - 2.0 * total, -2.0 * q * total - 1.0
        slope[:, 0, 2], slope[:, 1, 2] = power, q * power
        if offset:
            values = values + theta[3] * np.stack([sides, -sides], axis=1)
            slope[:, 0, 3], slope[:, 1, 3] = sides, -sides
        return values, slope

    return model


def _fit(points: TurningPoints, sides: FloatArray, q: float) -> tuple[SequenceFit, bool]:
    values = points.value * np.stack([sides, -sides], axis=1)
    whiten = whitening(points.covariance)
    for k, end in np.argwhere(~points.seen):
        # what one end alone says: its own deviation, nothing about the other
        whiten[k] = 0.0
        alone = float(points.covariance[k, 1 - end, 1 - end])
        if points.seen[k, 1 - end] and alone > 0.0:
            whiten[k, 1 - end, 1 - end] = 1.0 / math.sqrt(alone)
    start = np.array([q, 0.0, abs(values[points.seen[:, 0], 0][0])])
    plain = fit_sequence(values, whiten, _recursion(sides, False), start)
    # eq. 7 needs the unstretched spring at x = 0, eq. 8 does not
    free = fit_sequence(values, whiten, _recursion(sides, True), np.append(plain.theta, 0.0))
    shifted = sides.size >= 4 and plain.squares - free.squares > 12.0 * max(free.scatter, 1.0)
    return (free, True) if shifted else (plain, False)


def displacement(fit: ChannelFit, unit: str = "m") -> Estimate:
    """omega_n, zeta and x_k (in ``unit``) from the fit of a displacement."""
    points = turning_points(fit)
    count = points.time.shape[0]
    sides = np.asarray(fit.cycles.side * (-1.0) ** np.arange(count), dtype=np.float64)
    if not np.any(points.seen[:, 0]) or np.count_nonzero(points.seen) < 4:
        return Estimate.refused("too few turning points are within reach of the samples", unit)
    found, shifted = _fit(points, sides, math.exp(-math.pi * min(max(fit.sigma / fit.omega, 0.0), 0.5)))
    covariance = found.covariance * max(found.scatter, 1.0)
    times, turning, variance = points.merged()
    omega_d, omega_error = half_cycle_frequency(fit, times)
    q, x_k = float(found.theta[0]), float(found.theta[1])
    beta, beta_error = math.inf, math.inf
    if q > 0.0:
        beta, beta_error = -math.log(q) / math.pi, math.sqrt(covariance[0, 0]) / (q * math.pi)
    x_k_error = math.sqrt(covariance[1, 1])
    offset = float(found.theta[3]) if shifted else 0.0
    notes = []
    loss = loss_of(turning, variance * max(found.scatter, 1.0), beta_error)
    if loss is not None:
        beta, beta_error = loss.of(loss.beta)
        x_k, x_k_error = loss.of(loss.size)
        # a constant is told from a decay only by a decay that is seen: here it is half way between turning points
        offset = float(np.nanmean(turning[1:] + turning[:-1])) / 2.0 if shifted else 0.0
        q, shifted = math.exp(-math.pi * beta), False
        notes.append(loss.said)
    elif q <= 0.0:
        return Estimate.refused("the turning points do not decay as eq. 6 says", unit)
    root = math.sqrt(1.0 + beta * beta)
    omega_n = omega_d * root
    rows = []
    for i in range(1, count + 1):
        side = float(sides[i - 1])  # of the turning point before
        own = -side * (turning[i] - offset)
        before = side * (turning[i - 1] - offset)
        single = (q * before - own) / (1.0 + q)
        error = math.sqrt(q * q * variance[i - 1] + variance[i]) / (1.0 + q)
        zeta = _by_eq_7(turning, i, offset)
        if math.isfinite(own):
            known = math.isfinite(single)
            rows.append(
                Reversal(
                    float(times[i]),
                    float(turning[i]),
                    x_k=float(single) if known else None,
                    stderr=float(error) if known else None,
                    zeta=zeta,
                )
            )
    if shifted:
        notes.append(
            f"x is measured from {offset:.4g} {unit} off the rest position of the spring (eq. 8 rules, eq. 7 cannot)"
        )
    return Estimate(
        quantity(omega_n, math.hypot(omega_error * root, omega_d * beta / root * beta_error), "rad/s"),
        quantity(beta / root, beta_error / root**3, "1"),
        quantity(x_k, x_k_error, unit),
        count - 1,
        tuple(rows),
        notes=tuple(notes),
    )


def _by_eq_7(turning: FloatArray, i: int, offset: float) -> float | None:
    """Zeta from three successive turning points, eq. 7; None where it gives none."""
    if i + 1 >= turning.size:
        return None
    after, before = turning[i + 1] + turning[i] - 2 * offset, turning[i] + turning[i - 1] - 2 * offset
    ratio = -after / before if before != 0.0 else math.nan
    if not math.isfinite(ratio) or ratio <= 0.0:
        return None
    beta = -math.log(ratio) / math.pi
    return beta / math.sqrt(1.0 + beta * beta)
