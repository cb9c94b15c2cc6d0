"""Recordings of ten kinds of motion, as machines, hands and other instruments make them, and the kind that is told.

Motions are integrated by scipy or written down as what moves them would have it; sensors add noise, steps, a zero of
their own, colour and jitter. Nothing of the classifier is called.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

import harness
from benchmarks.draws.shared import Answer, log_uniform
from harness.core.recording import Recording

FloatArray = Any
Channels = dict[str, FloatArray]
_ACROSS = 1e-3
"""Of a typical speed, over which dry friction changes its sign."""


def _swing(r: np.random.Generator, t: FloatArray, x0: float, period: float, zeta: float, dry: float) -> Channels:
    """A spring or a pendulum let go at x0. dry : friction over stiffness, of x0's unit."""
    w, hangs = 2.0 * math.pi / period, r.random() < 0.4
    drag = r.choice([0.0, r.uniform(0.0, 0.3)]) * 2.0 * zeta * w / max(abs(x0) * w, 1e-12)
    pull = (lambda x: w * w * math.sin(x)) if hangs and abs(x0) < 1.5 else (lambda x: w * w * x)

    def slowed(_: float, y: FloatArray) -> list[float]:
        x, v = y
        friction = dry * w * w * math.tanh(v / (_ACROSS * abs(x0) * w))
        return [v, -pull(x) - 2.0 * zeta * w * v - drag * v * abs(v) - friction]

    found = solve_ivp(slowed, (0.0, float(t[-1])), [x0, 0.0], t_eval=t, method="LSODA", rtol=1e-7, atol=1e-9 * abs(x0))
    x, v = found.y
    a = np.array([slowed(0.0, y)[1] for y in found.y.T])
    still = np.abs(a) * period**2 < 1e-3 * abs(x0)
    return {"x": x, "v": v, "a": np.where(still, 0.0, a)}


def _sensed(r: np.random.Generator, t: FloatArray, clean: Channels, noise: float | None = None) -> Recording:
    """With noise of a share of each channel's range, in steps, from a zero of its own, coloured; u is not shifted."""
    share = 10.0 ** r.uniform(-3.3, -1.9) if noise is None else noise
    colour = r.uniform(0.2, 0.7) if r.random() < 0.3 else 0.0
    stepped, told = r.random() < 0.4, {}
    for name, y in clean.items():
        size = float(np.ptp(y)) or 1.0
        fresh = lfilter([math.sqrt(1.0 - colour**2)], [1.0, -colour], r.standard_normal(t.size))
        shown = y + share * size * fresh + (r.uniform(-1.0, 1.0) * size if name == "x" else 0.0)
        step = size * 10.0 ** r.uniform(-3.5, -2.2)
        told[name] = step * np.round(shown / step) if stepped and name != "u" else shown
    late = 0.2 * (t[1] - t[0]) * r.uniform(-1.0, 1.0, t.size) if r.random() < 0.3 else 0.0
    return Recording(t + late, told, "drawn.csv", angular=bool(r.random() < 0.5))


def _of(r: np.random.Generator, clean: Channels, choices: tuple[str, ...]) -> Channels:
    return {c: clean[c] for c in str(r.choice(choices))}


def _hand(n: int, start: float, end: float) -> FloatArray:
    """A reach (n,) from one place to another, as a hand makes it (Flash and Hogan 1985)."""
    s = np.linspace(0.0, 1.0, n)
    return start + (end - start) * (10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5)


def _tremor(r: np.random.Generator, t: FloatArray, size: float) -> FloatArray:
    return size * sum(
        r.uniform(0.3, 1.0) * np.sin(2.0 * math.pi * (f * t + r.random())) for f in r.uniform(4.0, 12.0, 4)
    )


def _one(r: np.random.Generator, dt: float, period: float, cycles: float, zeta: float) -> Channels:
    x0 = r.uniform(0.2, 1.2) * r.choice([-1.0, 1.0])
    t = np.arange(0.0, cycles * period, dt)
    return _swing(r, t, x0, period, zeta, abs(x0) * log_uniform(r, 0.002, 0.04))


def free_decay(r: np.random.Generator) -> Recording:
    """Let go once, held before or not, cut or left to rest."""
    period, zeta = log_uniform(r, 0.1, 3.0), log_uniform(r, 0.004, 0.07)
    dt = period / r.uniform(16, 150)
    clean = _one(r, dt, period, r.uniform(3.0, 12.0) + r.choice([0.0, r.uniform(0.0, 30.0)]), zeta)
    if r.random() < 0.5:
        held = int(r.uniform(0.2, 3.0) * period / dt)
        clean = {c: np.concatenate((np.full(held, y[0] if c == "x" else 0.0), y)) for c, y in clean.items()}
    t = dt * np.arange(clean["x"].size)
    return _sensed(r, t, _of(r, clean, ("x", "x", "v", "a", "xa", "xv")))


def several_decays(r: np.random.Generator) -> Recording:
    """Let go two to five times, brought back by hand."""
    period, zeta = log_uniform(r, 0.2, 3.0), log_uniform(r, 0.012, 0.07)
    dt, parts = period / r.uniform(16, 80), list[Channels]()
    for _ in range(int(r.integers(2, 6))):
        y = _one(r, dt, period, r.uniform(5.0, 25.0), zeta)
        wait, reach = int(r.uniform(0.2, 4.0) * period / dt), int(r.uniform(0.7, 3.0) * period / dt)
        came = float(parts[-1]["x"][-1]) if parts else 0.0
        x = np.concatenate((np.full(wait, came), _hand(reach, came, y["x"][0]), np.full(wait, y["x"][0]), y["x"]))
        v = np.gradient(x, dt)
        v[-y["v"].size :] = y["v"]
        parts.append({"x": x, "v": v})
    clean = {c: np.concatenate([p[c] for p in parts]) for c in ("x", "v")}
    return _sensed(r, dt * np.arange(clean["x"].size), _of(r, clean, ("x", "x", "v", "xv")))


def run_down(r: np.random.Generator) -> Recording:
    """Let go in motion; brought to speed, or turned steadily, before."""
    v0, seconds, wet = r.uniform(2.0, 80.0), r.uniform(2.0, 60.0), r.uniform(0.0, 0.8)
    f, c, c2 = (1.0 - wet) * v0 / seconds, wet / seconds, r.choice([0.0, 0.5]) / seconds / v0
    t = np.linspace(0.0, seconds * r.uniform(0.6, 1.3), int(r.integers(400, 3000)))
    found = solve_ivp(
        lambda _, y: [max(y[1], 0.0), -(f + c * y[1] + c2 * y[1] ** 2) if y[1] > 0.0 else 0.0],
        (0.0, float(t[-1])), [0.0, v0], t_eval=t, rtol=1e-7,
    )  # fmt: skip
    v = np.maximum(found.y[1], 0.0)
    if r.random() < 0.4:
        n = int(r.uniform(0.05, 0.3) * t.size)
        before = _hand(n, 0.0, v0) if r.random() < 0.6 else np.full(n, v0)
        v = np.concatenate((before, v))
    t = (t[1] - t[0]) * np.arange(v.size)
    x = np.concatenate(([0.0], np.cumsum(0.5 * np.diff(t) * (v[1:] + v[:-1]))))
    sign = r.choice([-1.0, 1.0])
    return _sensed(r, t, _of(r, {"x": sign * x, "v": sign * v}, ("x", "v")), 10.0 ** r.uniform(-4.0, -2.2))


def _multisine(r: np.random.Generator, t: FloatArray, low: float, high: float) -> FloatArray:
    return sum(np.sin(2.0 * math.pi * (f * t + r.random())) for f in r.uniform(low, high, int(r.integers(3, 8))))


def driven(r: np.random.Generator) -> Recording:
    """Pushed by a force that was recorded, or was not."""
    period = log_uniform(r, 0.2, 3.0)
    t = np.linspace(0.0, period * r.uniform(15, 40), int(r.integers(1500, 5000)))
    how = str(r.choice(["sine", "chirp", "many"]))
    if how == "sine":
        f = r.uniform(0.4, 1.6) / period
        u = np.sin(2.0 * math.pi * f * t)
    elif how == "chirp":
        f0, f1 = r.uniform(0.2, 0.5) / period, r.uniform(1.2, 2.0) / period
        u = np.sin(2.0 * math.pi * (f0 * t + 0.5 * (f1 - f0) * t**2 / t[-1]))
    else:
        u = _multisine(r, t, 0.2 / period, 1.8 / period)
    w, zeta = 2.0 * math.pi / period, r.uniform(0.03, 0.3)
    known = bool(r.random() < 0.5)
    k = w * w if not known or r.random() < 0.6 else 0.0
    found = solve_ivp(
        lambda s, y: [y[1], w * w * np.interp(s, t, u) - k * y[0] - 2.0 * zeta * w * y[1]
                      - 0.1 * w * w * math.tanh(y[1] / (1e-2 * w))],
        (0.0, float(t[-1])), [0.0, 0.0], t_eval=t, max_step=float(t[1]) * 4.0, rtol=1e-5,
    )  # fmt: skip
    clean = {"x": found.y[0], "v": found.y[1]}
    if known:
        return _sensed(r, t, {"x": clean["x"], "u": u})
    # what begins from rest rises first, which is seen
    late = slice(int(r.choice([0.0, 0.3]) * t.size), None)
    return _sensed(r, t[late] - t[late][0], {c: y[late] for c, y in _of(r, clean, ("x", "v", "xv")).items()})


def slow_axis(r: np.random.Generator) -> Recording:
    """To and fro at a speed that is held, with its force or without."""
    strokes, n = int(r.integers(2, 9)), int(r.integers(200, 900))
    ramp, wait = int(n * r.uniform(0.01, 0.08)), int(n * r.choice([0.0, r.uniform(0.0, 0.4)]))
    one = np.concatenate((np.linspace(0.0, 1.0, ramp + 1), np.ones(n), np.linspace(1.0, 0.0, ramp + 1), np.zeros(wait)))
    v = np.concatenate([(-1.0) ** k * one for k in range(strokes)])
    v = v * (1.0 + r.uniform(0.0, 0.05) * np.sin(2.0 * math.pi * np.arange(v.size) / r.uniform(20, 100)))
    dt = log_uniform(r, 1e-3, 5e-2)
    t, x = dt * np.arange(v.size), np.cumsum(v) * dt
    if r.random() < 0.5:
        return _sensed(r, t, {"x": x}, 10.0 ** r.uniform(-4.0, -2.5))
    u = np.tanh(v / 0.01) * r.uniform(0.5, 2.0) + r.uniform(0.0, 0.5) * v + 0.1 * np.sin(x / float(np.ptp(x)) * 40.0)
    return _sensed(r, t, {"x": x, "u": u}, 10.0 ** r.uniform(-4.0, -2.5))


def held(r: np.random.Generator) -> Recording:
    """Brought somewhere and held there by a hand; or pushed by a force under which it does not move."""
    n, dt = int(r.integers(600, 4000)), r.uniform(2e-3, 2e-2)
    t = dt * np.arange(n)
    if r.random() < 0.3:
        u = np.linspace(0.0, 1.0, n) + 0.1 * _multisine(r, t, 0.1, 1.0)
        return _sensed(r, t, {"x": np.zeros(n), "u": u}, r.uniform(1e-3, 1e-2))
    wait, reach = int(r.uniform(0.02, 0.15) * n), int(r.uniform(0.03, 0.15) * n)
    x = np.concatenate((np.zeros(wait), _hand(reach, 0.0, 1.0), np.ones(n - wait - reach)))
    shaken = _tremor(r, t, r.uniform(0.0, 0.015))
    return _sensed(r, t, {"x": x + np.where(np.arange(n) < wait, 0.0, shaken)}, 10.0 ** r.uniform(-3.5, -2.3))


def steps(r: np.random.Generator) -> Recording:
    """Sent from place to place by a controller, which overshoots or does not."""
    count, w, zeta = int(r.integers(3, 11)), 2.0 * math.pi / r.uniform(0.05, 0.5), r.uniform(0.35, 1.2)
    dwell = r.uniform(8.0, 40.0) / (zeta * w)
    levels = [0.0]
    while len(levels) <= count:
        place = r.uniform(-1.0, 1.0)
        if abs(place - levels[-1]) > 0.3:
            levels.append(place)
    t = np.linspace(0.0, dwell * len(levels), int(len(levels) * r.uniform(150, 500)))
    found = solve_ivp(
        lambda s, y: [y[1], w * w * (levels[min(int(s / dwell), count)] - y[0]) - 2.0 * zeta * w * y[1]],
        (0.0, float(t[-1])), [0.0, 0.0], t_eval=t, max_step=dwell / 50.0, rtol=1e-6, atol=1e-8,
    )  # fmt: skip
    return _sensed(r, t, {"x": found.y[0]}, 10.0 ** r.uniform(-3.5, -2.3))


def spin_up(r: np.random.Generator) -> Recording:
    """Switched on: towards a speed, or at a steady torque."""
    n, tau = int(r.integers(400, 3000)), r.uniform(0.5, 20.0)
    t = np.linspace(0.0, tau * r.uniform(1.0, 5.0), n)
    v = 1.0 - np.exp(-t / tau) if r.random() < 0.6 else t / t[-1]
    wait = int(r.choice([0.0, r.uniform(0.0, 0.3)]) * n)
    v = r.uniform(5.0, 100.0) * np.concatenate((np.zeros(wait), v))
    t = t[1] * np.arange(v.size)
    return _sensed(r, t, _of(r, {"x": np.cumsum(v) * t[1], "v": v}, ("x", "v")), 10.0 ** r.uniform(-4.0, -2.2))


def at_rest(r: np.random.Generator) -> Recording:
    """A sensor on the bench: noise, white or coloured, in steps of its own."""
    n = int(r.integers(300, 6000))
    colour = r.choice([0.0, r.uniform(0.0, 0.9)])
    y = lfilter([1.0], [1.0, -colour], r.standard_normal(n)) + r.uniform(-50.0, 50.0)
    if r.random() < 0.4:
        step = r.uniform(0.2, 3.0)
        y = step * np.round(y / step)
    if r.random() < 0.2:
        y[int(r.integers(n))] += 30.0
    y[:2] += [0.0, 1e-3]
    return Recording(r.uniform(1e-3, 0.1) * np.arange(0.0, n), {str(r.choice(["x", "v", "a"])): 1e-3 * y}, "drawn.csv")


def not_mechanical(r: np.random.Generator) -> Recording:
    """A drift, a warming, a walk, a switch, a phase that wraps, a slow wave."""
    n = int(r.integers(400, 5000))
    s = np.linspace(0.0, 1.0, n)
    how = str(r.choice(["walk", "memory", "warming", "switch", "phase", "slow", "discharges"]))
    if how == "walk":
        y = np.cumsum(r.standard_normal(n))
    elif how == "memory":
        y = lfilter([1.0], [1.0, -math.exp(-r.uniform(5.0, 15.0) / n)], r.standard_normal(n))
    elif how == "warming":
        y = 1.0 - np.exp(-s * r.uniform(2.0, 8.0))
    elif how == "switch":
        y = (np.cumsum(r.random(n) < r.uniform(6.0, 40.0) / n) % 2).astype(np.float64)
        y[0] = 1.0 - y[-1]
    elif how == "phase":
        y = (s * r.uniform(3.0, 15.0)) % 1.0
    elif how == "slow":
        y = np.sin(2.0 * math.pi * (s * r.uniform(0.3, 0.9) + r.random())) + r.uniform(-1.0, 1.0) * s
    else:
        y = np.exp(-((s * r.uniform(3.0, 12.0)) % 1.0) * r.uniform(2.0, 6.0))
    return _sensed(r, np.arange(n) * r.uniform(1e-3, 10.0), {"x": y}, 10.0 ** r.uniform(-4.0, -2.0))


MOTIONS: dict[str, Callable[[np.random.Generator], Recording]] = {
    "free-decay": free_decay,
    "several-decays": several_decays,
    "run-down": run_down,
    "driven": driven,
    "slow-axis": slow_axis,
    "held": held,
    "steps": steps,
    "spin-up": spin_up,
    "at-rest": at_rest,
    "not-mechanical": not_mechanical,
}


def answer(seed: int, number: int) -> Answer:
    """Right where the motion's kind is told; ten kinds in turn."""
    kind = list(MOTIONS)[number % len(MOTIONS)]
    found = harness.motion(MOTIONS[kind](np.random.default_rng([seed, number])))
    return Answer(found.kind == kind, f"{kind}: {found.kind}, {found.reason}")
