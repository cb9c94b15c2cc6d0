"""The published protocol of force errors of the drive-axis benchmark (Janot, Gautier, Brunot 2019), with one trimming.

Its filter, its trimming and its decimation decide the third digit; so they are constants of one object, and no options.

A force periodic in position, found in what a model leaves of the force of a recording by the published protocol.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.problems.asked import inverse_force
from harness.fit.series import PER_CYCLE, spectrum, standing_out
from harness.model.model import Model

_FASTER, _LONGER = 2.5, 4
"""Sampling over the cut-off (two is the limit of a filter), and samples over those dropped at an end: half stay."""


@dataclass(frozen=True, slots=True)
class Filtered:
    """A recording through the protocol: t (s), x, v, a at every sample that is kept, (n,); force u_full (n,), N, and
    u decimated, (m,).
    """

    t: FloatArray
    x: FloatArray
    v: FloatArray
    a: FloatArray
    u_full: FloatArray
    u: FloatArray


@dataclass(frozen=True, slots=True)
class ForceProtocol:
    """Position through a Butterworth low-pass forwards and backwards, central differences twice, ends dropped, then
    regressors and force decimated (Chebyshev I, zero phase). Fewer dropped samples let the filter's start-up in.

    The amplifier's offset is part of the protocol: a constant by least squares on the recording that was fitted,
    carried to the other.
    """

    order: int = field(default=4, init=False)
    cut_off_hz: float = field(default=100.0, init=False)
    dropped: int = field(default=100, init=False)
    decimation: int = field(default=10, init=False)
    decimation_order: int = field(default=8, init=False)

    def applies(self, t: FloatArray) -> bool:
        """Whether a recording at t (n,) is fast and long enough for these constants."""
        fast = 1.0 / float(np.median(np.diff(t))) > _FASTER * self.cut_off_hz
        return fast and t.size > _LONGER * self.dropped

    def filtered(self, t: FloatArray, x: FloatArray, u: FloatArray) -> Filtered:
        """A recording of x (n,) and u (n,) at t (n,) through the filter, the differences and the trimming."""
        from scipy.signal import butter, filtfilt

        interval = float(np.median(np.diff(t)))
        b, a = butter(self.order, 2.0 * self.cut_off_hz * interval)
        smooth = filtfilt(b, a, x)
        v = np.gradient(smooth, interval)
        kept = slice(self.dropped, -self.dropped)
        a_full = np.gradient(v, interval)
        return Filtered(t[kept], smooth[kept], v[kept], a_full[kept], u[kept], self.decimated(u[kept]))

    def decimated(self, y: FloatArray) -> FloatArray:
        """A signal (n,) or several (n, q) at the lower rate."""
        from scipy.signal import decimate

        low: FloatArray = decimate(y, self.decimation, n=self.decimation_order, ftype="iir", zero_phase=True, axis=0)
        return low

    def model_errors(self, model: Model, *recordings: Filtered) -> tuple[float, ...]:
        """Relative force error, %, of a model on the recording it was fitted to and then on others."""
        offset: float | None = None
        errors = []
        for r in recordings:
            left = r.u - self.decimated(inverse_force(model, r.t, r.x, r.v, r.a))
            offset = float(np.mean(left)) if offset is None else offset
            errors.append(100.0 * _norm(left - offset) / _norm(r.u))
        return tuple(errors)

    def least_squares(self, names: Sequence[str], *recordings: Filtered) -> tuple[dict[str, float], tuple[float, ...]]:
        """The published way: regressors by name ("M", "Fv", "Fc", "offset", "Fv_diff") fitted to the first recording.

        Returns the parameters and the errors, %, on it and on the others.
        """
        tables = [self.decimated(np.column_stack([_REGRESSORS[n](r) for n in names])) for r in recordings]
        theta = np.linalg.lstsq(tables[0], recordings[0].u, rcond=None)[0]
        errors = [100.0 * _norm(r.u - w @ theta) / _norm(r.u) for r, w in zip(recordings, tables, strict=True)]
        return dict(zip(names, theta.tolist(), strict=True)), tuple(errors)


def _norm(y: FloatArray) -> float:
    return math.sqrt(float(y @ y))


_REGRESSORS = {
    "M": lambda r: r.a,
    "Fv": lambda r: r.v,
    "Fc": lambda r: np.sign(r.v),
    "offset": lambda r: np.ones_like(r.v),
    "Fv_diff": lambda r: np.abs(r.v),
}
PUBLISHED = ForceProtocol()
SYMMETRIC = ("M", "Fv", "Fc", "offset")
DIRECTED = (*SYMMETRIC, "Fv_diff")


_LEAST_CYCLES, _MOST_CYCLES = 8.0, 400.0
"""Over the travel, by the published protocol: fewer change slowly with place, more are finer than a path is read."""
_MOVING = 0.05
"""Of the largest speed: slower, friction may have any value and the place hardly changes."""


@dataclass(frozen=True, slots=True)
class Ripple:
    """amplitude (N) cos(2 pi x/period + phase). contrast : power over the median of the periods tried."""

    period: float
    amplitude: float
    phase: float
    contrast: float


def find_ripple(model: Model, recording: Filtered) -> Ripple:
    """The strongest ripple between an eighth and a four-hundredth of the travel; made at the full rate, in motion."""
    r = recording
    # the force at the full rate: the ripple of a fast pass lies beyond the decimated one
    left = r.u_full - inverse_force(model, r.t, r.x, r.v, r.a)
    moving = np.abs(r.v) > _MOVING * float(np.max(np.abs(r.v)))
    x, y = r.x[moving], left[moving] - float(np.mean(left[moving]))
    travel = float(np.ptp(x))
    power = spectrum(x, y, _LEAST_CYCLES, _MOST_CYCLES)
    best = 2.0 * math.pi / standing_out(x, y, _LEAST_CYCLES, _MOST_CYCLES)[0]
    near = best + np.linspace(-1.0, 1.0, 41) * 2.0 * math.pi / (PER_CYCLE * travel)
    best = float(near[int(np.argmax(_power(x, y, near)))])
    basis = np.column_stack((np.cos(best * x), np.sin(best * x)))
    cosine, sine = np.linalg.lstsq(basis, y, rcond=None)[0]
    contrast = float(np.max(power) / np.median(power))
    return Ripple(2.0 * math.pi / best, math.hypot(cosine, sine), math.atan2(-sine, cosine), contrast)


def _power(x: FloatArray, y: FloatArray, wave: FloatArray) -> FloatArray:
    """Squared amplitude at each wave number (k,)."""
    power: FloatArray = np.abs(np.array([np.exp(-1j * w * x) @ y for w in wave])) ** 2 * (2.0 / x.size) ** 2
    return power
