"""The smoothed course of a driven recording, a base model from its inverse dynamics, and windows that start on it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.errors import InputError
from harness.diagnosis.smoothed_state.local_cubics import Smooth, longest_interval, smoothed, stretches
from harness.diagnosis.starts import Window, Windows
from harness.estimate.noise import Noise
from harness.model.model import Model, Restoring

_MOVING = 0.02
"""Share of the largest speed below which friction may have any value."""
_FEWEST = 20
"""Moving samples: four to each of five numbers."""
FEWEST, _AWAY = 8, 8
"""Samples below which a window is not worth a start, and either side of one in which the slider should not turn."""
_LEAST = 1e-3
"""Share that a parameter which must not vanish is given where least squares makes it negative."""


def state_of(t: FloatArray, smooth: Mapping[str, Smooth]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Position, speed and acceleration (n,) from smoothed x or v; x from v alone counts from its first sample."""
    if "x" in smooth:
        x = smooth["x"]
        v = smooth["v"].value if "v" in smooth else x.slope
        a = smooth["v"].slope if "v" in smooth else x.bend
        return x.value, v, a
    v = smooth["v"].value
    steps = 0.5 * (v[1:] + v[:-1]) * np.diff(t)
    return np.concatenate(([0.0], np.cumsum(steps))), v, smooth["v"].slope


def in_motion(v: FloatArray) -> BoolArray:
    """Which samples (n,) move: slower, friction may have any value."""
    return np.asarray(np.abs(v) > _MOVING * float(np.max(np.abs(v))))


def inverse_start(
    state: tuple[FloatArray, FloatArray, FloatArray],
    u: FloatArray,
    restoring: Restoring,
    mass: float | None,
    zero_free: bool,
) -> Model:
    """Base model by least squares of m a + c v + k R(x) + f_k sgn(v) + constant = u over the samples in motion.

    The constant takes up what would bias the others; it gives the sensor's zero with ``zero_free``. Raises InputError
    when the slider hardly moves.
    """
    x, v, a = state
    moving = in_motion(v)
    count = int(np.count_nonzero(moving))
    if count < _FEWEST:
        found = f"a slider that hardly moves ({count} of {v.size} samples show motion)"
        raise InputError("recording", found, f"a driven motion of at least {_FEWEST} samples")
    pull = {Restoring.SPRING: x, Restoring.PENDULUM: np.sin(x), Restoring.NONE: None}[restoring]
    # beside an angle's sine its cosine says from where it is measured: k sin(x - o) = k cos o sin x - k sin o cos x
    turned = restoring is Restoring.PENDULUM and zero_free
    columns = {"m": a, "c": v, "f_k": np.sign(v), "one": np.cos(x) if turned else np.ones_like(v)}
    if pull is not None:
        columns["k"] = pull
    right = u.copy()
    if mass is not None:
        right -= mass * columns.pop("m")
    table = np.column_stack([y[moving] for y in columns.values()])
    size = np.sqrt(np.mean(table**2, axis=0))
    found = np.linalg.lstsq(table / size, right[moving], rcond=None)[0] / size
    value = dict(zip(columns, found.tolist(), strict=True))
    force = math.sqrt(float(np.mean(u**2)))
    m = mass if mass is not None else max(value["m"], _LEAST * force / (math.sqrt(float(np.mean(a**2))) + 1e-300))
    speed = math.sqrt(float(np.mean(v**2)))
    k, offset = 0.0, 0.0
    if turned:
        offset = math.atan2(-value["one"], value["k"])
        value["k"] = math.hypot(value["one"], value["k"])
    if pull is not None:
        k = max(value["k"], _LEAST * force / (math.sqrt(float(np.mean(x**2))) + 1e-300))
    return Model(
        m,
        max(value["c"], _LEAST * force / speed),
        k,
        max(value["f_k"], _LEAST * force),
        restoring=restoring,
        mass_known=True,
        offset=-value["one"] / k if zero_free and not turned and k > 0.0 else offset,
    )


def _clear_of_turns(turns: IntArray, start: int, stop: int) -> int:
    """The latest sample up to ``stop``, within the last fifth of the window, with no reversal close by."""
    for at in range(stop, max(start + FEWEST, stop - (stop - start) // 5), -1):
        if turns[min(at + _AWAY, turns.size - 1)] == turns[max(at - _AWAY, 0)]:
            return at
    return stop


@dataclass(frozen=True, slots=True)
class Course:
    """Position, speed and acceleration, (n,) each, at t (n,), s; longest : interval (s) beyond which there is a gap."""

    t: FloatArray
    smooth: Mapping[str, Smooth]
    state: tuple[FloatArray, FloatArray, FloatArray]
    longest: float

    @classmethod
    def of(cls, t: FloatArray, channels: Mapping[str, FloatArray], noise: Mapping[str, Noise]) -> "Course":
        """From position, speed or both, over no gap."""
        longest = longest_interval(t)
        smooth = {c: smoothed(t, channels[c], longest, noise[c].sigma) for c in ("x", "v") if c in channels}
        return cls(t, smooth, state_of(t, smooth), longest)

    def anew(self, horizon: float) -> Windows:
        """Windows no longer than a horizon, s, that cover all samples; an infinite one leaves stretches between gaps.

        A start next to a reversal, where smoothing rounds off what friction does, is moved forward out of its way.
        """
        t, (x, v, _), smooth = self.t, self.state, self.smooth
        one = smooth["x"] if "x" in smooth else smooth["v"]
        x_sd = one.value_sd if "x" in smooth else np.full(t.size, float(np.ptp(x)))
        v_sd = smooth["v"].value_sd if "v" in smooth else one.slope_sd
        _, last = stretches(t, self.longest)
        turns = np.zeros(t.size, dtype=np.int64)
        turns[1:] = np.cumsum(np.sign(v[1:]) != np.sign(v[:-1]))
        found, start = [], 0
        while start < t.size:
            stop = min(int(np.searchsorted(t, t[start] + horizon, side="left")), int(last[start]))
            if stop < last[start]:
                stop = _clear_of_turns(turns, start, stop)
                # nothing is left behind that is too short to be a window of its own
                stop = int(last[start]) if last[start] - stop < FEWEST else stop
            found.append(Window(start, stop, *(float(y[start]) for y in (t, x, v, x_sd, v_sd))))
            start = stop
        return Windows(tuple(found), t, v)
