"""Turning points of a recorded motion, as the recording itself shows them: no model need follow it."""

from collections.abc import Mapping

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.rules import HAS_BEGUN
from harness.estimate.noise import channel_noise

_SEEN = 6.0
"""Standard deviations of noise between two turning points: what is nearer may be noise."""
_SHARE = 0.01
"""Share of the range at least: speed is summed up to a position, and its noise with it."""


def turning_points(t: FloatArray, channels: Mapping[str, FloatArray]) -> IntArray:
    """Samples (m,) at which the motion turns round by more than noise does, in order.

    t (n,) : s. channels : "x", "v" or "a", each (n,), SI; position is looked at where there is one, else the sum of the
    speed, else the acceleration, which is largest where the motion turns.
    """
    name, y = _displacement(t, channels)
    least = _SHARE * float(np.ptp(y))
    if name != "v":
        least = max(least, _SEEN * channel_noise(t, y).sigma)
    if least <= 0.0:
        return np.empty(0, dtype=np.int64)
    # imported when it is needed: it brings half of its library along
    from scipy.signal import find_peaks

    tops, _ = find_peaks(y, prominence=least)
    bottoms, _ = find_peaks(-y, prominence=least)
    return np.sort(np.concatenate((tops, bottoms)).astype(np.int64))


def _displacement(t: FloatArray, channels: Mapping[str, FloatArray]) -> tuple[str, FloatArray]:
    if "x" in channels:
        return "x", channels["x"]
    if "v" in channels:
        v = channels["v"]
        return "v", np.concatenate(([0.0], np.cumsum(np.diff(t) * (v[1:] + v[:-1]) / 2.0)))
    return "a", channels["a"]


def first_turn(t: FloatArray, channels: Mapping[str, FloatArray], turns: IntArray) -> int:
    """First sample after the first turning point of a motion that has begun; 0 where there is none.

    turns : see ``turning_points``. A hand at the release acts before it. An acceleration is largest at the release too:
    there it is the first turning point after it has changed its sign.
    """
    name, y = _displacement(t, channels)
    moved = np.abs(y) if name == "a" else np.abs(y - y[0])
    begun = np.flatnonzero(moved > HAS_BEGUN.value * np.ptp(y))
    if not begun.size:
        return 0
    at = int(begun[0])
    if name == "a":
        crossed = np.flatnonzero(np.sign(y[at:]) == -np.sign(y[at]))
        if not crossed.size:
            return 0
        at += int(crossed[0])
    later = turns[turns >= at]
    return int(later[0]) + 1 if later.size else 0
