"""Stick-slip on a belt."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import final

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.scenario import Belt, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.exact.belt import LimitCycle, limit_cycle
from harness.fidelity.kind import Answers, Kind, Metrics
from harness.fidelity.metrics.belt import NEAR, measure_belt
from harness.fidelity.sliders import OWN, VALUES, Sliders, only, with_values

PERIODS = 8


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class BeltKind(Kind):
    """Eight periods of stick-slip, started half way through a stick."""

    def of_suite(self, sliders: Sliders, scale: float) -> Scenario:
        """See Kind.of_suite; the motion is slow enough for a box, so that it is the same on every route."""
        return self.ride(sliders.sticky, sliders.belt_speed)

    def ride(self, slider: Slider, speed: float, periods: int = PERIODS) -> Scenario:
        """The scenario of a slider on a belt of this speed (m/s).

        Raises InputError when the slider does not stick and slip at this speed.
        """
        cycle = cycle_of(slider, speed)
        start = cycle.stick_x + 0.5 * speed * cycle.stick_time
        return Scenario(self.name, slider, start, speed, periods * cycle.period, Belt(speed))

    def chosen(self, given: Mapping[str, float]) -> Scenario:
        """See Kind.chosen."""
        only(self.name, given, (*VALUES, "duration"))
        found = self.ride(with_values(OWN.sticky, given), OWN.belt_speed)
        return replace(found, duration=given.get("duration", found.duration))

    def exact(self, scenario: Scenario, t: FloatArray) -> Trajectory:
        """See Kind.exact."""
        speed = belt_speed(scenario)
        cycle = cycle_of(scenario.slider, speed)
        waited = (scenario.x0 - cycle.stick_x) / speed
        if scenario.v0 != speed or not 0.0 <= waited <= cycle.stick_time:
            raise InputError("belt", "a start that does not ride with the belt", "a start within the stick is accepted")
        ahead = cycle.slip_time + waited
        found = cycle.sample(t + ahead)
        return replace(found, t=t, events=replace(found.events, t=found.events.t - ahead))

    def answers(self, scenario: Scenario) -> Answers:
        """See Kind.answers."""
        speed = belt_speed(scenario)
        cycle = cycle_of(scenario.slider, speed)
        return {
            "period_s": cycle.period,
            "stick_fraction": cycle.stick_fraction,
            "near_belt_fraction": cycle.fraction_within(NEAR * speed),
            "amplitude_m": cycle.amplitude,
            "stick_deviation_m_s": 0.0,
        }

    def measure(self, trace: Trajectory, scenario: Scenario) -> Metrics:
        """See Kind.measure."""
        return measure_belt(trace, belt_speed(scenario))


def belt_speed(scenario: Scenario) -> float:
    """Speed of the belt, m/s."""
    assert isinstance(scenario.action, Belt)
    return scenario.action.speed


def cycle_of(slider: Slider, speed: float) -> LimitCycle:
    """The exact cycle; raises InputError with the reason when there is none."""
    cycle = limit_cycle(slider, speed)
    if not isinstance(cycle, LimitCycle):
        raise InputError("belt", f"no stick-slip ({cycle.why})", "a slider with f_s > f_k on a slow belt is accepted")
    return cycle
