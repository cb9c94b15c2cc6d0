"""A slider of its own: fixed steps of a 64th of a sample, no line shared with the kernels or the proof's plants."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.core.jit import compiled

Floats = NDArray[np.float64]

LAWS: tuple[str, ...] = (
    *("omega2", "c", "f_k", "f_s", "v_s", "pendulum"),
    *("drag", "asymmetric", "power", "exponent", "k3", "k2", "gap_stop", "k_stop", "gap_play", "k_drift"),
    *("force", "ripple", "ripple_period", "ripple_phase", "hum", "hum_omega", "hum_phase"),
    *("f_slope", "f_drift", "f_depth", "f_omega", "knock_t", "knock"),
)
"""Numbers of a unit mass; those that are not given are nought."""
_STEPS = 64


@compiled
def _level(p: Floats, x: float, v: float, t: float) -> float:
    level = p[2]
    if p[3] > p[2]:
        level += (p[3] - p[2]) * math.exp(-((v / p[4]) ** 2)) if p[4] > 0.0 else 0.0
    return float(max(level * (1.0 + p[23] * x) * (1.0 + p[24] * t) * (1.0 + p[25] * math.cos(p[26] * t)), 0.0))


@compiled
def _smooth(p: Floats, x: float, v: float, t: float) -> float:
    """Acceleration by all that is no dry friction, m/s^2."""
    spring = p[0] * (1.0 + p[15] * t) * (math.sin(x) if p[5] > 0.0 else x)
    if p[14] > 0.0:
        spring -= p[0] * min(max(x, -p[14]), p[14])
    a = -spring - p[1] * v - p[6] * abs(v) * v - p[7] * abs(v) - p[10] * x**3 - p[11] * x * x
    if p[8] != 0.0 and v != 0.0:
        a -= p[8] * abs(v) ** p[9] * math.copysign(1.0, v)
    if p[13] > 0.0 and abs(x) > p[12]:
        a -= p[13] * (x - math.copysign(p[12], x))
    if p[17] != 0.0:
        a -= p[17] * math.cos(2.0 * math.pi * x / p[18] + p[19])
    return float(a + p[16] + p[20] * math.cos(p[21] * t + p[22]))


@compiled
def _follow(p: Floats, x: float, v: float, h: float, n: int, steps: int, u: Floats) -> tuple[Floats, Floats, Floats]:
    xs, vs, accelerations = np.empty(n), np.empty(n), np.empty(n)
    t, stuck, knocked = 0.0, v == 0.0, p[28] == 0.0
    for i in range(n):
        push = u[i]
        level = _level(p, x, v, t)
        a = _smooth(p, x, v, t) + push
        if stuck and abs(a) <= max(level, p[3]):
            xs[i], vs[i], accelerations[i] = x, 0.0, 0.0
        else:
            way = v if v != 0.0 else a
            xs[i], vs[i], accelerations[i] = x, v, a - math.copysign(level, way)
        for _ in range(steps):
            if not knocked and t >= p[27]:
                v, knocked, stuck = v + p[28], True, False
            free = _smooth(p, x, v, t) + push
            if stuck:
                if abs(free) <= max(_level(p, x, 0.0, t), p[3]):
                    t += h
                    continue
                stuck = False
            way = math.copysign(1.0, v if v != 0.0 else free)
            # the midpoint rule along one direction of sliding
            a1 = free - way * _level(p, x, v, t)
            vm, xm = v + 0.5 * h * a1, x + 0.5 * h * v
            am = _smooth(p, xm, vm, t + 0.5 * h) + push - way * _level(p, xm, vm, t + 0.5 * h)
            new = v + h * am
            if v != 0.0 and new * v <= 0.0:
                part = v / (v - new)
                x += part * h * 0.5 * v
                v, t = 0.0, t + h
                stuck = abs(_smooth(p, x, 0.0, t) + push) <= max(_level(p, x, 0.0, t), p[3])
                if not stuck:
                    a1 = _smooth(p, x, 0.0, t) + push
                    v = (1.0 - part) * h * (a1 - math.copysign(_level(p, x, 0.0, t), a1))
                    x += 0.5 * (1.0 - part) * h * v
                continue
            x, v, t = x + h * vm, new, t + h
    return xs, vs, accelerations


@dataclass(frozen=True, slots=True)
class Slider:
    """A unit mass; numbers by the names of LAWS. x0, v0 : m or rad, and per s. u : (n,), held over each sample."""

    numbers: Mapping[str, float]
    x0: float
    v0: float = 0.0
    u: Floats | None = None

    def motion(self, t: Floats) -> tuple[Floats, Floats, Floats]:
        """Position, velocity and acceleration at even times t, (n,), s."""
        p = np.array([self.numbers.get(name, 0.0) for name in LAWS])
        p[3] = max(p[3], p[2])
        step = float(t[1] - t[0])
        u = np.zeros(t.size) if self.u is None else self.u
        return _follow(p, self.x0, self.v0, step / _STEPS, t.size, _STEPS, u)


@dataclass(frozen=True, slots=True)
class Sensor:
    """What is written of a motion: noise by channel, an encoder's step and zero, and what a sensor does besides."""

    noise: Mapping[str, float] = field(default_factory=dict)
    step: float = 0.0
    zero: float = 0.0
    lag: float = 0.0
    gain: float = 1.0
    bias: float = 0.0
    drift: float = 0.0
    clip: float = math.inf
    phi: float = 0.0

    def read(self, t: Floats, x: Floats, v: Floats, a: Floats, draw: np.random.Generator) -> dict[str, Any]:
        """Channels, (n,) each: those that have a noise."""
        late = np.interp(t - self.lag, t, x, left=x[0]) + self.zero + self.drift * t
        clean = {"x": late, "v": v, "a": np.clip(self.gain * a + self.bias, -self.clip, self.clip)}
        shown: dict[str, Any] = {"t": t}
        for channel, sigma in self.noise.items():
            white = draw.normal(0.0, 1.0, t.size)
            for i in range(1, t.size):
                white[i] = self.phi * white[i - 1] + math.sqrt(1.0 - self.phi**2) * white[i]
            values = clean[channel] + sigma * white
            shown[channel] = np.round(values / self.step) * self.step if self.step and channel == "x" else values
        return shown
