"""Stick-slip on a belt: its exact motion, and what is measured of it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import final

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.errors import InputError
from harness.core.events import Mode
from harness.core.scenario import Belt, CurveBelt, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.exact.belt import LimitCycle, curve_cycle, limit_cycle
from harness.fidelity import kind as suite
from harness.fidelity.metrics import falling

NEAR = 0.01
"""Speeds within this share of the belt's count as riding along (near_belt_fraction)."""
SKIPPED = 2
"""Slips at the start that are left out: an engine may still be settling into its own cycle."""


def measure_belt(trace: Trajectory, speed: float) -> dict[str, float | None]:
    """Every metric of a run on a belt of this speed (m/s); None where the trace has no such figure."""
    slips = slip_times(trace)
    inside = whole_cycles(trace, slips)
    return {
        "period_s": period_s(slips),
        "stick_fraction": stick_fraction(trace, inside),
        "near_belt_fraction": near_belt_fraction(trace, inside, speed),
        "stick_deviation_m_s": stick_deviation_m_s(trace, speed),
        "amplitude_m": amplitude_m(trace, inside),
    }


def slip_times(trace: Trajectory) -> FloatArray:
    """Times in s at which the slider slips back through the middle of its range: one a cycle, shape (n,).

    Positions are used because a contact that chatters during a slip turns its speed round many times.
    """
    middle = 0.5 * (float(np.max(trace.x)) + float(np.min(trace.x)))
    return falling(trace.t, trace.x - middle)[SKIPPED:]


def whole_cycles(trace: Trajectory, slips: FloatArray) -> IntArray:
    """Indices of the samples between the first and the last slip that count; none when there are not two."""
    if slips.size < 2:
        return np.empty(0, dtype=np.int64)
    return np.flatnonzero((trace.t >= slips[0]) & (trace.t < slips[-1]))


def period_s(slips: FloatArray) -> float | None:
    """Mean time from slip to slip in s; None with fewer than two slips. Good: the exact period within a step.

    An engine whose break-away is decided by a speed threshold does not converge to the exact period.
    """
    return float((slips[-1] - slips[0]) / (slips.size - 1)) if slips.size >= 2 else None


def stick_fraction(trace: Trajectory, inside: IntArray) -> float | None:
    """Share of whole cycles in which the friction force is not at its limit. Good: the exact share, 0.2830 here."""
    if trace.mode is None or not inside.size:
        return None
    return float(np.mean(trace.mode[inside] == int(Mode.STICK)))


def near_belt_fraction(trace: Trajectory, inside: IntArray, speed: float) -> float | None:
    """Share of whole cycles in which v is within 1 % of the belt's speed. Good: the exact share, 0.286 here.

    It exceeds the stick fraction, since a slip begins and ends slowly, and it needs no contact state.
    """
    if not inside.size:
        return None
    return float(np.mean(np.abs(trace.v[inside] - speed) <= NEAR * speed))


def stick_deviation_m_s(trace: Trajectory, speed: float) -> float | None:
    """Median |v - belt speed| in m/s over the samples that stick; None when none does. Good: below 1e-6."""
    if trace.mode is None:
        return None
    stuck = trace.mode == int(Mode.STICK)
    return float(np.median(np.abs(trace.v[stuck] - speed))) if stuck.any() else None


def amplitude_m(trace: Trajectory, inside: IntArray) -> float | None:
    """Half of the distance between the turning points in m. Good: the exact amplitude within a step of motion."""
    return float(0.5 * np.ptp(trace.x[inside])) if inside.size else None


PERIODS = 8


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class BeltKind(suite.Kind):
    """Eight periods of stick-slip, started half way through a stick.

    v_s : of a Stribeck curve, over the belt's speed; 0 for friction that jumps from f_s to f_k. viscous : what c_2 u|u|
    is at the speed of the belt over f_s - f_k; c_3 u^3 is 0.4 of it.
    """

    v_s: float = 0.0
    viscous: float = 0.0

    def of_suite(self, sliders: suite.Sliders, scale: float) -> Scenario:
        """See Kind.of_suite; the motion is slow enough for a box, so that it is the same on every route."""
        return self.ride(sliders.sticky, sliders.belt_speed)

    def ride(self, slider: Slider, speed: float, periods: int = PERIODS) -> Scenario:
        """The scenario of a slider on a belt of this speed (m/s).

        Raises InputError when the slider does not stick and slip at this speed.
        """
        belt = self._belt(slider, speed)
        cycle = cycle_of(slider, belt)
        start = cycle.stick_x + 0.5 * speed * cycle.stick_time
        return Scenario(self.name, slider, start, speed, periods * cycle.period, belt)

    def _belt(self, slider: Slider, speed: float) -> Belt:
        if not self.v_s:
            return Belt(speed)
        part = self.viscous * (slider.break_away - slider.f_k)
        c_2, c_3 = suite.plain(part / speed**2), suite.plain(0.4 * part / speed**3)
        return CurveBelt(speed, suite.plain(self.v_s * speed), c_2, c_3)

    def chosen(self, given: Mapping[str, float]) -> Scenario:
        suite.only(self.name, given, (*suite.VALUES, "duration"))
        found = self.ride(suite.with_values(suite.OWN.sticky, given), suite.OWN.belt_speed)
        return replace(found, duration=given.get("duration", found.duration))

    def exact(self, scenario: Scenario, t: FloatArray) -> Trajectory:
        speed = belt_speed(scenario)
        cycle = cycle_of(scenario.slider, belt_of(scenario))
        waited = (scenario.x0 - cycle.stick_x) / speed
        if scenario.v0 != speed or not 0.0 <= waited <= cycle.stick_time:
            raise InputError("belt", "a start that does not ride with the belt", "a start within the stick")
        ahead = cycle.slip_time + waited
        found = cycle.sample(t + ahead)
        return replace(found, t=t, events=replace(found.events, t=found.events.t - ahead))

    def answers(self, scenario: Scenario) -> suite.Answers:
        cycle = cycle_of(scenario.slider, belt_of(scenario))
        return {
            "period_s": cycle.period,
            "stick_fraction": cycle.stick_fraction,
            "near_belt_fraction": cycle.fraction_within(NEAR * cycle.belt_speed),
            "amplitude_m": cycle.amplitude,
            "stick_deviation_m_s": 0.0,
        }

    def measure(self, trace: Trajectory, scenario: Scenario) -> suite.Metrics:
        return measure_belt(trace, belt_speed(scenario))


def belt_of(scenario: Scenario) -> Belt:
    assert isinstance(scenario.action, Belt)
    return scenario.action


def belt_speed(scenario: Scenario) -> float:
    """Speed of the belt, m/s."""
    return belt_of(scenario).speed


@lru_cache(maxsize=64)
def cycle_of(slider: Slider, belt: Belt) -> LimitCycle:
    """The exact cycle; raises InputError with the reason when there is none."""
    cycle = curve_cycle(slider, belt) if isinstance(belt, CurveBelt) else limit_cycle(slider, belt.speed)
    if not isinstance(cycle, LimitCycle):
        raise InputError("belt", f"no stick-slip ({cycle.why})", "a slider with f_s > f_k on a slow belt")
    return cycle


BELT = BeltKind(
    name="belt",
    place=4,
    figures=(
        suite.Figure("belt period", "period_s", suite.exact("period_s"), "period of stick-slip"),
        suite.Figure("stick share", "stick_fraction", suite.one, "share of the period that sticks, difference"),
        suite.Figure(
            "stick speed", "stick_deviation_m_s", suite.speed_of_belt, "speed against the belt while it sticks"
        ),
    ),
)
"""Stick-slip on a belt."""

STRIBECK_BELT, POLYNOMIAL_BELT = (
    BeltKind(name=name, place=place, part="laws", v_s=0.5, viscous=viscous, figures=BELT.figures)
    for name, place, viscous in (("stribeck-belt", 8, 0.0), ("polynomial-belt", 9, 0.04))
)
"""Friction that falls from f_s with the sliding speed; the same with a polynomial of that speed beside it."""
