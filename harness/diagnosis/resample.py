"""A simulated motion at the times of a recording, faithful to jumps of the acceleration at reversals."""

from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.trajectory import Trajectory


@dataclass(frozen=True, slots=True)
class Kinematics:
    """Position (m), speed (m/s) and acceleration (m/s^2) at some times; all of shape (n,)."""

    x: FloatArray
    v: FloatArray
    a: FloatArray


def motion_at(trajectory: Trajectory, t: FloatArray) -> Kinematics:
    """The motion of a trajectory at times t (s), in its own time base.

    Position and speed by cubic Hermite polynomials, errors of order dt^4; acceleration by straight lines. Where the
    speed changes sign between two samples, friction jumps: there each side is continued to the reversal from its own
    samples, so that no time is shown a mean of before and after. Before the first sample the slider is held at its
    start; after the last one it moves on as it moved then for no longer than rounding needs, and stays.
    """
    s, x, v, a = trajectory.t, trajectory.x, trajectory.v, trajectory.a
    inside = np.minimum(t, s[-1])
    i = np.clip(np.searchsorted(s, inside, side="right") - 1, 0, s.size - 2)
    h = s[i + 1] - s[i]
    into, left = inside - s[i], s[i + 1] - inside
    r = into / h
    position = _hermite(r, h, x[i], v[i], x[i + 1], v[i + 1])
    speed = _hermite(r, h, v[i], a[i], v[i + 1], a[i + 1])
    acceleration = (1.0 - r) * a[i] + r * a[i + 1]
    turns = (v[i] * v[i + 1] <= 0.0) & (v[i] != v[i + 1])
    if turns.any():
        before = into <= _reversal(v[i], a[i], v[i + 1], a[i + 1], h)
        rising, falling = _slopes(s, a, i)
        from_left = (v[i] + a[i] * into, a[i] + rising * into)
        from_right = (v[i + 1] - a[i + 1] * left, a[i + 1] - falling * left)
        speed = np.where(turns, np.where(before, from_left[0], from_right[0]), speed)
        acceleration = np.where(turns, np.where(before, from_left[1], from_right[1]), acceleration)
    held = t < s[0]
    return Kinematics(np.where(held, x[0], position), np.where(held, 0.0, speed), np.where(held, 0.0, acceleration))


def _hermite(
    r: FloatArray, h: FloatArray, y0: FloatArray, d0: FloatArray, y1: FloatArray, d1: FloatArray
) -> FloatArray:
    """Cubic through values and slopes at both ends, at the share r (0 to 1) of an interval h."""
    q = 1.0 - r
    value: FloatArray = q * q * ((1.0 + 2.0 * r) * y0 + r * h * d0) + r * r * ((3.0 - 2.0 * r) * y1 - q * h * d1)
    return value


def _reversal(v0: FloatArray, a0: FloatArray, v1: FloatArray, a1: FloatArray, h: FloatArray) -> FloatArray:
    """Time after the first sample at which the speed passes zero: from whichever side stands nearer to it."""
    chord = np.divide(v0, v0 - v1, out=np.zeros_like(h), where=v0 != v1) * h
    ahead = np.divide(-v0, a0, out=chord.copy(), where=a0 != 0.0)
    back = h - np.divide(v1, a1, out=h - chord, where=a1 != 0.0)
    near = np.where(np.abs(v0) <= np.abs(v1), ahead, back)
    return np.where((near >= 0.0) & (near <= h), near, chord)


def _slopes(s: FloatArray, a: FloatArray, i: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Slopes of the acceleration in the interval before interval i and in the one after; 0 at the ends."""
    slope = np.zeros(s.size + 1)
    slope[1:-1] = np.diff(a) / np.diff(s)
    before, after = slope[i], slope[i + 2]
    # next to another jump there is no slope to go by
    typical = 10.0 * np.median(np.abs(slope[1:-1])) + 1e-300
    return np.where(np.abs(before) > typical, 0.0, before), np.where(np.abs(after) > typical, 0.0, after)
