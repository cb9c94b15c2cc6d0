"""A driven recording cut into windows, each with its start from the smoothed channels."""

from collections.abc import Mapping

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.diagnosis.problems.starts import Window
from harness.diagnosis.smoothed_state.local_cubics import Smooth, stretches

FEWEST = 8
"""Samples below which a window is not worth a start."""
_AWAY = 8
"""Samples either side of a start in which the slider should not turn round."""


def windows_of(
    t: FloatArray, state: tuple[FloatArray, FloatArray, FloatArray], smooth: Mapping[str, Smooth], horizon: float,
    longest: float,
) -> tuple[Window, ...]:  # fmt: skip
    """Windows no longer than ``horizon`` (s) that cover all samples; none spans an interval beyond ``longest`` (s).

    A start next to a reversal, where smoothing rounds off what friction does, is moved forward out of its way.
    """
    x, v, _ = state
    one = smooth["x"] if "x" in smooth else smooth["v"]
    x_sd = one.value_sd if "x" in smooth else np.full(t.size, float(np.ptp(x)))
    v_sd = smooth["v"].value_sd if "v" in smooth else one.slope_sd
    _, last = stretches(t, longest)
    turns = np.zeros(t.size, dtype=np.int64)
    turns[1:] = np.cumsum(np.sign(v[1:]) != np.sign(v[:-1]))
    found = []
    start = 0
    while start < t.size:
        stop = min(int(np.searchsorted(t, t[start] + horizon, side="left")), int(last[start]))
        if stop < last[start]:
            stop = _clear_of_turns(turns, start, stop)
            # nothing is left behind that is too short to be a window of its own
            stop = int(last[start]) if last[start] - stop < FEWEST else stop
        found.append(
            Window(
                start, stop, float(t[start]), float(x[start]), float(v[start]), float(x_sd[start]), float(v_sd[start])
            )
        )
        start = stop
    return tuple(found)


def _clear_of_turns(turns: IntArray, start: int, stop: int) -> int:
    """The latest sample up to ``stop``, within the last fifth of the window, with no reversal close by."""
    for at in range(stop, max(start + FEWEST, stop - (stop - start) // 5), -1):
        if turns[min(at + _AWAY, turns.size - 1)] == turns[max(at - _AWAY, 0)]:
            return at
    return stop
