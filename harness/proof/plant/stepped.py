"""Motions at a fixed step, of the classical Runge-Kutta rule: ten times as fast as the plant's integrator, and more.

Strengths are tried with them, and a pendulum is fitted with one; what is recorded and what shares are measured on comes
of the plant's integrator. Good to some millionths of the motion. Reversals are met, kinks of laws are stepped over.
Bristles are too stiff for it.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.jit import compiled
from harness.proof.plant.integrate import Machine, PlantRun, driven
from harness.proof.plant.model import PlantModel

STEPS = 48
"""A period of the slider or of what drives it, at least."""
SWING_STEPS = 64
"""A period of small swings of a pendulum."""
MOST_STEPS = 2_000_000
"""Beyond which a fit has gone astray."""
_HALVINGS, _SWING_HALVINGS = 40, 45
_MOST_TURNS = 2000


@compiled
def _zero(v: float, new_v: float, rise: float, new_rise: float, halvings: int) -> float:
    """Where the cubic through values and slopes of both ends is zero, as a share of the step."""
    lo, hi = 0.0, 1.0
    for _ in range(halvings):
        s = 0.5 * (lo + hi)
        r = 1.0 - s
        value = r * r * ((1.0 + 2.0 * s) * v + s * rise) + s * s * ((1.0 + 2.0 * r) * new_v - r * new_rise)
        if (value > 0.0) == (v > 0.0):
            lo = s
        else:
            hi = s
    return hi


def _between(
    s: FloatArray, h: FloatArray, y: FloatArray, rate: FloatArray, new: FloatArray, new_rate: FloatArray
) -> FloatArray:
    """The cubic through values and rates of both ends of a step h, at the share s of it."""
    r = 1.0 - s
    return r**2 * ((1.0 + 2.0 * s) * y + s * h * rate) + s**2 * ((1.0 + 2.0 * r) * new - r * h * new_rate)


def step_through(model: PlantModel, t: FloatArray) -> PlantRun:
    """The motion at the times t (s, shape (n,), increasing).

    Raises SimulationError where the motion has no end of reversals.
    """
    machine = Machine(model)
    fastest = max(model.omega_n, model.drive.rate if model.drive is not None else 0.0)
    longest = min(2.0 * math.pi / (fastest * STEPS), machine.longest_step)
    knocks = sorted((k for k in model.knocks if k.time > t[0]), key=lambda k: k.time)
    now, end = max(float(t[0]), model.release), float(t[-1])
    s: list[float] = machine.start.tolist()
    d, turns = machine.direction(now, s), 0
    at, states, rates, directions = [now], [s], [machine.rates(now, s, d)], [d]
    while now < end:
        k1 = rates[-1]
        stop = min(knocks[0].time, end) if knocks else end
        h = min(longest, stop - now)
        new = _step(machine, now, s, d, h, k1)
        if d != 0.0 and new[1] * d < 0.0 and s[1] != 0.0:
            a1, a2 = h * k1[1], h * machine.rates(now + h, new, d)[1]
            h *= _zero(s[1], new[1], a1, a2, _HALVINGS)
            new = _step(machine, now, s, d, h, k1)
            new[1], turns = 0.0, turns + 1
            if turns > _MOST_TURNS:
                raise SimulationError(f"machines: more than {_MOST_TURNS} reversals before {now:g} s")
        now, s = now + h, new
        if knocks and now >= knocks[0].time:
            s = [s[0], s[1] + knocks.pop(0).impulse / model.m, *s[2:]]
        if s[1] == 0.0 or d == 0.0 or s[1] * d < 0.0:
            d = machine.direction(now, s)
        at.append(now)
        states.append(s)
        rates.append(machine.rates(now, s, d))
        directions.append(d)
    return _sampled(machine, t, np.array(at), np.array(states), np.array(rates), np.array(directions))


def _step(machine: Machine, t: float, s: list[float], d: float, h: float, k1: list[float]) -> list[float]:
    half = 0.5 * h
    k2 = machine.rates(t + half, [y + half * r for y, r in zip(s, k1, strict=True)], d)
    k3 = machine.rates(t + half, [y + half * r for y, r in zip(s, k2, strict=True)], d)
    k4 = machine.rates(t + h, [y + h * r for y, r in zip(s, k3, strict=True)], d)
    return [y + h * (a + 2.0 * (b + c) + e) / 6.0 for y, a, b, c, e in zip(s, k1, k2, k3, k4, strict=True)]


def _sampled(
    machine: Machine, t: FloatArray, at: FloatArray, states: FloatArray, rates: FloatArray, directions: FloatArray
) -> PlantRun:
    """The motion at the samples: cubics through values and rates; forces from the laws."""
    i = np.clip(np.searchsorted(at, t, side="right") - 1, 0, at.size - 2)
    h = (at[i + 1] - at[i])[:, None]
    s = np.clip((t - at[i])[:, None] / h, 0.0, 1.0)
    y = _between(s, h, states[i], rates[i], states[i + 1], rates[i + 1])
    before = t < at[0]
    y[before] = states[0]
    y[before, 1] = 0.0
    d = np.where(before, 0.0, directions[i])
    a, friction = np.zeros(t.size), np.zeros(t.size)
    for j, (now, row, way) in enumerate(zip(t.tolist(), y.tolist(), d.tolist(), strict=True)):
        if way != 0.0:
            a[j], friction[j], _ = machine.motion(now, row, way)
    x, v = y[:, 0], y[:, 1]
    return PlantRun(t, x, v, a, driven(machine.model, t, x, v), friction, (d == 0.0) & ~before, y[:, 2:])


def swing(
    t: FloatArray, omega_n: float, zeta: float, x_k: float, x0: float, v0: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """x (rad), v (rad/s), a (rad/s^2), shape (n,), of x'' + 2 zeta omega_n x' + omega_n^2 (sin x + x_k sgn x') = 0.

    t : s, shape (n,), increasing; x0, v0 at t = 0. Raises SimulationError beyond ``MOST_STEPS``.
    """
    c, w2 = 2.0 * abs(zeta) * omega_n, omega_n**2
    longest, end = 2.0 * math.pi / (abs(omega_n) * SWING_STEPS), float(t[-1])
    # no swing has more reversals than twice the periods of the smallest ones
    steps = (1.0 + 4.0 / SWING_STEPS) * end / longest
    if not steps < MOST_STEPS:
        raise SimulationError(f"machines: a pendulum of {abs(omega_n):.3g} rad/s over {end:.3g} s")
    room = np.empty((4, int(steps) + 8))
    count = _swing_knots(end, c, w2, w2 * abs(x_k), x0, v0, longest, room)
    at, x, v, f = room[:, :count]
    i = np.clip(np.searchsorted(at, t, side="right") - 1, 0, count - 2)
    h = at[i + 1] - at[i]
    s = (t - at[i]) / h
    r = 1.0 - s
    place = _between(s, h, x[i], v[i], x[i + 1], v[i + 1])
    speed = 6.0 * s * r * (x[i + 1] - x[i]) / h + r * (1.0 - 3.0 * s) * v[i] + s * (1.0 - 3.0 * r) * v[i + 1]
    still = (v[i] == 0.0) & (v[i + 1] == 0.0)
    return place, speed, np.where(still, 0.0, -c * speed - w2 * np.sin(place) - f[i])


@compiled
def _swing_step(x: float, v: float, f: float, h: float, c: float, w2: float) -> tuple[float, float, float]:
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
def _swing_knots(
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
            break
        if at > end:
            return count
        h = longest
        new_x, new_v, rise = _swing_step(x, v, f, h, c, w2)
        if new_v * d < 0.0 and v != 0.0:
            h *= _zero(v, new_v, h * rise, h * (-c * new_v - w2 * math.sin(new_x) - f), _SWING_HALVINGS)
            new_x, new_v, rise = _swing_step(x, v, f, h, c, w2)
            new_v = 0.0
        at, x, v = at + h, new_x, new_v
    room[0, count], room[1, count], room[2, count], room[3, count] = max(end, at) + longest, x, v, 0.0
    return count + 1
