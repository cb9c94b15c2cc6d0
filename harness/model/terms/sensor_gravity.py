"""The accelerometer tilts with the motion, so that gravity has a part in what it reads."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.term import Parameter, Probe, Sensor, Shown, Slot, Term, always


def read(values: Probe, t: FloatArray, y: FloatArray, place: FloatArray) -> Shown:
    """a gains per_place x; of a pendulum of length L, per_place = g/L."""
    return Shown(y + values[0] * place, np.ones(t.size), (place,), by_place=np.full(t.size, values[0]))


TERM = Term(
    "sensor-gravity",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("per_place", "1/s^2", none=0.0),),
    "The accelerometer tilts with the motion: gravity adds {per_place} times the displacement to what it reads.",
    amplitude=0,
    channels=("x", "a"),
    example=(10.0,),
    place=always("large-displacement", "in proportion to x"),
    sensor=Sensor("a", read),
    steps_alike=True,
    order=245,
)
