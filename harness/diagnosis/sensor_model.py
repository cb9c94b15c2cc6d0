"""What the sensors of a model make of a motion: slot O, composed, with partials.

Each sensor's law stands in its term's file. ``read`` is the composition; harness.diagnosis.problems.simulated reads the
reference through it, with partials, and ``sensed`` a motion from any origin.

A simulated motion at the times of a recording, faithful to jumps of the acceleration at reversals.
"""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.recording import Recording
from harness.core.trajectory import Source, Trajectory
from harness.kernels.solve import By
from harness.model.model import Model


@dataclass(frozen=True, slots=True)
class Kinematics:
    """Position (m), speed (m/s) and acceleration (m/s^2) at some times; all of shape (n,)."""

    x: FloatArray
    v: FloatArray
    a: FloatArray


_STILL = 1e-7
"""Of the largest speed: slower than this is rest."""


def motion_at(trajectory: Trajectory, t: FloatArray) -> Kinematics:
    """The motion of a trajectory at times t (s), in its own time base.

    Position and speed by cubic Hermite polynomials, errors of order dt^4; acceleration by straight lines. Where the
    speed changes sign between two samples friction jumps: there each side is continued to the reversal from its own
    samples, so that no time is shown a mean of before and after. The last sample before a reversal is not asked for its
    acceleration, since a step that ends beyond the reversal is taken with the friction of both sides. Before the first
    sample the slider is held at its start, after the last one it stays.
    """
    s, x = trajectory.t, trajectory.x
    v = np.where(np.abs(trajectory.v) > _STILL * np.max(np.abs(trajectory.v)), trajectory.v, 0.0)
    turning = (v[:-1] * v[1:] <= 0.0) & (v[:-1] != v[1:])
    turning[0] = False  # a release is no reversal
    a, slope = _apart(s, trajectory.a, turning)
    inside = np.minimum(t, s[-1])
    i = np.clip(np.searchsorted(s, inside, side="right") - 1, 0, s.size - 2)
    h = s[i + 1] - s[i]
    into, left = inside - s[i], s[i + 1] - inside
    r = into / h
    position = _hermite(r, h, x[i], v[i], x[i + 1], v[i + 1])
    turns = turning[i]
    before = into <= _reversal(v[i], a[i], v[i + 1], a[i + 1], h)
    from_left = (v[i] + a[i] * into, a[i] + slope[i] * into)
    from_right = (v[i + 1] - a[i + 1] * left, a[i + 1] - slope[i + 2] * left)
    smooth = (_hermite(r, h, v[i], a[i], v[i + 1], a[i + 1]), (1.0 - r) * a[i] + r * a[i + 1])
    speed, acceleration = (
        np.where(turns, np.where(before, one, other), plain)
        for one, other, plain in zip(from_left, from_right, smooth, strict=True)
    )
    held = t < s[0]
    return Kinematics(np.where(held, x[0], position), np.where(held, 0.0, speed), np.where(held, 0.0, acceleration))


def channels_at(trace: Recording, t: FloatArray, names: Iterable[str]) -> dict[str, FloatArray]:
    """Channels (n,) of a trace by name, at times t (s) of its own; with speed and acceleration, jumps are respected."""
    if "v" in trace and "a" in trace:
        x = trace["x"] if "x" in trace else np.zeros(len(trace))
        motion = motion_at(Trajectory(trace.t, x, trace["v"], trace["a"], Source(trace.file)), t)
        every = {"x": motion.x, "v": motion.v, "a": motion.a}
        return {name: every[name] for name in names}
    return {name: np.interp(t, trace.t, trace[name]) for name in names}


def _apart(s: FloatArray, a: FloatArray, turning: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Accelerations (n,) with the last one before each reversal continued from those before it, and slopes (n + 1,).

    slope[i] is that of the interval that ends at sample i; 0 at the ends and where friction jumps.
    """
    slope = np.zeros(s.size + 1)
    slope[1:-1] = np.diff(a) / np.diff(s)
    jumps = np.flatnonzero(turning)
    slope[jumps + 1] = 0.0
    mixed = jumps[jumps >= 2]
    slope[mixed] = slope[mixed - 1]
    a = a.copy()
    a[mixed] = a[mixed - 1] + slope[mixed] * (s[mixed] - s[mixed - 1])
    return a, slope


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


@dataclass(frozen=True, slots=True)
class Reading:
    """A channel as it is shown, y (n,); by_motion (n,) : its partial by the true value, None where it is that. by :
    partials (n,) by the parameters of sensors, and by the offset of x. by_place (n,) : of an acceleration, its partial
    by the true place.
    """

    y: FloatArray
    by_motion: FloatArray | None = None
    by: Mapping[By, FloatArray] = field(default_factory=dict)
    by_place: FloatArray | float = 0.0


def lag_of(model: Model) -> float:
    """By how much x is late against a, s."""
    sensors = [(entry.term.sensor, entry.values) for entry in model.terms]
    return sum((values[0] for sensor, values in sensors if sensor is not None and sensor.delays), 0.0)


def read(
    model: Model, t: FloatArray, true: Kinematics, late: Kinematics, channels: Collection[str]
) -> dict[str, Reading]:
    """Channels ("x", "v", "a") at times t (n,), s, as the sensors of a model show them.

    true : the motion at these times. late : the same the lag of x before. x is measured from the sensor's zero; what
    sensors do to it they do to the place from where the restoring force is nil.
    """
    shown: dict[str, Reading] = {}
    if "x" in channels:
        place = _through(model, "x", t, late.x, late.v)
        shown["x"] = replace(place, y=model.offset + place.y, by={**place.by, "offset": np.ones(t.size)})
    if "v" in channels:
        shown["v"] = Reading(true.v)
    if "a" in channels:
        shown["a"] = _through(model, "a", t, true.a, true.x)
    return shown


def _through(model: Model, channel: Literal["x", "a"], t: FloatArray, y: FloatArray, beside: FloatArray) -> Reading:
    """A channel through its sensors, one after another; beside (n,) : the rate of x, the place for a."""
    reading = Reading(y)
    for i in sorted(range(len(model.terms)), key=lambda i: model.terms[i].term.order):
        sensor = model.terms[i].term.sensor
        if sensor is None or sensor.channel != channel:
            continue
        shown = sensor.read(model.terms[i].values, t, reading.y, beside)
        through = {b: partials * shown.by_y for b, partials in reading.by.items()}
        reading = Reading(
            shown.y,
            shown.by_y if reading.by_motion is None else reading.by_motion * shown.by_y,
            through | {(i, j): partials for j, partials in enumerate(shown.by)},
            reading.by_place * shown.by_y + shown.by_place,
        )
    return reading


def sensed(model: Model, t: FloatArray, motion: Trajectory, channels: Collection[str]) -> dict[str, FloatArray]:
    """Channels ("x", "v", "a") as the sensors of ``model`` show them at times t (s), each of shape (n,).

    motion : in time since release, which is at model.t0; before it the slider is held.
    """
    since, lag = t - model.t0, lag_of(model)
    true = motion_at(motion, since)
    late = true if lag == 0.0 or "x" not in channels else motion_at(motion, since - lag)
    return {c: reading.y for c, reading in read(model, t, true, late, channels).items()}


def latest(model: Model, t: FloatArray) -> float:
    """Time after release (s) up to which a motion is needed to be sensed at times t; an early x needs more."""
    return float(t[-1]) - model.t0 + max(0.0, -lag_of(model))
