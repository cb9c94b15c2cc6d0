"""The accelerometer has an offset."""

from harness.model.evidence import Evidence
from harness.model.term import Parameter, Probe, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Linear: one look."""
    return [(0.0,)]


TERM = Term(
    "sensor-bias",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("bias", "m/s^2", none=0.0),),
    "The acceleration has a constant {bias} added.",
    probes=probes,
    amplitude=0,
    channels=("a",),
)
