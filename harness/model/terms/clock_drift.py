"""A recording's clock whose rate drifts: to one channel what a drift of stiffness is."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.term import Parameter, Probe, Sensor, Shown, Slot, Term, always


def read(values: Probe, t: FloatArray, y: FloatArray, rate: FloatArray) -> Shown:
    """x(t + rate t^2/2)."""
    return Shown(y + 0.5 * values[0] * t**2 * rate, np.ones(t.size), (0.5 * t**2 * rate,))


TERM = Term(
    "clock-drift",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("rate", "1/s", none=0.0),),
    "The clock of the recording drifts: its rate changes by {rate}.",
    needs=("one-clock",),
    example=(-2e-3,),
    place=always("late", "in proportion to t"),
    sensor=Sensor("x", read),
    searched=False,
    order=182,
)
"""Not looked for by itself: it is listed beside a stiffness that drifts."""
