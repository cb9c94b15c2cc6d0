"""The accelerometer has an offset."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.term import Parameter, Probe, Sensor, Shown, Slot, Term, always


def read(values: Probe, t: FloatArray, y: FloatArray, place: FloatArray) -> Shown:
    """a has the bias added."""
    return Shown(y + values[0], np.ones(t.size), (np.ones(t.size),))


TERM = Term(
    "sensor-bias",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("bias", "m/s^2", none=0.0),),
    "The acceleration has a constant {bias} added.",
    amplitude=0,
    channels=("a",),
    example=(0.5,),
    place=always("channel", "channel a"),
    sensor=Sensor("a", read),
    steps_alike=True,
    order=260,
)
