"""The displacement sensor drifts."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.term import Parameter, Probe, Sensor, Shown, Slot, Term, always


def read(values: Probe, t: FloatArray, y: FloatArray, rate: FloatArray) -> Shown:
    """x gains rate t."""
    return Shown(y + values[0] * t, np.ones(t.size), (t,))


TERM = Term(
    "sensor-drift",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("rate", "m/s", none=0.0),),
    "The displacement drifts at {rate}.",
    amplitude=0,
    channels=("x",),
    example=(0.01,),
    place=always("channel", "channel x"),
    sensor=Sensor("x", read),
    taken=0.07,
    order=270,
)
