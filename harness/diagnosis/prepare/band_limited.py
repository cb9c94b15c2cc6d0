"""A sampled force whose spectrum ends well below half the sampling rate, as a multisine's does behind its filter.

It is known between its samples, however few of them a period has, and a polynomial through neighbours misses it: the
sum of sinc pulses has it (Whittaker-Shannon), under a window that ends them.
"""

import numpy as np

from harness.core.arrays import FloatArray
from harness.kernels.solve import Drive

_BANDS, _FIRST = 10, 2
"""Parts of a spectrum up to half the sampling rate; the first where polynomials through neighbours miss a signal."""
_CLIFF = 30.0
"""Times by which it falls within two of them where it ends: what jumps falls by nine at most, what kinks by eighty only
in the lowest."""
_SHARE = 0.01
"""Of its power, from which it matters what lies there."""
_EVEN = 1e-3
"""Share by which steps may differ."""
_PULSE, _SIDE = 16, 6.8
"""Samples to either side that a pulse reaches over, and its Kaiser window: 70 dB of what lies below .85 of the end."""
_FEWEST = 4 * _PULSE
"""Samples, of which half have pulses that are whole."""
_FINER = 4
"""Straight pieces of an interval: ten to a period of the fastest that is passed."""


def ends(t: FloatArray, u: FloatArray) -> bool:
    """Whether the spectrum of a force u (n,) at t (n,), s, falls off a cliff where few samples a period are left."""
    step = np.diff(t)
    if t.size < _FEWEST or np.ptp(step) > _EVEN * float(np.mean(step)):
        return False
    taper = np.hanning(u.size + 2)[1:-1]
    power = np.abs(np.fft.rfft((u - np.mean(u)) * taper)) ** 2
    level = np.array([np.mean(band) for band in np.array_split(power[1:], _BANDS)])
    if np.sum(level[_FIRST:]) < _SHARE * np.sum(level):
        return False
    return any(level[i] > _CLIFF * np.max(level[i + 2 :]) for i in range(_FIRST, _BANDS - 2))


def band_limited(t: FloatArray, u: FloatArray) -> Drive:
    """The drive of such a force u (n,) at evenly spaced t (n,), s, in straight pieces that keep its momentum."""
    # beyond its ends as if turned about them: a pulse there is missed for its width
    left, right = 2.0 * u[0] - u[_PULSE:0:-1], 2.0 * u[-1] - u[-2 : -_PULSE - 2 : -1]
    whole = np.concatenate((left, u, right))
    fine = np.zeros(whole.size * _FINER)
    fine[::_FINER] = whole
    at = np.arange(-_PULSE * _FINER, _PULSE * _FINER + 1) / _FINER
    pulse = np.sinc(at) * np.kaiser(at.size, _SIDE)
    first = _PULSE * _FINER
    fine = np.convolve(fine, pulse)[first : first + fine.size][first - 1 :]
    fine = fine[: (u.size - 1) * _FINER + 3]
    # a chord misses its length squared times the bend, over 12, of the force's integral
    force = fine[1:-1] - np.diff(fine, 2) / 12.0
    return Drive(np.linspace(t[0], t[-1], force.size), force)
