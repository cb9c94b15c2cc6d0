"""The displacement sensor is late."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.term import Parameter, Probe, Sensor, Shown, Slot, Term, always


def read(values: Probe, t: FloatArray, y: FloatArray, rate: FloatArray) -> Shown:
    """x is recorded late against a."""
    return Shown(y, np.ones(t.size), (-rate,))


TERM = Term(
    "sensor-lag",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("lag", "s", none=0.0),),
    "The displacement is recorded {lag} late against the acceleration.",
    amplitude=0,
    channels=("x", "a"),
    example=(2e-3,),
    place=always("channel", "channel x"),
    sensor=Sensor("x", read, delays=True),
    steps_alike=True,
    order=240,
)
