"""What the sensors of a model would have shown of a motion from any origin."""

from collections.abc import Collection

from harness.core.arrays import FloatArray
from harness.core.trajectory import Trajectory
from harness.diagnosis.sensors.readings import lag_of, read
from harness.diagnosis.sensors.resample import motion_at
from harness.model.model import Model


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
