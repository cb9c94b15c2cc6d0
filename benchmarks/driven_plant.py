"""A driven slider of this file alone: what a diagnosis of driven recordings is tried on, sharing no law with it.

Fixed steps of Runge and Kutta's fourth order with reversals found inside a step; forces that a controller holds, that
an amplifier follows or that a hand pushes with; effects in published forms that are not the catalogue's.
"""

import math
from collections.abc import Callable
from typing import Any, Final, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
F = TypeVar("F", bound=Callable[..., Any])


def _compiled(f: F) -> F:
    return cast(F, numba.njit(cache=True)(f))


SPRING, PENDULUM, AXIS, PUSHED = "spring", "pendulum", "axis", "pushed"
_FINE: Final = 24
"""Steps from one sample to the next."""
_ELEMENTS: Final = 4
"""Of the bristles: each an elastic spring that slips at its own force."""

# places in the numbers of an effect; each is 0 where there is none
(DRAG, DRAG_V, STRIBECK, STRIBECK_V, STRIBECK_FORM, HARD, HARD_X, COG, COG_L, COG_P, SIDES, SIDES_V, SLOPE, SLOPE_X,
 DIP, DIP_X, WARM, WARM_T, BRISTLE, HUM, HUM_W, PULSE, PULSE_T, PULSE_L, STOP, STOP_X, TILT, CREEP, CREEP_1, CREEP_2,
 SIZE) = range(31)  # fmt: skip


@_compiled
def _dry(x: float, v: float, t: float, f_k: float, p: Array) -> float:
    """Level of dry friction."""
    level = f_k
    if p[STRIBECK] != 0.0:
        s = abs(v) / p[STRIBECK_V]
        if p[STRIBECK_FORM] == 0.0:
            level += p[STRIBECK] / (1.0 + s * s)
        else:
            level += p[STRIBECK] * math.exp(-s)
    if p[SLOPE] != 0.0:
        level += p[SLOPE] * math.tanh(x / p[SLOPE_X])
    if p[DIP] != 0.0:
        level += p[DIP] * (1.0 - math.exp(-((x / p[DIP_X]) ** 2)))
    if p[WARM] != 0.0:
        level -= p[WARM] * (1.0 - math.exp(-t / p[WARM_T]))
    return max(level, 0.0)


@_compiled
def _wet(x: float, v: float, t: float, b: Array, p: Array) -> float:
    """All forces on the left but inertia, dry friction and what is inside."""
    c, k, swings = b[1], b[2], b[4]
    f = c * v + (k * math.sin(x) if swings > 0.0 else k * x)
    if p[DRAG] != 0.0:
        f += p[DRAG] * v * abs(v) / (1.0 + abs(v) / p[DRAG_V])
    if p[HARD] != 0.0:
        f += p[HARD] * (math.sinh(x / p[HARD_X]) - x / p[HARD_X])
    if p[COG] != 0.0:
        phase = 2.0 * math.pi * x / p[COG_L] + p[COG_P]
        f += p[COG] * (math.cos(phase) + 0.3 * math.sin(2.0 * phase))
    if p[SIDES] != 0.0:
        f += p[SIDES] * v * math.tanh(v / p[SIDES_V])
    if p[HUM] != 0.0:
        f -= p[HUM] * math.tanh(1.5 * math.sin(p[HUM_W] * t)) / 0.9
    if p[PULSE] != 0.0 and 0.0 <= t - p[PULSE_T] <= p[PULSE_L]:
        f -= p[PULSE] * math.sin(math.pi * (t - p[PULSE_T]) / p[PULSE_L])
    if p[STOP] != 0.0 and abs(x) > p[STOP_X]:
        f += math.copysign(p[STOP] * (abs(x) - p[STOP_X]) ** 1.5, x)
    if p[TILT] != 0.0:
        f -= p[TILT]
    return float(f)


@_compiled
def _inside(x: float, x0: float, z: Array, f_k: float, p: Array) -> float:
    """Force of bristles that stand at z (N each) where the slider stood at x0."""
    if p[BRISTLE] == 0.0:
        return 0.0
    total = 0.0
    for i in range(_ELEMENTS):
        most = f_k / _ELEMENTS
        stiff = most * (i + 1.0) / p[BRISTLE]
        total += min(max(z[i] + stiff * (x - x0), -most), most)
    return total


@_compiled
def carried(x: Array, dt: float, f_k: float, p: Array) -> Array:
    """Force (n,) of bristles and creep, which remember the way x (n,) that a slider went."""
    found, z, y = np.zeros(x.size), np.zeros(_ELEMENTS), np.zeros(2)
    for i in range(x.size):
        way = x[i] - x[i - 1] if i else 0.0
        if p[BRISTLE] != 0.0:
            found[i] += _inside(x[i], x[i] - way, z, f_k, p)
            for j in range(_ELEMENTS):
                most = f_k / _ELEMENTS
                z[j] = min(max(z[j] + most * (j + 1.0) / p[BRISTLE] * way, -most), most)
        if p[CREEP] != 0.0:
            y[0] = y[0] * math.exp(-dt / p[CREEP_1]) + way
            y[1] = y[1] * math.exp(-dt / p[CREEP_2]) + way
            found[i] += p[CREEP] * (y[0] + 0.5 * y[1])
    return found


@_compiled
def _acc(
    x: float, v: float, t: float, u: float, side: float, x0: float, z: Array, y: Array, b: Array, p: Array
) -> float:
    f = _wet(x, v, t, b, p) + _inside(x, x0, z, b[3], p)
    if p[BRISTLE] == 0.0:
        f += side * _dry(x, v, t, b[3], p)
    if p[CREEP] != 0.0:
        f += p[CREEP] * (y[0] + 0.5 * y[1])
    return float((u - f) / b[0])


@_compiled
def _rk(
    x: float, v: float, t: float, h: float, u: float, rate: float, side: float, z: Array, y: Array, b: Array, p: Array
) -> tuple[float, float]:
    a1 = _acc(x, v, t, u, side, x, z, y, b, p)
    x2, v2 = x + 0.5 * h * v, v + 0.5 * h * a1
    a2 = _acc(x2, v2, t + 0.5 * h, u + 0.5 * h * rate, side, x, z, y, b, p)
    x3, v3 = x + 0.5 * h * v2, v + 0.5 * h * a2
    a3 = _acc(x3, v3, t + 0.5 * h, u + 0.5 * h * rate, side, x, z, y, b, p)
    x4, v4 = x + h * v3, v + h * a3
    a4 = _acc(x4, v4, t + h, u + h * rate, side, x, z, y, b, p)
    return x + h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0, v + h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0


@_compiled
def _advance(
    x: float, v: float, side: float, t: float, h: float, u: float, rate: float, z: Array, y: Array, b: Array, p: Array
) -> tuple[float, float, float]:
    """One step, through reversals and rest; z and y (aged bristles and creep) are carried on in place."""
    left, tries = h, 0
    while left > 1e-12 * h and tries < 50:
        tries += 1
        x_old = x
        if side == 0.0 and p[BRISTLE] == 0.0:
            net = u - _wet(x, 0.0, t, b, p) - (p[CREEP] * (y[0] + 0.5 * y[1]) if p[CREEP] != 0.0 else 0.0)
            if abs(net) <= _dry(x, 0.0, t, b[3], p):
                return x, 0.0, 0.0
            side = math.copysign(1.0, net)
        xn, vn = _rk(x, v, t, left, u, rate, side, z, y, b, p)
        done = left
        if p[BRISTLE] == 0.0 and vn * side < 0.0:
            low, high = 0.0, left
            for _ in range(40):
                mid = 0.5 * (low + high)
                _, vm = _rk(x, v, t, mid, u, rate, side, z, y, b, p)
                if vm * side < 0.0:
                    high = mid
                else:
                    low = mid
            done = high
            xn, vn = _rk(x, v, t, done, u, rate, side, z, y, b, p)
            vn, side = 0.0, 0.0
        if p[CREEP] != 0.0:
            y[0] = y[0] * math.exp(-done / p[CREEP_1]) + (xn - x_old)
            y[1] = y[1] * math.exp(-done / p[CREEP_2]) + (xn - x_old)
        if p[BRISTLE] != 0.0:
            for i in range(_ELEMENTS):
                most = b[3] / _ELEMENTS
                z[i] = min(max(z[i] + most * (i + 1.0) / p[BRISTLE] * (xn - x_old), -most), most)
        x, v, t, u, left = xn, vn, t + done, u + rate * done, left - done
    return x, v, side


@_compiled
def given_force(u: Array, held: bool, dt: float, x: float, v: float, b: Array, p: Array) -> tuple[Array, Array]:
    """Motion x, v (n,) under a force u (n,) that is held, or finely given: u ((n - 1) FINE + 1,)."""
    n = u.size if held else (u.size - 1) // _FINE + 1
    xs, vs = np.empty(n), np.empty(n)
    z, y = np.zeros(_ELEMENTS), np.zeros(2)
    side = 0.0 if v == 0.0 else math.copysign(1.0, v)
    h = dt / _FINE
    for i in range(n):
        xs[i], vs[i] = x, v
        if i == n - 1:
            break
        for j in range(_FINE):
            if held:
                now, rate = u[i], 0.0
            else:
                now, rate = u[i * _FINE + j], (u[i * _FINE + j + 1] - u[i * _FINE + j]) / h
            x, v, side = _advance(x, v, side, i * dt + j * h, h, now, rate, z, y, b, p)
    return xs, vs


@_compiled
def controlled(
    r: Array, rv: Array, ra: Array, count: float, gains: Array, dt: float, b: Array, p: Array
) -> tuple[Array, Array]:
    """Motion and the held force (n,) of a loop on encoder counts that follows r, rv, ra (n,).

    gains : kp, kd, ki, share of the speed's filter that is new each tick, mass and friction that are fed forward, most.
    """
    n = r.size
    xs, us = np.empty(n), np.empty(n)
    z, y = np.zeros(_ELEMENTS), np.zeros(2)
    x, v, side, speed, total = r[0], 0.0, 0.0, 0.0, 0.0
    before = math.floor(x / count + 0.5) * count
    for i in range(n):
        seen = math.floor(x / count + 0.5) * count
        speed += gains[3] * ((seen - before) / dt - speed)
        before = seen
        total += (r[i] - seen) * dt
        u = gains[0] * (r[i] - seen) + gains[1] * (rv[i] - speed) + gains[2] * total + gains[4] * ra[i]
        u += gains[5] * math.tanh(rv[i] / (0.02 * gains[7]))
        u = min(max(u, -gains[6]), gains[6])
        xs[i], us[i] = x, u
        h = dt / _FINE
        for j in range(_FINE):
            x, v, side = _advance(x, v, side, i * dt + j * h, h, u, 0.0, z, y, b, p)
    return xs, us


@_compiled
def pushed(r: Array, rv: Array, stiff: float, damp: float, dt: float, b: Array, p: Array) -> tuple[Array, Array]:
    """Motion and measured force (n,) of a slider that a stiff arm pushes along r, rv ((n - 1) FINE + 1,)."""
    n = (r.size - 1) // _FINE + 1
    xs, us = np.empty(n), np.empty(n)
    z, y = np.zeros(_ELEMENTS), np.zeros(2)
    x, v, side, h = r[0], 0.0, 0.0, dt / _FINE
    for i in range(n):
        j = i * _FINE
        xs[i], us[i] = x, stiff * (r[j] - x) + damp * (rv[j] - v)
        if i == n - 1:
            break
        for j in range(i * _FINE, (i + 1) * _FINE):
            # the arm's own force is followed as it changes within a step
            m = 6
            for q in range(m):
                s = (q + 0.5) / m
                u = stiff * (r[j] + s * (r[j + 1] - r[j]) - x) + damp * (rv[j] + s * (rv[j + 1] - rv[j]) - v)
                x, v, side = _advance(x, v, side, (j + q / m) * h, h / m, u, 0.0, z, y, b, p)
    return xs, us
