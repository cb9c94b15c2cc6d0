"""What the sensors of a model make of one channel of its motion: slot O, composed, with partials.

The one place where the sensors' laws stand; harness.diagnosis.observe reads the reference through them and
harness.diagnosis.sensors a motion from any origin.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.model import Model


@dataclass(frozen=True, slots=True)
class Reading:
    """A channel as it is shown, y (n,); by_motion (n,) : its partial by the true value. by : partials (n,) by the
    parameter of each sensor term, by name.
    """

    y: FloatArray
    by_motion: FloatArray
    by: Mapping[str, FloatArray] = field(default_factory=dict)


def lag_of(model: Model) -> float:
    """By how much x is late against a, s."""
    return _value(model, "sensor-lag", 0.0)


def read_x(model: Model, t: FloatArray, late_x: FloatArray, late_v: FloatArray) -> Reading:
    """x at times t (n,), s, of a motion that was at late_x with the speed late_v the lag before: drifting, from the
    sensor's zero.
    """
    y = model.offset + late_x + _value(model, "sensor-drift", 0.0) * t
    return Reading(y, np.ones(t.size), {"sensor-lag": -late_v, "sensor-drift": t})


def read_a(model: Model, a: FloatArray) -> Reading:
    """a (n,) scaled, shifted, then cut off."""
    gain, limit = _value(model, "sensor-gain", 1.0), _value(model, "sensor-clipping", np.inf)
    y = gain * a + _value(model, "sensor-bias", 0.0)
    within = np.abs(y) <= limit
    partials = {
        "sensor-gain": np.where(within, a, 0.0),
        "sensor-bias": within.astype(np.float64),
        "sensor-clipping": np.where(within, 0.0, np.sign(y)),
    }
    return Reading(np.clip(y, -limit, limit), np.where(within, gain, 0.0), partials)


def _value(model: Model, name: str, otherwise: float) -> float:
    """The parameter of a sensor, which has one, or what stands for its absence."""
    entry = model.find(name)
    return otherwise if entry is None else entry.values[0]
