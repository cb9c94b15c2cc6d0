"""What the sensors of a model would have shown of a motion from any origin."""

from collections.abc import Collection

from harness.core.arrays import FloatArray
from harness.core.trajectory import Trajectory
from harness.diagnosis.readings import lag_of, read_a, read_x
from harness.diagnosis.resample import motion_at
from harness.model.model import Model


def sensed(model: Model, t: FloatArray, motion: Trajectory, channels: Collection[str]) -> dict[str, FloatArray]:
    """Channels ("x", "v", "a") as the sensors of ``model`` show them at times t (s), each of shape (n,).

    motion : in time since release, which is at model.t0; before it the slider is held.
    """
    since = t - model.t0
    true = motion_at(motion, since)
    shown: dict[str, FloatArray] = {}
    if "x" in channels:
        lag = lag_of(model)
        late = true if lag == 0.0 else motion_at(motion, since - lag)
        shown["x"] = read_x(model, t, late.x, late.v).y
    if "v" in channels:
        shown["v"] = true.v
    if "a" in channels:
        shown["a"] = read_a(model, true.a).y
    return shown


def latest(model: Model, t: FloatArray) -> float:
    """Time after release (s) up to which a motion is needed to be sensed at times t; an early x needs more."""
    return float(t[-1]) - model.t0 + max(0.0, -lag_of(model))
