"""Bristles that give way before they slide: by which law they near their full deflection, and how a way bends them."""

import math

import numpy as np

from harness.core.arrays import FloatArray, read_only
from harness.core.jit import compiled, lean
from harness.model.law import D_INTERNAL, D_LEVEL, D_PARAMETER, D_V, VALUE
from harness.model.term import History, Implied, Probe, States

_SETTLES = 0.01
"""Share of the full deflection from which bristles near it in proportion, whatever the exponent: a root would end."""
_CLOSE = 1e-6
"""Share below which a series says what a difference of two like numbers would lose."""


@lean
def nearing(q: float, p: float) -> tuple[float, float, float]:
    """(1 - w)^(p-1) of q = 1 - w, steady close to 0, and the partials of its logarithm by q and p (Dahl 1968)."""
    q2 = q * q + _SETTLES * _SETTLES
    by_p = 0.5 * math.log(q2)
    return math.exp((p - 1.0) * by_p), (p - 1.0) * q / q2, by_p


@lean
def yielding(q: float, n: float) -> tuple[float, float, float]:
    """(1 - w^n)/(1 - w) of q = 1 - w, 1/q below w = 0, and the partials of its logarithm by q and n (Bouc, Wen)."""
    if q >= 1.0:
        return 1.0 / q, -1.0 / q, 0.0
    if abs(q) < _CLOSE:
        return n * (1.0 - 0.5 * (n - 1.0) * q), -0.5 * (n - 1.0), 1.0 / n
    fallen = math.log1p(-q)
    left, grown = -math.expm1(n * fallen), math.exp(n * fallen)
    return left / q, n * grown / ((1.0 - q) * left) - 1.0 / q, -grown * fallen / left


@lean
def bristle(
    v: float, side: int, z: float, level: float, theta: FloatArray, o: int, q: float, pace: float, by_q: float,
    by_shape: float, out: FloatArray,
) -> None:  # fmt: skip
    """z' = v q pace, f = sigma0 z + sigma1 z' of bristles that lack a share q of their full deflection.

    by_q, by_shape : partials of the logarithm of ``pace`` by q and by the third parameter.
    """
    sigma0, sigma1 = theta[o], theta[o + 1]
    along, gained = side * max(side * v, 0.0), q * pace
    bend = along * pace * (1.0 + q * by_q)
    out[1, VALUE] = v + along * (gained - 1.0)
    out[1, D_V] = gained
    out[1, D_LEVEL] = bend * (1.0 - q) / level
    out[1, D_PARAMETER] = -bend * side * z / level
    out[1, D_PARAMETER + 2] = along * gained * by_shape
    out[1, D_INTERNAL] = -bend * side * sigma0 / level
    out[0, VALUE] = sigma0 * z + sigma1 * out[1, VALUE]
    out[0, D_V] = sigma1 * gained
    out[0, D_LEVEL] = sigma1 * out[1, D_LEVEL]
    out[0, D_PARAMETER] = z + sigma1 * out[1, D_PARAMETER]
    out[0, D_PARAMETER + 1] = out[1, VALUE]
    out[0, D_PARAMETER + 2] = sigma1 * out[1, D_PARAMETER + 2]
    out[0, D_INTERNAL] = sigma0 + sigma1 * out[1, D_INTERNAL]


@compiled
def _bend(
    t: FloatArray, v: FloatArray, at: FloatArray, sigma0: float, level: float, shape: float, yields: bool,
    out: FloatArray,
) -> None:  # fmt: skip
    """z along the recorded way and its partials by sigma0, the shape and f_k at the times ``at`` (m,); out (m, 4).

    What is lacking fades along the way, whatever the speed, by steps that are exact where it fades in proportion: with
    an exponent of one as exp(-sigma0 s/f_k) along a way s in one direction (Dahl 1968). Bristles are fully bent at
    first, in the direction of the first motion.
    """
    rate = sigma0 / level
    q, side, by_rate, by_shape = 1.0, 0.0, 0.0, 0.0
    for k in range(v.size):
        if v[k] != 0.0:
            q, side = 0.0, 1.0 if v[k] > 0.0 else -1.0
            break
    i = 0
    for j in range(at.size):
        while i + 1 < t.size and t[i + 1] <= at[j]:
            way = 0.5 * (v[i] + v[i + 1]) * (t[i + 1] - t[i])
            i += 1
            if way * side < 0.0:
                q, side, by_rate, by_shape = 2.0 - q, -side, -by_rate, -by_shape
            way *= side
            middle, m_rate, m_shape = q, by_rate, by_shape
            for part in (0.5 * way, way):
                # by half a step to where the second, whole one takes its pace
                pace, by_q, by_own = yielding(middle, shape) if yields else nearing(middle, shape)
                fade = math.exp(-rate * pace * part)
                lost = rate * pace * part * q * fade
                middle = q * fade
                m_rate = fade * by_rate - lost * (1.0 / rate + by_q * m_rate)
                m_shape = fade * by_shape - lost * (by_own + by_q * m_shape)
            q, by_rate, by_shape = middle, m_rate, m_shape
        bent = side * (1.0 - q) / rate
        by = (-bent - side * by_rate) / rate
        out[j, 0], out[j, 1], out[j, 2], out[j, 3] = bent, by / level, -side * by_shape / rate, -by * rate / level


def bent(yields: bool) -> Implied:
    """Bristles as the recorded way has bent them, fully at first; of values without a shape as Dahl's first are.

    yields : by ``yielding``, and not by ``nearing``.
    """

    def states(values: Probe, motion: History) -> States:
        sigma0, level, shape = values[0], motion.f_k, values[2] if len(values) > 2 else 1.0
        if sigma0 <= 0.0 or level <= 0.0:
            return States(np.zeros((motion.at.size, 1)))
        found = np.zeros((motion.at.size, 4))
        t, v, at = (read_only(y) for y in (motion.t, motion.v, motion.at))
        _bend(t, v, at, sigma0, level, shape, yields, found)
        by: dict[int | str, FloatArray] = {0: found[:, 1:2], "f_k": found[:, 3:]}
        return States(found[:, :1], by | ({2: found[:, 2:3]} if len(values) > 2 else {}))

    return states
