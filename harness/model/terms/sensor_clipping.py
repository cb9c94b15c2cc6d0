"""The accelerometer saturates."""

from harness.model.evidence import Evidence
from harness.model.term import Parameter, Probe, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Levels below the largest recorded acceleration."""
    return [(f * e.peak_a,) for f in (0.995, 0.97, 0.9, 0.8)]


TERM = Term(
    "sensor-clipping",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("limit", "m/s^2", 0.0, positive=True),),
    "The acceleration saturates at {limit}.",
    probes=probes,
    channels=("a",),
)
