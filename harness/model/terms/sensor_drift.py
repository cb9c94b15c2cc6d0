"""The displacement sensor drifts."""

from harness.model.evidence import Evidence
from harness.model.term import Parameter, Probe, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Linear: one look."""
    return [(0.0,)]


TERM = Term(
    "sensor-drift",
    "sensor",
    Slot.OBSERVATION,
    (Parameter("rate", "m/s", none=0.0),),
    "The displacement drifts at {rate}.",
    probes=probes,
    amplitude=0,
    channels=("x",),
)
