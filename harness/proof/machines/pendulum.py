"""A pendulum with viscous and Coulomb friction, stepped from reversal to reversal: the base fit of the plant's side.

The classical Runge-Kutta rule at a fixed step; between steps a cubic through x and v. Its error is a slightly other
frequency, which a fit takes up.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.jit import compiled

STEPS = 64
"""A period of small swings."""
MOST_STEPS = 2_000_000
"""Beyond which a fit has gone astray."""
_HALVINGS = 45


def swing(
    t: FloatArray, omega_n: float, zeta: float, x_k: float, x0: float, v0: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """x (rad), v (rad/s), a (rad/s^2), shape (n,), of x'' + 2 zeta omega_n x' + omega_n^2 (sin x + x_k sgn x') = 0.

    t : s, shape (n,), increasing; x0, v0 at t = 0. Raises SimulationError beyond ``MOST_STEPS``.
    """
    c, w2 = 2.0 * abs(zeta) * omega_n, omega_n**2
    longest, end = 2.0 * math.pi / (abs(omega_n) * STEPS), float(t[-1])
    # no swing has more reversals than twice the periods of the smallest ones
    steps = (1.0 + 4.0 / STEPS) * end / longest
    if not steps < MOST_STEPS:
        raise SimulationError(f"machines: a pendulum of {abs(omega_n):.3g} rad/s over {end:.3g} s")
    room = np.empty((4, int(steps) + 8))
    count = _knots(end, c, w2, w2 * abs(x_k), x0, v0, longest, room)
    at, x, v, f = room[:, :count]
    i = np.clip(np.searchsorted(at, t, side="right") - 1, 0, count - 2)
    h = at[i + 1] - at[i]
    s = (t - at[i]) / h
    r = 1.0 - s
    place = r**2 * ((1.0 + 2.0 * s) * x[i] + s * h * v[i]) + s**2 * ((1.0 + 2.0 * r) * x[i + 1] - r * h * v[i + 1])
    speed = 6.0 * s * r * (x[i + 1] - x[i]) / h + r * (1.0 - 3.0 * s) * v[i] + s * (1.0 - 3.0 * r) * v[i + 1]
    still = (v[i] == 0.0) & (v[i + 1] == 0.0)
    return place, speed, np.where(still, 0.0, -c * speed - w2 * np.sin(place) - f[i])


@compiled
def _step(x: float, v: float, f: float, h: float, c: float, w2: float) -> tuple[float, float, float]:
    """x and v after h, and the acceleration at its start, friction f held."""
    half = 0.5 * h
    a1 = -c * v - w2 * math.sin(x) - f
    v2 = v + half * a1
    a2 = -c * v2 - w2 * math.sin(x + half * v) - f
    v3 = v + half * a2
    a3 = -c * v3 - w2 * math.sin(x + half * v2) - f
    v4 = v + h * a3
    a4 = -c * v4 - w2 * math.sin(x + h * v3) - f
    return x + h * (v + 2.0 * (v2 + v3) + v4) / 6.0, v + h * (a1 + 2.0 * (a2 + a3) + a4) / 6.0, a1


@compiled
def _zero(v: float, new_v: float, rise: float, new_rise: float) -> float:
    """Where the cubic through values and slopes of both ends is zero, as a share of the step."""
    lo, hi = 0.0, 1.0
    for _ in range(_HALVINGS):
        s = 0.5 * (lo + hi)
        r = 1.0 - s
        value = r * r * ((1.0 + 2.0 * s) * v + s * rise) + s * s * ((1.0 + 2.0 * r) * new_v - r * new_rise)
        if (value > 0.0) == (v > 0.0):
            lo = s
        else:
            hi = s
    return hi


@compiled
def _knots(
    end: float, c: float, w2: float, level: float, x0: float, v0: float, longest: float, room: FloatArray
) -> int:
    """Fill ``room`` (t, x, v, friction from there on) with steps up to ``end`` (s); how many."""
    at, x, v, count = 0.0, x0, v0, 0
    while count < room.shape[1] - 2:
        resting = v == 0.0 and w2 * abs(math.sin(x)) <= level
        d = math.copysign(1.0, v) if v != 0.0 else -math.copysign(1.0, math.sin(x))
        f = 0.0 if resting else level * d
        room[0, count], room[1, count], room[2, count], room[3, count] = at, x, v, f
        count += 1
        if resting:
            room[0, count], room[1, count], room[2, count], room[3, count] = max(end, at) + longest, x, 0.0, 0.0
            return count + 1
        if at > end:
            return count
        h = longest
        new_x, new_v, rise = _step(x, v, f, h, c, w2)
        if new_v * d < 0.0 and v != 0.0:
            h *= _zero(v, new_v, h * rise, h * (-c * new_v - w2 * math.sin(new_x) - f))
            new_x, new_v, rise = _step(x, v, f, h, c, w2)
            new_v = 0.0
        at, x, v = at + h, new_x, new_v
    room[0, count], room[1, count], room[2, count], room[3, count] = max(end, at) + longest, x, v, 0.0
    return count + 1
