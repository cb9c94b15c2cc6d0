"""Presliding displacement of a bristle (Dahl; with Stribeck: LuGre)."""

from harness.model.evidence import Evidence
from harness.model.term import Parameter, Probe, Slot, Term


def probes(e: Evidence) -> list[Probe]:
    """Bristles that give by a few to a few tens of per cent of the displacement under f_k."""
    k = e.k if e.k > 0.0 else e.f_k / e.x_scale
    return [(ratio * k, damping * (ratio * k) ** 0.5) for ratio in (2.0, 6.0, 18.0) for damping in (0.0, 0.3)]


TERM = Term(
    "presliding",
    "friction",
    Slot.FRICTION_LAW,
    (Parameter("sigma0", "N/m", 0.0, positive=True, springs=1e4), Parameter("sigma1", "N s/m", 0.0)),
    "Friction builds up over a presliding displacement (bristle): sigma0 = {sigma0}, sigma1 = {sigma1}.",
    probes=probes,
    internal=1,
)
