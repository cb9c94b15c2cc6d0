"""The accelerometer saturates."""

import numpy as np

from harness.core.arrays import FloatArray
from harness.model.term import Evidence, Parameter, Place, Probe, Seen, Sensor, Shown, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Levels below the largest recorded acceleration."""
    return [(f * e.peak_a,) for f in (0.995, 0.97, 0.9, 0.8)]


def read(values: Probe, t: FloatArray, y: FloatArray, place: FloatArray) -> Shown:
    """a saturates at the limit."""
    limit = values[0]
    within = np.abs(y) <= limit
    return Shown(np.clip(y, -limit, limit), within.astype(np.float64), (np.where(within, 0.0, np.sign(y)),))


def place(values: Probe, seen: Seen) -> Place:
    """At the limit."""
    inside = np.abs(seen.channels["a"]) >= values[0] * (1.0 - 1e-12)
    return Place("channel", f"|a| at its limit of {values[0]:.4g} m/s^2", seen.where(inside))


TERM = Term(
    "sensor-clipping",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("limit", "m/s^2", 0.0, positive=True),),
    "The acceleration saturates at {limit}.",
    probes=probes,
    channels=("a",),
    example=(30.0,),
    corner=True,
    place=place,
    only_there=True,
    sensor=Sensor("a", read),
    order=280,
)
