"""The displacement sensor drifts."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.evidence import Evidence
from harness.model.place import always
from harness.model.sensor import Sensor, Shown
from harness.model.term import Parameter, Probe, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Linear: one look."""
    return [(0.0,)]


def read(values: Probe, t: FloatArray, y: FloatArray, rate: FloatArray) -> Shown:
    """x gains rate t."""
    return Shown(y + values[0] * t, np.ones(t.size), (t,))


TERM = Term(
    "sensor-drift",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("rate", "m/s", none=0.0),),
    "The displacement drifts at {rate}.",
    probes=probes,
    amplitude=0,
    channels=("x",),
    example=(0.01,),
    place=always("channel", "channel x"),
    sensor=Sensor("x", read),
    taken=0.07,
    order=270,
)
