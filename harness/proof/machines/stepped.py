"""The motion at a fixed step: ten times as fast as the plant's integrator, and good to some millionths of the motion.

Strengths are tried with it; what is recorded and what shares are measured on comes of the plant's integrator. Reversals
are met, kinks of laws are stepped over. Bristles are too stiff for it.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.proof.plant.integrate import PlantRun
from harness.proof.plant.machine import Machine
from harness.proof.plant.model import PlantModel

STEPS = 48
"""A period of the slider or of what drives it, at least."""
_HALVINGS = 40
_MOST_TURNS = 2000


def step_through(model: PlantModel, t: FloatArray) -> PlantRun:
    """The motion at the times t (s, shape (n,), increasing), by the classical Runge-Kutta rule.

    Raises SimulationError where the motion has no end of reversals.
    """
    machine = Machine(model)
    fastest = max(model.omega_n, model.drive.rate if model.drive is not None else 0.0)
    longest = min(2.0 * math.pi / (fastest * STEPS), machine.longest_step)
    knocks = sorted((k for k in model.knocks if k.time > t[0]), key=lambda k: k.time)
    now, end = max(float(t[0]), model.release), float(t[-1])
    s: list[float] = machine.start.tolist()
    d, turns = machine.direction(now, s), 0
    at, states, rates, directions = [now], [s], [_rates(machine, now, s, d)], [d]
    while now < end:
        k1 = rates[-1]
        stop = min(knocks[0].time, end) if knocks else end
        h = min(longest, stop - now)
        new = _step(machine, now, s, d, h, k1)
        if d != 0.0 and new[1] * d < 0.0 and s[1] != 0.0:
            a1, a2 = h * k1[1], h * _rates(machine, now + h, new, d)[1]
            h *= _zero(s[1], new[1], a1, a2)
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
        rates.append(_rates(machine, now, s, d))
        directions.append(d)
    return _sampled(machine, t, np.array(at), np.array(states), np.array(rates), np.array(directions))


def _rates(machine: Machine, t: float, s: list[float], d: float) -> list[float]:
    return machine.held_rates(s) if d == 0.0 else machine.rates(t, s, d)


def _step(machine: Machine, t: float, s: list[float], d: float, h: float, k1: list[float]) -> list[float]:
    half = 0.5 * h
    k2 = _rates(machine, t + half, [y + half * r for y, r in zip(s, k1, strict=True)], d)
    k3 = _rates(machine, t + half, [y + half * r for y, r in zip(s, k2, strict=True)], d)
    k4 = _rates(machine, t + h, [y + h * r for y, r in zip(s, k3, strict=True)], d)
    return [y + h * (a + 2.0 * (b + c) + e) / 6.0 for y, a, b, c, e in zip(s, k1, k2, k3, k4, strict=True)]


def _zero(v: float, new_v: float, rise: float, new_rise: float) -> float:
    """Where the cubic through values and slopes of both ends is zero, as a share of the step."""
    lo, hi = 0.0, 1.0
    for _ in range(_HALVINGS):
        s = 0.5 * (lo + hi)
        r = 1.0 - s
        value = r * r * ((1.0 + 2.0 * s) * v + s * rise) + s * s * ((1.0 + 2.0 * r) * new_v - r * new_rise)
        lo, hi = (s, hi) if (value > 0.0) == (v > 0.0) else (lo, s)
    return hi


def _sampled(
    machine: Machine, t: FloatArray, at: FloatArray, states: FloatArray, rates: FloatArray, directions: FloatArray
) -> PlantRun:
    """The motion at the samples: cubics through values and rates; forces from the laws."""
    model = machine.model
    i = np.clip(np.searchsorted(at, t, side="right") - 1, 0, at.size - 2)
    h = (at[i + 1] - at[i])[:, None]
    s = np.clip((t - at[i])[:, None] / h, 0.0, 1.0)
    r = 1.0 - s
    y = r**2 * ((1.0 + 2.0 * s) * states[i] + s * h * rates[i])
    y += s**2 * ((1.0 + 2.0 * r) * states[i + 1] - r * h * rates[i + 1])
    before = t < at[0]
    y[before] = states[0]
    y[before, 1] = 0.0
    d = np.where(before, 0.0, directions[i])
    a, friction = np.zeros(t.size), np.zeros(t.size)
    for j, (now, row, way) in enumerate(zip(t.tolist(), y.tolist(), d.tolist(), strict=True)):
        if way != 0.0:
            a[j], friction[j], _ = machine.motion(now, row, way)
    u = np.zeros(t.size)
    if model.drive is not None:
        u = np.array([model.drive.law(*z) for z in zip(t.tolist(), y[:, 0].tolist(), y[:, 1].tolist(), strict=True)])
    return PlantRun(t, y[:, 0], y[:, 1], a, u, friction, (d == 0.0) & ~before, y[:, 2:])
