"""The accelerometer's scale is off."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.term import Parameter, Probe, Sensor, Shown, Slot, Term, always


def read(values: Probe, t: FloatArray, y: FloatArray, place: FloatArray) -> Shown:
    """a is multiplied by the gain."""
    return Shown(values[0] * y, np.full(t.size, values[0]), (y,))


TERM = Term(
    "sensor-gain",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("gain", "1", none=1.0),),
    "The acceleration is scaled by {gain}: its calibration (or the time base) does not match the displacement.",
    amplitude=0,
    channels=("x", "a"),
    example=(1.05,),
    place=always("channel", "channel a"),
    sensor=Sensor("a", read),
    steps_alike=True,
    order=250,
)
