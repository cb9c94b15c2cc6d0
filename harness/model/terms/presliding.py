"""Presliding displacement of a bristle (Dahl; with Stribeck: LuGre)."""

import math

import numpy as np

from harness.core.arrays import FloatArray, read_only
from harness.core.jit import compiled
from harness.model.law import D_INTERNAL, D_LEVEL, D_PARAMETER, D_V, VALUE
from harness.model.term import REST, Evidence, History, Parameter, Probe, Slot, States, Term, always


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


@compiled
def _bend(t: FloatArray, v: FloatArray, at: FloatArray, sigma0: float, level: float, out: FloatArray) -> None:
    """z along the recorded way and its partials by sigma0 and f_k at the times ``at`` (m,); out (m, 3).

    Along a way s in one direction z nears side f_k/sigma0 as exp(-sigma0 s/f_k), whatever the speed (Dahl 1968).
    Bristles are fully bent at first, in the direction of the first motion.
    """
    ends = level / sigma0
    z, by_sigma, by_level = 0.0, 0.0, 0.0
    for k in range(v.size):
        if v[k] != 0.0:
            side = 1.0 if v[k] > 0.0 else -1.0
            z, by_sigma, by_level = side * ends, -side * ends / sigma0, side / sigma0
            break
    i = 0
    for j in range(at.size):
        while i + 1 < t.size and t[i + 1] <= at[j]:
            way = 0.5 * (v[i] + v[i + 1]) * (t[i + 1] - t[i])
            side = 1.0 if way > 0.0 else -1.0
            share = side * way / ends
            fade = math.exp(-share)
            gap = z - side * ends
            by_sigma = fade * (by_sigma - gap * share / sigma0) - (1.0 - fade) * side * ends / sigma0
            by_level = fade * (by_level + gap * share / level) + (1.0 - fade) * side / sigma0
            z = side * ends + gap * fade
            i += 1
        out[j, 0], out[j, 1], out[j, 2] = z, by_sigma, by_level


def bent(values: Probe, motion: History) -> States:
    """As the recorded way has bent them, fully at first."""
    sigma0, level = values[0], motion.f_k
    if sigma0 <= 0.0 or level <= 0.0:
        return States(np.zeros((motion.at.size, 1)))
    found = np.zeros((motion.at.size, 3))
    _bend(read_only(motion.t), read_only(motion.v), read_only(motion.at), sigma0, level, found)
    return States(found[:, :1], {0: found[:, 1:2], "f_k": found[:, 2:]})


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
    implied=bent,
    place=always("reversal", "after each reversal, until the bristles slide"),
    told_from={"regularised-friction": REST},
    taken=0.1,
    in_python="sigma0 * z + sigma1 * (v - sigma0 * abs(v) * z / level)",
    order=30,
)
