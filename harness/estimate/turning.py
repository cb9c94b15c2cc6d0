"""Turning points of the displacement, and the times at which the speed is zero, read off the fitted forms."""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.estimate.channel import ChannelFit
from harness.estimate.reversals import Kind


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


def turning_points(fit: ChannelFit) -> TurningPoints:
    """Turning points from a fit of the displacement."""
    separate = fit.separate
    count = len(separate)
    time = np.array([separate.stops(k) for k in range(count)])
    basis = np.array([[separate.basis(k, time[k, side]) for side in (0, 1)] for k in range(count)])
    value = np.einsum("ksi,ki->ks", basis, separate.c)
    covariance = np.einsum("ksi,kij,krj->ksr", basis, separate.inverse, basis) * fit.variance
    return TurningPoints(time, value, covariance, _seen(fit, time) & separate.known[:, None])


def reversal_times(fit: ChannelFit) -> FloatArray:
    """Times at which the speed changes sign between two half-cycles, (K-1,) s.

    Where friction does not reverse with the speed, the form after the jump tells: friction of soft constraints acts early.
    """
    if fit.holds:
        return fit.edges[1:-1]
    separate = fit.separate
    times = np.array([separate.stops(k)[0] for k in range(1, len(separate))])
    near = np.abs(times - separate.edges[1:-1]) < 0.2 * np.pi / separate.omega
    return np.where(near, times, separate.edges[1:-1])


def all_edges(fit: ChannelFit) -> FloatArray:
    """Release (or where the first half-cycle would have begun), reversals, and stop (or where it would be), (K+1,) s."""
    if fit.holds:
        return fit.edges
    separate = fit.separate
    first, last = separate.stops(0)[0], separate.stops(len(separate) - 1)[1]
    return np.concatenate([[first], reversal_times(fit), [last]])


def first_and_last_seen(fit: ChannelFit) -> tuple[bool, bool]:
    """Whether samples reach the first edge (release) and the last (stop)."""
    low, high = _seen(fit, all_edges(fit)[[0, -1]])
    return bool(low), bool(high)
