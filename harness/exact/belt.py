"""A slider on a belt that moves at constant speed: the stick-slip limit cycle.

The slider rides with the belt until its spring and damper pull with f_s, slips back against friction, and sticks again
when its speed meets the belt's. Against f_k the slip is linear, and only the time of the next stick is the root of a
transcendental equation. Against a curve over the sliding speed the slip is a smooth equation, which is integrated once
to twelve digits; its end is the root of the sliding speed.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.checks import increasing, positive, vector
from harness.core.events import EventKind, Events, Mode
from harness.core.scenario import CurveBelt
from harness.core.slider import Slider
from harness.core.trajectory import Source, Trajectory
from harness.exact.segments import discriminant, flow

Path: TypeAlias = Callable[[float], tuple[float, float, float]]
"""x (m), v (m/s), a (m/s^2) at a time in s after break-away, while it slips."""


@dataclass(frozen=True, slots=True)
class SteadySliding:
    """No stick-slip: the slider rests at x (m) while the belt slides under it. why : one clause."""

    x: float
    why: str


@dataclass(frozen=True, slots=True)
class LimitCycle:
    """Stick-slip; time 0 is a break-away.

    belt_speed : m/s. path : of the slip, a time of which when it is slower than near the belt's speed is ``slow`` (s).
    slip_time, stick_time : s. break_away_x, stick_x : positions in m where it lets go and where it sticks. highest,
    lowest : turning points of x in m.
    """

    belt_speed: float
    path: Path = field(repr=False)
    slow: float
    slip_time: float
    stick_time: float
    break_away_x: float
    stick_x: float
    highest: float
    lowest: float

    @property
    def period(self) -> float:
        """Time from one break-away to the next, s."""
        return self.slip_time + self.stick_time

    @property
    def stick_fraction(self) -> float:
        """Share of the period in which the slider rides with the belt."""
        return self.stick_time / self.period

    @property
    def amplitude(self) -> float:
        """Half of the distance between the turning points, m."""
        return 0.5 * (self.highest - self.lowest)

    def fraction_within(self, tolerance: float) -> float:
        """Share of the period in which v is within ``tolerance`` >= 0 (m/s) of the belt's speed.

        A count of samples with a threshold measures this, and more than ``stick_fraction``: the slip begins and ends
        slowly. With 1 mm/s, f_s = 4, f_k = 3, v_b = 0.1, c = 0.2, m = 1, k = 100 gives 0.286 where 0.283 is stuck.
        """
        level = self.belt_speed - tolerance
        if self.path(self.slow)[1] >= level:
            return 1.0
        away = crossing(self.path, level, self.slow, 0.0)
        back = crossing(self.path, level, self.slow, self.slip_time)
        return 1.0 - (back - away) / self.period

    def sample(self, t: FloatArray) -> Trajectory:
        """The cycle at increasing times ``t`` (s), break-away at every whole period; mode is that of v - belt_speed."""
        times = vector("belt: t", t)
        increasing("belt: t", times)
        phase = np.mod(times, self.period)
        slips = phase < self.slip_time
        x = self.stick_x + self.belt_speed * (phase - self.slip_time)
        v, a = np.full_like(x, self.belt_speed), np.zeros_like(x)
        for j in np.flatnonzero(slips):
            x[j], v[j], a[j] = self.path(float(phase[j]))
        mode = np.where(slips, int(Mode.SLIP_NEGATIVE), int(Mode.STICK)).astype(np.int8)
        source = Source("reference", "exact")
        return Trajectory(times, x, v, a, source, mode=mode, events=self._events(float(times[0]), float(times[-1])))

    def _events(self, begin: float, end: float) -> Events:
        first, last = math.floor(begin / self.period), math.ceil(end / self.period)
        starts = self.period * np.arange(first, last + 1)
        after, before = self.path(0.0)[2], self.path(self.slip_time)[2]
        t = np.column_stack((starts, starts + self.slip_time)).ravel()
        inside = (t >= begin) & (t <= end)
        n = starts.size
        kind = np.tile([int(EventKind.BREAK_AWAY), int(EventKind.STICK)], n)
        x = np.tile([self.break_away_x, self.stick_x], n)
        a_before, a_after = np.tile([0.0, before], n), np.tile([after, 0.0], n)
        return Events(t[inside], kind[inside], x[inside], a_before[inside], a_after[inside])


def _slip(slider: Slider, x: float, v: float, tau: float) -> tuple[float, float, float]:
    """x, v, a at ``tau`` (s) into a slip that began at x, v and is slower than the belt."""
    omega2, sigma = slider.omega_n**2, slider.zeta * slider.omega_n
    c, s = flow(tau, slider.omega_n, sigma, discriminant(slider.omega_n, slider.zeta))
    y = x - slider.x_k
    at, speed = y * c + (v + sigma * y) * s, v * c - (omega2 * y + sigma * v) * s
    return slider.x_k + at, speed, -2.0 * sigma * speed - omega2 * at


def _slowest(slider: Slider, speed: float) -> float:
    """Time in s after break-away when the slip is slowest: the first zero of its acceleration."""
    drop = (slider.break_away - slider.f_k) / slider.m  # the deceleration at break-away
    sigma = slider.zeta * slider.omega_n
    return math.atan2(drop * slider.omega_d, sigma * drop - slider.omega_n**2 * speed) / slider.omega_d


def crossing(path: Path, level: float, below: float, above: float) -> float:
    """When the slip's speed crosses ``level`` (m/s), below which it is at one of the times (s), to the last bit."""
    while True:
        middle = 0.5 * (below + above)
        if middle in (below, above):
            return above
        if path(middle)[1] < level:
            below = middle
        else:
            above = middle


def limit_cycle(slider: Slider, belt_speed: float) -> LimitCycle | SteadySliding:
    """The stick-slip cycle on a belt with ``belt_speed`` > 0 (m/s), or steady sliding when there is none.

    Steady sliding is stable for c > 0 also where the cycle exists: the cycle is what a slider that once stuck does.
    """
    speed = positive("belt: speed", belt_speed, "m/s")
    if slider.break_away == slider.f_k:
        return SteadySliding(slider.x_k, "f_s does not exceed f_k")
    if slider.zeta >= 1.0:
        return SteadySliding(slider.x_k, "the slider is not underdamped")
    omega_d = slider.omega_d
    sigma = slider.zeta * slider.omega_n
    start = (slider.break_away - slider.c * speed) / slider.k
    # a = 0 first at the lowest speed, half a damped period later at the highest
    low = _slowest(slider, speed)
    high = low + math.pi / omega_d
    path = partial(_slip, slider, start, speed)
    if path(high)[1] < speed:
        return SteadySliding(slider.x_k, "viscous damping keeps the slip slower than the belt")
    slip = crossing(path, speed, low, high)
    end = path(slip)[0]
    # v = 0 at the highest point, half a damped period later at the lowest
    push = slider.omega_n**2 * (start - slider.x_k) + sigma * speed
    top = math.atan2(speed * omega_d, push) / omega_d
    highest, lowest = path(top)[0], path(top + math.pi / omega_d)[0]
    return LimitCycle(speed, path, low, slip, (start - end) / speed, start, end, highest, lowest)


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
