"""The accelerometer's scale is off."""

from harness.model.evidence import Evidence
from harness.model.term import Parameter, Probe, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Linear: one look."""
    return [(1.0,)]


TERM = Term(
    "sensor-gain",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("gain", "1", none=1.0),),
    "The acceleration is scaled by {gain}: its calibration (or the time base) does not match the displacement.",
    probes=probes,
    amplitude=0,
    channels=("x", "a"),
)
