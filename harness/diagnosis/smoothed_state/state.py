"""The smoothed course of a driven recording, a base model from its inverse dynamics, and windows that start on it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

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
_KERNEL, _REACH, _EVEN = 2.0, 10, 1e-3
"""Samples: width and reach of a kernel that passes all signals alike; and by which share steps may differ for it."""
_LONG = 4 * _REACH
"""Samples, beside the fewest, of which half have whole kernels."""
_FEW = 24.0
"""Samples a period, from which on a cubic over nine takes less than a tenth off a bend."""
_BENDS = 2, 3
"""Powers of a displacement by which a spring bends."""
_CLEARER = 0.25
"""Share of the squares that smoothing leaves, below which signals that are filtered alike tell the force better."""
_LEAST = 1e-3
"""Share that a parameter which must not vanish is given where least squares makes it negative."""


State: TypeAlias = tuple[FloatArray, FloatArray, FloatArray]
"""x, v, a (n,), smoothed."""


def state_of(t: FloatArray, smooth: Mapping[str, Smooth]) -> State:
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


def told_by(t: FloatArray, x: FloatArray, u: FloatArray, state: State) -> tuple[State, FloatArray]:
    """The state and the force, (n,) each, that a regression of a force u (n,) on x (n,) and its slopes is made of.

    A cubic takes a share off a bend that grows with its frequency: over nine samples half, of a motion of as many a
    period, which near resonance passes for another mass and no spring. Signals that one kernel, its slope and its bend
    have passed keep what stands between them, whatever it takes off (Shinbrot 1957, Trans. ASME 79, 547). They are
    taken where they leave decidedly less, of a force as it is at its samples or held from each to the next; less the
    square and the cube that a spring bends by, if they take decidedly more.
    """
    step = np.diff(t)
    turns = float(np.std(state[1])) * float(np.mean(step)) * _FEW >= 2.0 * math.pi * float(np.std(state[0]))
    if not turns or t.size < _LONG + _FEWEST or np.ptp(step) > _EVEN * float(np.mean(step)):
        return state, u
    at, h = np.arange(-_REACH, _REACH + 1) / _KERNEL, _KERNEL * float(np.mean(step))
    kernel = np.exp(-0.5 * at**2) / np.sum(np.exp(-0.5 * at**2))
    passed = [np.convolve(x, one, "valid") for one in (kernel, -at * kernel / h, (at**2 - 1.0) * kernel / h**2)]
    alike = passed[0], passed[1], passed[2]
    bends = np.column_stack([np.convolve((x - np.mean(x)) ** power, kernel, "valid") for power in _BENDS])
    # around a sample a force that is held is as before it and after it for half a step each
    acts = (u, np.concatenate((u[:1], 0.5 * (u[1:] + u[:-1]))))
    forces = [np.convolve(one, kernel, "valid") for one in acts]
    ways = [(*_left_of(alike, one, bends), one) for one in forces]
    left, factors, force = min(ways, key=lambda way: float(way[0] @ way[0]))
    powers = np.column_stack([(state[0] - np.mean(state[0])) ** power for power in _BENDS])
    usual = np.convolve(_left_of(state, u, powers)[0], kernel, "valid")
    if left @ left >= _CLEARER * (usual @ usual):
        return state, u
    plain, _ = _left_of(alike, force, bends[:, :0])
    return alike, force - bends @ factors if left @ left < _CLEARER * (plain @ plain) else force


def _left_of(state: State, u: FloatArray, others: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What a spring, viscous and Coulomb friction and others (n, q) leave of a force (n,), and their factors (q,)."""
    x, v, a = state
    table = np.column_stack([a, v, x, np.sign(v), np.ones_like(v), others])
    size = np.sqrt(np.mean(table**2, axis=0)) + 1e-300
    found = np.linalg.lstsq(table / size, u, rcond=None)[0] / size
    return u - table @ found, found[table.shape[1] - others.shape[1] :]


def inverse_start(state: State, u: FloatArray, restoring: Restoring, mass: float | None, zero_free: bool) -> Model:
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
    state: State
    longest: float

    @classmethod
    def of(cls, t: FloatArray, channels: Mapping[str, FloatArray], noise: Mapping[str, Noise]) -> "Course":
        """From position, speed or both, over no gap."""
        longest = longest_interval(t)
        smooth = {c: smoothed(t, channels[c], longest, noise[c].sigma) for c in ("x", "v") if c in channels}
        return cls(t, smooth, state_of(t, smooth), longest)

    def where(self, side: FloatArray) -> "Course":
        """With no speed where its first samples do not move to the side (m,) that is known: 1, -1, or 0 at rest."""
        x, v, a = self.state
        moves = np.ones(v.size, dtype=np.bool_)
        moves[: side.size] = np.sign(v[: side.size]) == side
        return replace(self, state=(x, np.where(moves, v, 0.0), a))

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
