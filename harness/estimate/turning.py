"""Turning points of the displacement, and the times at which the speed is zero, read off the fitted forms."""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.estimate.channel import ChannelFit


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
    count = len(separate)
    edges = separate.edges.copy()
    edges[0], edges[-1] = separate.stops(0)[0], separate.stops(count - 1)[1]
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
    count = len(separate)
    time = np.array([separate.stops(k) for k in range(count)])
    basis = np.array([[separate.basis(k, time[k, side]) for side in (0, 1)] for k in range(count)])
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
    times = np.array([separate.stops(k)[0] for k in range(1, len(separate))])
    near = np.abs(times - separate.edges[1:-1]) < 0.2 * np.pi / separate.omega
    return np.where(near, times, separate.edges[1:-1])


def all_edges(fit: ChannelFit) -> FloatArray:
    """Release (or where the first half-cycle would have begun), reversals, and stop (or where it would be), (K+1,)
    s.
    """
    if fit.holds:
        return fit.edges
    separate = fit.separate
    first, last = separate.stops(0)[0], separate.stops(len(separate) - 1)[1]
    return np.concatenate([[first], reversal_times(fit), [last]])


def first_and_last_seen(fit: ChannelFit) -> tuple[bool, bool]:
    """Whether samples reach the first edge (release) and the last (stop)."""
    low, high = _seen(fit, all_edges(fit)[[0, -1]])
    return bool(low), bool(high)
