"""What several test files of the fidelity suite share."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from harness.core.arrays import FloatArray
from harness.core.scenario import Belt, Harmonic, Hold, Scenario
from harness.core.slider import Slider
from harness.fidelity.scenarios.belt import BELT
from harness.fidelity.scenarios.decay import FREE_DECAY, FREE_DECAY_NO_FRICTION
from harness.fidelity.scenarios.harmonic import HARMONIC, HARMONIC_STOPS
from harness.fidelity.scenarios.hold import HOLD_97


def drawn_suites(seed: int, count: int) -> Iterator[Scenario]:
    """Scenarios of random sliders, of every kind that the suite has."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        m, omega = float(np.exp(rng.uniform(-1.0, 1.0))), float(rng.uniform(4.0, 20.0))
        k, zeta = m * omega**2, float(rng.uniform(0.0, 0.1))
        slider = Slider(m, 2.0 * zeta * m * omega, k, float(k * rng.uniform(0.02, 0.06)))
        yield FREE_DECAY.release(slider, float(rng.choice([-1.0, 1.0])), 20.0 / omega)
        yield FREE_DECAY_NO_FRICTION.release(replace(slider, f_k=0.0, f_s=0.0), 0.5, 20.0 / omega)
        sticky = Slider(m, slider.c, k, slider.f_k, slider.f_k * float(rng.uniform(1.2, 1.8)))
        yield BELT.ride(sticky, float(0.3 * slider.x_k * omega * rng.uniform(0.3, 1.0)), 3)
        ratio = float(rng.uniform(0.5, 0.9))
        yield HARMONIC.shake(slider, Harmonic(slider.f_k * float(rng.uniform(2.0, 5.0)), ratio * omega), 3)
        yield HARMONIC_STOPS.shake(slider, Harmonic(slider.f_k * float(rng.uniform(1.2, 1.7)), 0.4 * omega), 2)
        yield HOLD_97.load(slider)


def integrated(scenario: Scenario, times: FloatArray) -> FloatArray:
    """x at ``times`` (s) from scipy, phase by phase: slip one way, slip the other, stick; knows only the equation."""
    slider, action = scenario.slider, scenario.action
    belt = action.speed if isinstance(action, Belt) else 0.0

    def force(t: float) -> float:
        if isinstance(action, Harmonic):
            return action.amplitude * math.cos(action.omega * t + action.phase)
        return action.force if isinstance(action, Hold) else 0.0

    def pull(t: float, x: float, v: float) -> float:
        return force(t) - slider.c * v - slider.k * x

    stride = 0.05 / slider.omega_n  # at rest the solver would step over a break-away
    out, t, x, v = np.empty(times.size), 0.0, scenario.x0, scenario.v0
    direction = (
        0.0 if v == belt and abs(pull(t, x, v)) <= slider.break_away else math.copysign(1.0, v - belt or pull(t, x, v))
    )
    end = float(times[-1])
    while True:
        rhs, leave = _phase(slider, force, pull, belt, direction)
        run = solve_ivp(
            rhs, (t, end), (x, v), "DOP853", events=leave, rtol=1e-11, atol=1e-13, dense_output=True, max_step=stride
        )
        here = (times >= t) & (times <= run.t[-1])
        out[here] = run.sol(times[here])[0]
        if run.status != 1:
            return out
        t, (x, v) = float(run.t[-1]), run.y[:, -1]
        if direction == 0.0:
            direction = math.copysign(1.0, pull(t, x, belt))
        else:
            v = belt
            left = pull(t, x, v)
            direction = 0.0 if abs(left) <= slider.break_away else math.copysign(1.0, left)


def _phase(
    slider: Slider, force: Callable[[float], float], pull: Callable[..., float], belt: float, direction: float
) -> tuple[Callable[..., tuple[float, float]], Callable[..., float]]:
    if direction == 0.0:

        def ride(t: float, s: FloatArray) -> tuple[float, float]:
            return belt, 0.0

        def lets_go(t: float, s: FloatArray) -> float:
            return slider.break_away - abs(pull(t, s[0], belt))

        lets_go.terminal, lets_go.direction = True, -1.0  # type: ignore[attr-defined]
        return ride, lets_go

    def slide(t: float, s: FloatArray) -> tuple[float, float]:
        return s[1], (pull(t, s[0], s[1]) - direction * slider.f_k) / slider.m

    def meets(t: float, s: FloatArray) -> float:
        return float(s[1] - belt)

    meets.terminal, meets.direction = True, -direction  # type: ignore[attr-defined]
    return slide, meets
