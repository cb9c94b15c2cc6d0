"""A log's motion on even times, low-passed alike and without delay, with its derivatives; its noise and its rests."""

import math
from collections.abc import Container
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.robot.joint_log import JointLog
from harness.robot.arm import Arm

CUTOFF = 15.0
"""Hz: arms move below some Hz, and a second derivative of an encoder's noise grows with the square of this."""
_SHARE = 0.4
"""Of half the sampling rate: the highest cutoff."""
_ORDER = 2
"""Of the filter, which runs forwards and backwards."""
_MEDIAN_OF_NORMAL = 0.6745
"""Median size of a normal number of deviation one; second differences of white noise have six times its variance."""
_STILL = 3.0
"""Times its noise within which a joint's position scatters where it stands still."""
_NOWHERE = 1e-6
"""rad or m: less than the finest encoder resolves is no motion, whatever the digits of a log say."""


def white_sd(y: FloatArray) -> float:
    """Standard deviation of a recorded series' white noise, from the middle of its second differences.

    Motion bends little from sample to sample, and the few differences across a jump do not move the middle.
    """
    return float(np.median(np.abs(np.diff(y, 2)))) / (_MEDIAN_OF_NORMAL * math.sqrt(6.0))


def noise_of(y: FloatArray) -> float:
    """Standard deviation of a position's noise, its steps included, in its own unit."""
    steps = np.abs(np.diff(y))
    smallest = float(np.min(steps[steps > 0.0], initial=math.inf))
    return max(white_sd(y), smallest / math.sqrt(12.0) if math.isfinite(smallest) else 0.0)


def moves(y: FloatArray) -> bool:
    """Whether a position (n,) does more than scatter about its mean."""
    return float(np.std(y)) > max(_STILL * noise_of(y), _NOWHERE)


def moving(arm: Arm, log: JointLog) -> tuple[str, ...]:
    """Joints of the model that move in a log."""
    return tuple(name for name in arm.joints if name in log.position and moves(log.position[name]))


def rests(q: FloatArray, within: float, width: int) -> tuple[IntArray, IntArray]:
    """First and last samples (r,) between which a position (n,) stays within a range for at least ``width`` samples."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    flat = maximum_filter1d(q, width) - minimum_filter1d(q, width) <= within
    edges = np.flatnonzero(np.diff(np.concatenate(([0], flat.astype(np.int8), [0]))))
    return np.maximum(edges[::2] - width // 2, 0), np.minimum(edges[1::2] - 1 + width // 2, q.size - 1)


@dataclass(frozen=True, slots=True)
class Even:
    """Even times. t (n,) : s. cutoff : of the filter, Hz."""

    t: FloatArray
    cutoff: float

    @classmethod
    def of(cls, t: FloatArray) -> "Even":
        """Even times over those of a log, at its median interval."""
        interval = float(np.median(np.diff(t)))
        n = max(int((t[-1] - t[0]) / interval), 1) + 1
        return cls(np.linspace(t[0], t[-1], n), min(CUTOFF, _SHARE * 0.5 / interval))

    def low(self, t: FloatArray, y: FloatArray) -> FloatArray:
        """A channel (m,) of times t (m,) on the even ones, low-passed, (n,)."""
        from scipy.signal import butter, sosfiltfilt

        sections = butter(_ORDER, self.cutoff, fs=1.0 / (self.t[1] - self.t[0]), output="sos")
        return np.asarray(sosfiltfilt(sections, np.interp(self.t, t, y)))

    def motion(
        self, arm: Arm, log: JointLog, still: FloatArray, joints: Container[str] | None = None
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, speeds and accelerations (n, nv) of an arm along a log; still (nv,) : where the others stand.

        joints : those that are led along it, by default all that were logged.
        """
        q = np.tile(still, (self.t.size, 1))
        v, a, interval = np.zeros_like(q), np.zeros_like(q), float(self.t[1] - self.t[0])
        for i, name in enumerate(arm.joints):
            if name in log.position and (joints is None or name in joints):
                q[:, i] = self.low(log.t, log.position[name])
                v[:, i] = np.gradient(q[:, i], interval)
                a[:, i] = np.gradient(v[:, i], interval)
        return q, v, a

    def settled(self, most: int | None = None) -> slice:
        """Without the ends, where a filter knows nothing of what comes before and after; some ``most`` of them."""
        interval, size = float(self.t[1] - self.t[0]), self.t.size
        edge = min(int(1.0 / (self.cutoff * interval)) + 1, size // 10)
        return slice(edge, size - edge, 1 if most is None else max(1, (size - 2 * edge) // most))
