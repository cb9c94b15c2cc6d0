"""One trajectory against another that has other time stamps."""

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.trajectory import Trajectory


def position_at(reference: Trajectory, t: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Position of ``reference`` at other times, m, and which of the times it covers.

    Cubic Hermite interpolation from x and v: exact at its own samples, off by order h^4 between them and by at most
    h^2/8 times the jump of acceleration in the interval that holds a reversal.
    """
    covered = (t >= reference.t[0]) & (t <= reference.t[-1])
    i = np.clip(np.searchsorted(reference.t, t, side="right") - 1, 0, len(reference) - 2)
    h = reference.t[i + 1] - reference.t[i]
    s = (t - reference.t[i]) / h
    x0, x1, v0, v1 = reference.x[i], reference.x[i + 1], reference.v[i] * h, reference.v[i + 1] * h
    rise = x1 - x0
    inside = x0 + s * (v0 + s * (3.0 * rise - 2.0 * v0 - v1 + s * (v0 + v1 - 2.0 * rise)))
    return np.where(s == 1.0, x1, inside), covered


def position_error(t: FloatArray, x: FloatArray, reference: Trajectory) -> FloatArray:
    """Positions ``x`` at times ``t`` minus the reference's, m, shape (n,); nan where the reference does not reach."""
    exact, covered = position_at(reference, t)
    return np.where(covered, x - exact, np.nan)
