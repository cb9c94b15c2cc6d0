"""A force periodic in position, found in what a model leaves of the force of a recording by the published protocol."""

import math
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.diagnosis.driven.force import inverse_force
from harness.diagnosis.driven.protocol import Filtered
from harness.model.model import Model

_LEAST_CYCLES, _MOST_CYCLES = 8.0, 400.0
_PER_CYCLE = 4
"""Frequencies tried per one over the travel."""
_MOVING = 0.05
_AT_ONCE = 200


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
    count = int((_MOST_CYCLES - _LEAST_CYCLES) * _PER_CYCLE)
    wave = 2.0 * math.pi * np.linspace(_LEAST_CYCLES, _MOST_CYCLES, count) / travel
    power = _power(x, y, wave)
    best = wave[int(np.argmax(power))]
    step = float(wave[1] - wave[0])
    near = best + np.linspace(-step, step, 41)
    best = float(near[int(np.argmax(_power(x, y, near)))])
    basis = np.column_stack((np.cos(best * x), np.sin(best * x)))
    cosine, sine = np.linalg.lstsq(basis, y, rcond=None)[0]
    contrast = float(np.max(power) / np.median(power))
    return Ripple(2.0 * math.pi / best, math.hypot(cosine, sine), math.atan2(-sine, cosine), contrast)


def _power(x: FloatArray, y: FloatArray, wave: FloatArray) -> FloatArray:
    """Squared amplitude at each wave number (k,), in pieces that fit into memory."""
    parts = [np.abs(np.exp(-1j * np.outer(wave[i : i + _AT_ONCE], x)) @ y) ** 2 for i in range(0, wave.size, _AT_ONCE)]
    power: FloatArray = np.concatenate(parts) * (2.0 / x.size) ** 2
    return power
