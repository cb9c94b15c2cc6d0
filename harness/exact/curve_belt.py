"""Stick-slip on a belt whose friction is a curve over the sliding speed.

From break-away on the slip is a smooth equation, which is integrated once to twelve digits; its end is the root of the
sliding speed. What sticks again is loaded at the speed of the belt, as on any belt.
"""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.scenario import CurveBelt
from harness.core.slider import Slider
from harness.exact.belt import LimitCycle, SteadySliding

LONGEST = 10.0
"""Undamped periods within which a slip that ends has ended."""
RTOL, ATOL = 1e-12, 1e-16


def curve_cycle(slider: Slider, belt: CurveBelt) -> LimitCycle | SteadySliding:
    """The cycle of a slider that once stuck to the belt, or steady sliding when it never catches up with it again."""
    speed, f_s, f_k = belt.speed, slider.break_away, slider.f_k
    start = (f_s - slider.c * speed) / slider.k

    def acceleration(x: float, w: float) -> float:
        """w : by how much it is slower than the belt, m/s."""
        drag = f_k + (f_s - f_k) * math.exp(-((w / belt.v_s) ** 2)) + w * w * (belt.c_2 + belt.c_3 * w)
        return (drag - slider.c * (speed - w) - slider.k * x) / slider.m

    def slide(_: float, state: FloatArray) -> tuple[float, float]:
        return speed - state[1], -acceleration(state[0], state[1])

    def caught(_: float, state: FloatArray) -> float:
        return float(state[1])

    def turned(_: float, state: FloatArray) -> float:
        return float(state[1] - speed)

    caught.terminal, caught.direction = True, -1.0  # type: ignore[attr-defined]
    span = (0.0, LONGEST * 2.0 * math.pi / slider.omega_n)
    # imported when it is needed: it brings half of its library along
    from scipy.integrate import solve_ivp

    run = solve_ivp(
        slide, span, (start, 0.0), "DOP853", events=(caught, turned), rtol=RTOL, atol=ATOL, dense_output=True
    )
    ends, turns = run.t_events[0], run.y_events[1]
    if not ends.size or len(turns) < 2:
        rest = (
            f_k + (f_s - f_k) * math.exp(-((speed / belt.v_s) ** 2)) + speed**2 * (belt.c_2 + belt.c_3 * speed)
        ) / slider.k
        return SteadySliding(rest, "the slip stays slower than the belt")

    def path(tau: float) -> tuple[float, float, float]:
        x, w = map(float, run.sol(tau))
        return x, speed - w, acceleration(x, w)

    slip, end = float(ends[0]), float(run.y_events[0][0, 0])
    slow = float(run.t[np.argmax(run.y[1])])
    highest, lowest = float(np.max(turns[:, 0])), float(np.min(turns[:, 0]))
    return LimitCycle(speed, path, slow, slip, (start - end) / speed, start, end, highest, lowest)
