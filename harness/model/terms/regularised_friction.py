"""Friction that is smoothed over a speed: no stick, creep, reversal ahead of v = 0."""

from harness.core.arrays import FloatArray
from harness.model.law import D_FREE, D_LEVEL, D_PARAMETER, D_V, VALUE
from harness.model.term import Evidence, Extent, Parameter, Place, Probe, Seen, Slot, Term


def law(v: float, a: float, level: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """f_k sat((v + lead a0)/v_r), a0 the acceleration without friction: clipped, as MuJoCo's friction loss is."""
    v_r, lead = theta[o], theta[o + 1]
    ratio = (v + lead * a) / v_r
    if abs(ratio) >= 1.0:
        side = 1.0 if ratio > 0.0 else -1.0
        out[VALUE] = level * side
        out[D_LEVEL] = side
        return
    slope = level / v_r
    out[VALUE] = level * ratio
    out[D_V] = slope
    out[D_FREE] = slope * lead
    out[D_LEVEL] = ratio
    out[D_PARAMETER] = -level * ratio / v_r
    out[D_PARAMETER + 1] = slope * a


def probes(e: Evidence) -> list[Probe]:
    """Speeds at fractions of the largest one, with the lead that a soft constraint gives and without."""
    speeds = (0.003, 0.01, 0.03, 0.1)
    lead: list[Probe] = [(f * e.v_scale, f * e.v_scale / e.f_k * 0.9) for f in speeds] if e.f_k > 0.0 else []
    return [(f * e.v_scale, 0.0) for f in speeds] + lead


def place(values: Probe, seen: Seen) -> Place:
    """Where friction is below its level."""
    return Place("low-speed", f"|v| < {values[0]:.3g} m/s", seen.whole)


def near_rest(values: Probe, extent: Extent) -> bool:
    """What is smoothed over more than half of all speeds is a damper's shape."""
    return values[0] <= 0.5 * extent.speed


TERM = Term(
    "regularised-friction",
    "friction",
    Slot.FRICTION_LAW,
    (Parameter("v_r", "m/s", 0.0, positive=True), Parameter("lead", "s", 0.0)),
    "Friction is smoothed over speeds below {v_r} and reverses {lead} ahead of the speed: it creeps and never sticks.",
    law,
    probes,
    example=(0.6, 0.02),
    corner=True,
    place=place,
    as_named=near_rest,
    steps_alike=True,
    taken=0.07,
    in_python="clip((v + lead * a) / v_r, -1.0, 1.0)",
    order=40,
)
