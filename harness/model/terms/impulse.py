"""One knock: the speed jumps by impulse/m."""

from harness.model.evidence import Evidence
from harness.model.term import Parameter, Probe, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Linear in the impulse; times at which the residual changes most abruptly."""
    return [(float(time), 0.0) for time in e.knock_times]


TERM = Term(
    "impulse",
    "environment",
    Slot.EVENT,
    (Parameter("time", "s"), Parameter("impulse", "N s", none=0.0)),
    "Something knocked the slider at {time}, with an impulse of {impulse}.",
    probes=probes,
    amplitude=1,
)
