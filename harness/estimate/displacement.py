"""Method displacement: q from the decrements of the turning points (Liang, eqs. 7 and 8), then x_k from eq. 6.

Eqs. 7 and 8 are eq. 6 with x_k, and with x_k and an offset of the sensor, eliminated. Dividing noisy differences is
what makes them poor; here the same recursion is fitted to all turning points with their covariance, both ends of each
half-cycle counted, and an offset is kept when the data show one.

Turning points of the displacement, and the times at which the speed is zero, read off the fitted forms.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.estimate.channel import ChannelFit
from harness.estimate.result import Estimate, Reversal, damped, quantity
from harness.estimate.sequence import Model, SequenceFit, fit_sequence, loss_of, powers, whitening
from harness.estimate.tied import OMEGA


@dataclass(frozen=True, slots=True)
class TurningPoints:
    """Both ends of K half-cycles.

    time : (K,2) s, where the form of the half-cycle has speed zero. value : (K,2) m. covariance : (K,2,2) m^2.
    seen : (K,2), whether samples reach that end (a record that begins or ends in motion hides one).
    """

    time: FloatArray
    value: FloatArray
    covariance: FloatArray
    seen: BoolArray

    def merged(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Times, values and variances of the K+1 turning points, both sides weighted; unseen ones are nan."""
        count = self.time.shape[0]
        weight = np.zeros((2, count + 1))
        level, clock = np.zeros((2, count + 1)), np.zeros((2, count + 1))
        for side, shift in ((0, 0), (1, 1)):
            part = slice(shift, count + shift)
            weight[side, part] = np.where(
                self.seen[:, side], 1.0 / np.maximum(self.covariance[:, side, side], 1e-300), 0.0
            )
            level[side, part], clock[side, part] = self.value[:, side], self.time[:, side]
        total = weight.sum(axis=0)
        seen = total > 0.0
        share = np.where(seen, total, 1.0)
        return tuple(  # type: ignore[return-value]
            np.where(seen, array, np.nan)
            for array in ((weight * clock).sum(axis=0) / share, (weight * level).sum(axis=0) / share, 1.0 / share)
        )


def _seen(fit: ChannelFit, time: FloatArray) -> BoolArray:
    interval = float(np.median(np.diff(fit.t)))
    slack = 1.5 * interval
    return np.asarray((time > fit.t[0] - slack) & (time < fit.t[-1] + slack), dtype=np.bool_)


_REACH = 0.2
"""Share of a half-cycle on each side of a turning point that is looked at when the base model does not hold."""


def _near(fit: ChannelFit, time: float) -> tuple[float, float, float]:
    """Time, value and variance per unit of variance of one turning point, from the samples about it alone.

    A quartic with a curvature of its own on each side: the jump of the acceleration, and no law of the spring.
    """
    reach = _REACH * np.pi / fit.omega
    part = slice(*np.searchsorted(fit.t, [time - reach, time + reach]))
    s = (fit.t[part] - time) / reach
    early = s < 0.0
    if min(np.count_nonzero(early), np.count_nonzero(~early)) < 4:
        return time, np.nan, np.inf
    basis = np.stack([np.ones(s.size), s, s * s * early, s * s * ~early, s**3, s**4], axis=1)
    normal = np.linalg.pinv(basis.T @ basis)
    c = normal @ (basis.T @ fit.y[part])
    curvature = c[2] + c[3]  # twice the mean of both sides
    step = float(np.clip(-c[1] / curvature, -0.5, 0.5)) if curvature != 0.0 else 0.0
    return time + step * reach, float(c[0] + 0.5 * c[1] * step), float(normal[0, 0])


def _locally(fit: ChannelFit) -> TurningPoints:
    """Turning points one by one, where the half-cycles are not those of the base model."""
    separate = fit.separate
    edges, stops = separate.edges.copy(), separate.stops()
    edges[0], edges[-1] = stops[0, 0], stops[-1, 1]
    found = np.array([_near(fit, float(time)) for time in edges])
    ends = _from_forms(fit)
    time, value, covariance = ends.time, ends.value, ends.covariance
    seen = ends.seen.copy()
    time[:, 0], time[:, 1] = found[:-1, 0], found[1:, 0]
    inner = np.isfinite(found[:-1, 1])
    value[inner, 0] = found[:-1, 1][inner]
    covariance[inner] = 0.0
    covariance[inner, 0, 0] = found[:-1, 2][inner] * fit.noise.sigma**2 * fit.inflation
    covariance[inner, 1, 1] = covariance[inner, 0, 0]
    # each inner turning point counts once, as the start of the half-cycle after it
    seen[:-1, 1] = ~inner[1:]
    if np.isfinite(found[-1, 1]):
        value[-1, 1], covariance[-1, 1, 1] = found[-1, 1], found[-1, 2] * fit.noise.sigma**2 * fit.inflation
    return TurningPoints(time, value, covariance, seen)


def turning_points(fit: ChannelFit) -> TurningPoints:
    """Turning points from a fit of the displacement: from the half-cycles' forms if these explain it, else one by
    one.
    """
    explained = fit.holds or fit.separate.variance < 4.0 * fit.noise.sigma**2
    return _from_forms(fit) if explained else _locally(fit)


def _from_forms(fit: ChannelFit) -> TurningPoints:
    separate = fit.separate
    time = separate.stops()
    basis = separate.basis(np.arange(len(separate))[:, None], time)
    value = np.einsum("ksi,ki->ks", basis, separate.c)
    covariance = np.einsum("ksi,kij,krj->ksr", basis, separate.inverse, basis) * fit.variance
    return TurningPoints(time, value, covariance, _seen(fit, time) & separate.known[:, None])


def reversal_times(fit: ChannelFit) -> FloatArray:
    """Times at which the speed changes sign between two half-cycles, (K-1,) s.

    Where friction does not reverse with the speed, the form after the jump tells: friction of soft constraints acts
    early.
    """
    if fit.holds:
        return fit.edges[1:-1]
    separate = fit.separate
    times = separate.stops()[1:, 0]
    near = np.abs(times - separate.edges[1:-1]) < 0.2 * np.pi / separate.omega
    return np.where(near, times, separate.edges[1:-1])


def all_edges(fit: ChannelFit) -> FloatArray:
    """Release (or where the first half-cycle would have begun), reversals, and stop (or where it would be), (K+1,)
    s.
    """
    if fit.holds:
        return fit.edges
    separate = fit.separate
    stops = separate.stops()
    return np.concatenate([stops[:1, 0], reversal_times(fit), stops[-1:, 1]])


def first_and_last_seen(fit: ChannelFit) -> tuple[bool, bool]:
    """Whether samples reach the first edge (release) and the last (stop)."""
    low, high = _seen(fit, all_edges(fit)[[0, -1]])
    return bool(low), bool(high)


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
        *damped((omega_d, omega_error), (beta, beta_error)),
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
