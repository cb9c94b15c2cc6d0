"""A force periodic in position, found in what a model leaves of the force of a recording by the published protocol."""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.baseline.spectral_peaks import peaks
from harness.diagnosis.inverse_dynamics.force import inverse_force
from harness.diagnosis.inverse_dynamics.protocol import Filtered
from harness.model.model import Model

_LEAST_CYCLES, _MOST_CYCLES = 8.0, 400.0
"""Over the travel, by the published protocol: fewer change slowly with place, more are finer than a path is read."""
_FEWEST_CYCLES = 1.5
"""Over the travel, of a law that is fitted beside others: fewer are a spring's shape."""
_SLOW = 3
"""Periods of fewer cycles than the protocol's that are looked at."""
_PER_CYCLE = 4
"""Frequencies tried per one over the travel."""
_MOVING = 0.05
"""Of the largest speed: slower, friction may have any value and the place hardly changes."""
_PLACES = 1 << 13
"""Places over the travel, twenty to the shortest period."""


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
    power = _spectrum(x, y, _LEAST_CYCLES, _MOST_CYCLES)
    best = 2.0 * math.pi / periods(x, y, 1)[0]
    near = best + np.linspace(-1.0, 1.0, 41) * 2.0 * math.pi / (_PER_CYCLE * travel)
    best = float(near[int(np.argmax(_power(x, y, near)))])
    basis = np.column_stack((np.cos(best * x), np.sin(best * x)))
    cosine, sine = np.linalg.lstsq(basis, y, rcond=None)[0]
    contrast = float(np.max(power) / np.median(power))
    return Ripple(2.0 * math.pi / best, math.hypot(cosine, sine), math.atan2(-sine, cosine), contrast)


def periods(x: FloatArray, force: FloatArray, count: int = 6) -> list[float]:
    """Periods (m) at which a force (n,) left over at positions x (n,) stands out, strongest first, and slow ones."""
    fine = _standing_out(x, force, _LEAST_CYCLES, _MOST_CYCLES)[:count]
    return [*fine, *_standing_out(x, force, _FEWEST_CYCLES, _LEAST_CYCLES)[:_SLOW]]


def _standing_out(x: FloatArray, force: FloatArray, fewest: float, most: float) -> list[float]:
    travel = float(np.ptp(x))
    power = _spectrum(x, force - float(np.mean(force)), fewest, most)
    return [travel / (fewest + i / _PER_CYCLE) for i in peaks(power).tolist()]


def _spectrum(x: FloatArray, y: FloatArray, fewest: float, most: float) -> FloatArray:
    """Squared amplitude from the fewest to the most cycles over the travel, by sums over short places: linear in n."""
    travel = float(np.ptp(x))
    place = np.minimum(((x - x.min()) / travel * _PLACES).astype(np.int64), _PLACES - 1)
    sums = np.bincount(place, y, _PLACES)
    power: FloatArray = np.abs(np.fft.rfft(sums, _PER_CYCLE * _PLACES)) ** 2
    return power[round(fewest * _PER_CYCLE) : round(most * _PER_CYCLE)] * (2.0 / x.size) ** 2


def _power(x: FloatArray, y: FloatArray, wave: FloatArray) -> FloatArray:
    """Squared amplitude at each wave number (k,)."""
    power: FloatArray = np.abs(np.array([np.exp(-1j * w * x) @ y for w in wave])) ** 2 * (2.0 / x.size) ** 2
    return power
