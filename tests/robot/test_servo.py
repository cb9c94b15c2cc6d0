"""A joint under its servo, from goals and positions: what comes out of logs of a plant of another make."""

from dataclasses import replace

import numpy as np
import pytest

from harness.robot.servo.fit import Logs
from harness.robot.servo.plant import Run
from harness.robot.servo.presets import preset
from harness.robot.servo.servo import identified

STEP = 2.0 * np.pi / 4096
STALL, BRAKE, VOLTS, GAIN = 0.45, 0.5, 7.4, 0.166 * 16.0
INERTIA, ARMATURE, GRAVITY, F_K = 0.02, 0.03, 0.6, 0.08


def logged(seed: int, seconds: float = 24.0, rate: float = 50.0) -> Run:
    """Goal and position of a joint whose servo works in steps of 0.5 ms, by explicit Euler; friction stops it."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / rate)
    waves = [(rng.uniform(0.1, 0.4), rng.uniform(0.5, 4.0), rng.uniform(0.0, 6.0)) for _ in range(3)]
    goal = np.sum([a * np.sin(w * t + p) for a, w, p in waves], axis=0)
    late, h = 0.01, 5e-4
    q, v = float(goal[0]), 0.0
    found: list[float] = []
    for i in range(round(t[-1] / h) + 1):
        now = i * h
        if now >= t[min(len(found), t.size - 1)] - 1e-9 and len(found) < t.size:
            found.append(q)
        sent = goal[max(int((now - late) * rate + 1e-9), 0)]
        torque = STALL * VOLTS * min(max(GAIN * (sent - q), -1.0), 1.0) - (BRAKE + 0.04) * v - GRAVITY * np.sin(q)
        if v == 0.0 and abs(torque) <= F_K:
            continue
        side = np.sign(v) or np.sign(torque)
        new = v + h * (torque - side * F_K) / (INERTIA + ARMATURE)
        v = 0.0 if new * side < 0.0 else new
        q += h * v
    seen = np.round((np.array(found) + 0.5 * STEP * rng.standard_normal(t.size)) / STEP) * STEP
    load = np.tile((INERTIA, GRAVITY, 0.0), (t.size, 1))
    return Run(t, seen, goal, np.full(t.size, VOLTS), np.ones(t.size), load, 16.0)


def test_a_servo_s_numbers_come_from_goal_and_position_and_another_motion_is_foretold() -> None:
    found = identified([logged(1)], preset("sts3215"), loaded=True)
    values, errors = found.best.values, found.best.errors
    assert values["f_k"] == pytest.approx(F_K, rel=0.06)
    assert values["stall"] == pytest.approx(STALL, rel=0.05)
    assert values["armature"] == pytest.approx(ARMATURE, rel=0.15)
    assert values["c"] == pytest.approx(BRAKE + 0.04, rel=0.05)
    assert 0.0 < errors["f_k"] < 0.06 * F_K
    other = logged(2)
    foretold = found.best.under(Logs.of([other], found.best.logs.known))
    assert foretold.rms < 1.3 * STEP * np.sqrt(0.25 + 1.0 / 12.0)


def test_without_a_load_that_gives_a_scale_all_is_a_ratio_to_the_inertia() -> None:
    run = logged(1)
    bare = replace(run, load=np.zeros_like(run.load))
    found = identified([bare], None, loaded=False)
    assert found.known.scale == "inertia"
    whole, values = INERTIA + ARMATURE, found.best.values
    assert values["f_k"] == pytest.approx(F_K / whole, rel=0.1)
    assert np.hypot(values["sine"], values["cosine"]) == pytest.approx(GRAVITY / whole, rel=0.1)
