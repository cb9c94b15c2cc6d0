"""Repetitions of one rig, each with an encoder's zero of its own, by an integrator that shares no code with ours."""

import math
from functools import partial
from typing import Any

import numpy as np
from numba import njit

import harness
from benchmarks.draws.shared import Answer, log_uniform
from harness.core.errors import HarnessError
from harness.core.recording import Recording

EFFECTS = ("none", "quadratic-drag", "cubic-stiffness", "stribeck", "quadratic-stiffness")
_INNER = 100
"""Steps between two samples."""


@njit(cache=True)
def _force(x: float, v: float, law: Any) -> float:
    return float(-law[0] * x - law[1] * v - law[3] * abs(v) * v - law[4] * x * x * x - law[5] * x * x)


@njit(cache=True)
def _friction(v: float, law: Any) -> float:
    if law[7] <= 0.0:
        return float(law[2])
    return float(law[2] + (law[6] - law[2]) * math.exp(-((abs(v) / law[7]) ** 2)))


@njit(cache=True)
def _let_go(x: float, n: int, dt: float, law: Any) -> Any:
    """Positions (n,) of a unit mass let go at x: Runge-Kutta, friction turned round where the speed passes nought."""
    out, v, h = np.empty(n), 0.0, dt / _INNER
    most = law[6] if law[7] > 0.0 else law[2]
    f = _force(x, 0.0, law)
    side = math.copysign(1.0, f) if abs(f) > most else 0.0
    for i in range(n):
        out[i] = x
        for _ in range(_INNER):
            if side == 0.0:
                break
            a1 = _force(x, v, law) - side * _friction(v, law)
            x2, v2 = x + 0.5 * h * v, v + 0.5 * h * a1
            a2 = _force(x2, v2, law) - side * _friction(v2, law)
            x3, v3 = x + 0.5 * h * v2, v + 0.5 * h * a2
            a3 = _force(x3, v3, law) - side * _friction(v3, law)
            x4, v4 = x + h * v3, v + h * a3
            a4 = _force(x4, v4, law) - side * _friction(v4, law)
            after = x + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4)
            speed = v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
            if speed * side >= 0.0:
                x, v = after, speed
                continue
            part = v / (v - speed)
            x, v = x + part * (after - x), 0.0
            f = _force(x, 0.0, law)
            side = math.copysign(1.0, f) if abs(f) > most else 0.0
            if side != 0.0:
                rest, a = (1.0 - part) * h, f - side * most
                x, v = x + 0.5 * a * rest * rest, a * rest
    return out


def drawn(seed: int, number: int) -> tuple[str, list[Recording]]:
    """What hides, and three to five recordings; in half of the draws spring and friction differ a little each time."""
    r = np.random.default_rng([seed, number])
    log = partial(log_uniform, r)
    effect = EFFECTS[number % len(EFFECTS)]
    w, size = log(5.0, 30.0), log(0.02, 0.08)
    k, zeta, x_k = w * w, log(0.003, 0.03), size * log(0.008, 0.03)
    rate, noise, strong = w / (2.0 * math.pi) * log(40.0, 200.0), size * log(2e-4, 2e-3), log(0.3, 1.0)
    f_k = k * x_k
    c2 = strong * 0.06 / size if effect == "quadratic-drag" else 0.0
    k3 = strong * 0.3 * k / size**2 if effect == "cubic-stiffness" else 0.0
    k2 = strong * 0.2 * k / size if effect == "quadratic-stiffness" else 0.0
    bent = effect == "stribeck"
    f_s, v_s = (f_k * (1.0 + 1.5 * strong), w * size * r.uniform(0.05, 0.2)) if bent else (f_k, 0.0)
    spread, recordings = number % 2, []
    for j in range(int(r.integers(3, 6))):
        stiff, rough = k * (1.0 + spread * r.normal(0.0, 5e-4)), 1.0 + spread * r.normal(0.0, 0.02)
        begin = size * (r.uniform(0.7, 1.0) if r.random() < 0.5 else r.uniform(0.9, 1.0))
        begin *= 1.0 if r.random() < 0.8 else -1.0
        n = int(r.uniform(12.0, 16.0) * 2.0 * math.pi / w * rate)
        law = np.array([stiff, 2.0 * zeta * w, f_k * rough, c2, k3, k2, f_s * rough, v_s])
        held = int(r.uniform(0.0, 0.5) * rate * 2.0 * math.pi / w) if r.random() < 0.5 else 0
        x = np.concatenate([np.full(held, begin), _let_go(begin, n, 1.0 / rate, law)])
        zero = size * r.normal(0.0, 0.03) if r.random() < 0.8 else 0.0
        x = x + zero + noise * r.standard_normal(x.size)
        recordings.append(Recording(np.arange(x.size) / rate, {"x": x}, f"repetition {j + 1}.csv"))
    return effect, recordings


def answer(seed: int, number: int) -> Answer:
    """Right where the effect comes first or is on a list of at most four; of a control, where nothing is claimed."""
    effect, recordings = drawn(seed, number)
    try:
        found = harness.diagnose(recordings, engines=())
    except HarnessError as error:
        return Answer(False, f"{effect}: {error}")
    names = [m.name for m in found.mechanisms if m.grade in ("explains", "main", "one-of")]
    if effect == "none":
        right = not names
    else:
        right = names[:1] == [effect] or (found.verdict == "one_of" and effect in names[:4])
    chi2 = found.refined.chi2_per_point
    return Answer(right, f"{effect}, {len(recordings)}: {found.verdict} {names}, chi2 {chi2 or math.nan:.3g}")
