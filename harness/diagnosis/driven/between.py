"""How a recorded force runs between its samples where it is not held: straight, or smooth if that predicts better."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.kernels.solve import Drive

_FINER = 4
"""Straight pieces by which a smooth interval is followed: a sixteenth of what one piece would miss."""
_FEWEST = 20


def between_samples(t: FloatArray, u: FloatArray) -> Drive:
    """The drive of a force u (n,) at t (n,), s.

    Every second sample is left out and predicted from the others, by straight lines and by Akima's curve; noise is
    better predicted by the former, a smooth force by the latter.
    """
    from scipy.interpolate import Akima1DInterpolator

    if t.size < _FEWEST:
        return Drive(t, u)
    left_out = slice(1, (t.size - 1) // 2 * 2, 2)
    knots, values = t[::2], u[::2]
    straight = np.interp(t[left_out], knots, values) - u[left_out]
    curved = Akima1DInterpolator(knots, values)(t[left_out]) - u[left_out]
    if float(curved @ curved) >= float(straight @ straight):
        return Drive(t, u)
    share = np.arange(_FINER) / _FINER
    fine = np.append((t[:-1, None] + np.diff(t)[:, None] * share).ravel(), t[-1])
    return Drive(fine, Akima1DInterpolator(t, u)(fine))
