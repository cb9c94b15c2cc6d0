"""Presliding displacement of a bristle (Dahl; with Stribeck: LuGre)."""

from harness.core.arrays import FloatArray
from harness.model.bristles import bent
from harness.model.law import D_INTERNAL, D_LEVEL, D_PARAMETER, D_V, VALUE
from harness.model.term import REST, Evidence, Parameter, Probe, Slot, Term, always


def law(v: float, side: int, z: float, level: float, theta: FloatArray, o: int, out: FloatArray) -> None:
    """z' = v - sigma0 |v| z/f_k, f = sigma0 z + sigma1 z' (Dahl: sigma1 = 0; with stribeck: LuGre)."""
    sigma0, sigma1 = theta[o], theta[o + 1]
    speed = max(side * v, 0.0)
    pull = sigma0 * speed * z / level
    rate, by_v = v - pull, 1.0 - sigma0 * side * z / level
    by_z, by_level = -sigma0 * speed / level, pull / level
    out[1, VALUE] = rate
    out[1, D_V] = by_v
    out[1, D_LEVEL] = by_level
    out[1, D_PARAMETER] = -speed * z / level
    out[1, D_INTERNAL] = by_z
    out[0, VALUE] = sigma0 * z + sigma1 * rate
    out[0, D_V] = sigma1 * by_v
    out[0, D_LEVEL] = sigma1 * by_level
    out[0, D_PARAMETER] = z - sigma1 * speed * z / level
    out[0, D_PARAMETER + 1] = rate
    out[0, D_INTERNAL] = sigma0 + sigma1 * by_z


def probes(e: Evidence) -> list[Probe]:
    """Bristles that give by a few to a few tens of per cent of the displacement under f_k."""
    k = e.k if e.k > 0.0 else e.f_k / e.x_scale
    return [(ratio * k, damping * (ratio * k) ** 0.5) for ratio in (2.0, 6.0, 18.0) for damping in (0.0, 0.3)]


TERM = Term(
    "presliding",
    "friction",
    Slot.FRICTION_LAW,
    (Parameter("sigma0", "N/m", 0.0, positive=True, springs=1e4, bends=True), Parameter("sigma1", "N s/m", 0.0)),
    "Friction builds up over a presliding displacement (bristle): sigma0 = {sigma0}, sigma1 = {sigma1}.",
    law,
    probes,
    internal=1,
    needs=("returns",),
    example=(2000.0, 5.0),
    corner=True,
    implied=bent(yields=False),
    place=always("reversal", "after each reversal, until the bristles slide"),
    told_from={"regularised-friction": REST},
    taken=0.1,
    in_python="sigma0 * z + sigma1 * (v - sigma0 * abs(v) * z / level)",
    order=30,
)
