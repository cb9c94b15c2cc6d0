"""Friction that is smoothed over a speed: no stick, creep, reversal ahead of v = 0."""

from harness.model.evidence import Evidence
from harness.model.term import Parameter, Probe, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Speeds at fractions of the largest one, with the lead that a soft constraint gives and without."""
    speeds = (0.003, 0.01, 0.03, 0.1)
    lead: list[Probe] = [(f * e.v_scale, f * e.v_scale / e.f_k * 0.9) for f in speeds] if e.f_k > 0.0 else []
    return [(f * e.v_scale, 0.0) for f in speeds] + lead


TERM = Term(
    "regularised-friction",
    "friction",
    Slot.FRICTION_LAW,
    (Parameter("v_r", "m/s", 0.0, positive=True), Parameter("lead", "s", 0.0)),
    "Friction is smoothed over speeds below {v_r} and reverses {lead} ahead of the speed: it creeps and never sticks.",
    probes=probes,
)
