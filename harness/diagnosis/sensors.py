"""What the sensors of a model would have shown of a motion from any origin: slot O, composed per channel.

harness.diagnosis.observe does the same for the reference, with partials.
"""

from collections.abc import Collection

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.trajectory import Trajectory
from harness.diagnosis.resample import motion_at
from harness.model.model import Model


def sensed(model: Model, t: FloatArray, motion: Trajectory, channels: Collection[str]) -> dict[str, FloatArray]:
    """Channels ("x", "v", "a") as the sensors of ``model`` show them at times t (s), each of shape (n,).

    motion : in time since release, which is at model.t0; before it the slider is held. x : late by the lag, then
    drifting, counted from the sensor's zero. a : scaled, shifted, then cut off.
    """
    since = t - model.t0
    true = motion_at(motion, since)
    shown: dict[str, FloatArray] = {}
    if "x" in channels:
        lag = _value(model, "sensor-lag", 0.0)
        late = true.x if lag == 0.0 else motion_at(motion, since - lag).x
        shown["x"] = model.offset + late + _value(model, "sensor-drift", 0.0) * t
    if "v" in channels:
        shown["v"] = true.v
    if "a" in channels:
        limit = _value(model, "sensor-clipping", np.inf)
        scaled = _value(model, "sensor-gain", 1.0) * true.a + _value(model, "sensor-bias", 0.0)
        shown["a"] = np.clip(scaled, -limit, limit)
    return shown


def latest(model: Model, t: FloatArray) -> float:
    """Time after release (s) up to which a motion is needed to be sensed at times t; an early x needs more."""
    return float(t[-1]) - model.t0 + max(0.0, -_value(model, "sensor-lag", 0.0))


def _value(model: Model, name: str, otherwise: float) -> float:
    """The parameter of a sensor, which has one, or what stands for its absence."""
    entry = model.find(name)
    return otherwise if entry is None else entry.values[0]
