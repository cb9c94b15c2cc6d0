"""What the sensors of a model make of a motion: slot O, composed, with partials.

Each sensor's law stands in its term's file. ``read`` is the composition; harness.diagnosis.fit.observe reads the
reference through it, with partials, and ``sensed`` a motion from any origin.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.trajectory import Trajectory
from harness.diagnosis.sensors.resample import Kinematics, motion_at
from harness.kernels.solve import By
from harness.model.model import Model


@dataclass(frozen=True, slots=True)
class Reading:
    """A channel as it is shown, y (n,); by_motion (n,) : its partial by the true value. by : partials (n,) by the
    parameters of sensors, and by the offset of x.
    """

    y: FloatArray
    by_motion: FloatArray
    by: Mapping[By, FloatArray] = field(default_factory=dict)


def lag_of(model: Model) -> float:
    """By how much x is late against a, s."""
    sensors = [(entry.term.sensor, entry.values) for entry in model.terms]
    return sum((values[0] for sensor, values in sensors if sensor is not None and sensor.delays), 0.0)


def read(
    model: Model, t: FloatArray, true: Kinematics, late: Kinematics, channels: Collection[str]
) -> dict[str, Reading]:
    """Channels ("x", "v", "a") at times t (n,), s, as the sensors of a model show them.

    true : the motion at these times. late : the same the lag of x before. x is measured from the sensor's zero.
    """
    shown: dict[str, Reading] = {}
    if "x" in channels:
        shown["x"] = _through(model, "x", t, model.offset + late.x, late.v, {"offset": np.ones(t.size)})
    if "v" in channels:
        shown["v"] = Reading(true.v, np.ones(t.size))
    if "a" in channels:
        shown["a"] = _through(model, "a", t, true.a, np.zeros(t.size), {})
    return shown


def _through(
    model: Model,
    channel: Literal["x", "a"],
    t: FloatArray,
    y: FloatArray,
    rate: FloatArray,
    by: Mapping[By, FloatArray],
) -> Reading:
    """A channel through its sensors, one after another; by : partials that it comes with."""
    by_motion = np.ones(t.size)
    order = sorted(range(len(model.terms)), key=lambda i: model.terms[i].term.order)
    for i in order:
        sensor = model.terms[i].term.sensor
        if sensor is None or sensor.channel != channel:
            continue
        shown = sensor.read(model.terms[i].values, t, y, rate)
        y, by_motion = shown.y, by_motion * shown.by_y
        through = {b: partials * shown.by_y for b, partials in by.items()}
        by = through | {(i, j): partials for j, partials in enumerate(shown.by)}
    return Reading(y, by_motion, by)


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
