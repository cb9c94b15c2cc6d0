"""A break-away force above the sliding friction."""

from harness.model.term import SLOW, Evidence, Parameter, Probe, Slot, Term, always


def probes(e: Evidence) -> list[Probe]:
    """Only a recording in which the slider breaks away can show it."""
    return [(1.2 * e.f_k,), (1.6 * e.f_k,)]


TERM = Term(
    "static-friction",
    "friction",
    Slot.BREAK_AWAY,
    (Parameter("f_s", "N", 0.0),),
    "It takes f_s = {f_s} to break away, more than f_k.",
    probes=probes,
    needs=("driven",),
    example=(4.0,),
    place=always("stick", "v = 0"),
    formula="f_s > f_k only at v = 0.",
    told_from={"stribeck": SLOW},
    order=20,
)
