"""The displacement sensor is late."""

from harness.model.evidence import Evidence
from harness.model.term import Parameter, Probe, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Linear: one look."""
    return [(0.0,)]


TERM = Term(
    "sensor-lag",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("lag", "s", none=0.0),),
    "The displacement is recorded {lag} late against the acceleration.",
    probes=probes,
    amplitude=0,
    channels=("x", "a"),
)
