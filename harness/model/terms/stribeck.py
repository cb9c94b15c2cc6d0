"""Friction that falls with speed: f_k + (f_s - f_k) exp(-(v/v_s)^2), break-away at f_s."""

from harness.model.evidence import Evidence
from harness.model.term import Parameter, Probe, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Linear in f_s - f_k; Stribeck speeds at fractions of the largest speed."""
    return [(e.f_k, f * e.v_scale) for f in (0.02, 0.05, 0.1, 0.2, 0.4, 0.7)]


TERM = Term(
    "stribeck",
    "friction",
    Slot.FRICTION_LEVEL,
    (Parameter("f_s", "N", 0.0), Parameter("v_s", "m/s", 0.0, positive=True)),
    "Friction changes with speed (Stribeck): from f_s = {f_s} at rest to f_k, over v_s = {v_s}.",
    probes=probes,
    amplitude=0,
)
