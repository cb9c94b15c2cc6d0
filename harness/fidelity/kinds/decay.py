"""Free decays: a release, with or without dry friction."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import final

from harness.core.arrays import FloatArray
from harness.core.scenario import Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.exact.decay import Decay, free_decay, never_sticks, schedule
from harness.exact.duration import until_rest
from harness.fidelity.kind import Answers, Kind, Metrics
from harness.fidelity.metrics.decay import measure_decay
from harness.fidelity.sliders import OWN, VALUES, Sliders, only, plain, scale_of, scaled, with_values


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class DecayKind(Kind):
    """A release from rest.

    duration : s, in a suite; it should leave time at rest, in which creep shows. shown : s, of harness run.
    friction, reach : dry friction and release over those of the suite's slider.
    """

    duration: float
    shown: float
    friction: float = 1.0
    reach: float = 1.0

    def of_suite(self, sliders: Sliders, scale: float) -> Scenario:
        """See Kind.of_suite."""
        slider = scaled(scaled(sliders.decay, scale), self.friction)
        return self.release(slider, plain(plain(scale * sliders.x0) * self.reach))

    def release(self, slider: Slider, x0: float, duration: float | None = None) -> Scenario:
        """The scenario of a slider that has the right friction already; x0 in m, duration in s."""
        return Scenario(self.name, slider, x0, 0.0, self.duration if duration is None else duration)

    def chosen(self, given: Mapping[str, float]) -> Scenario:
        """See Kind.chosen; with values of its own it lasts a fifth longer than it takes to stick, or ten periods."""
        values = VALUES if self.friction > 0.0 else ("m", "c", "k")
        only(self.name, given, (*values, "x0", "v0", "duration"))
        own = replace(self.of_suite(OWN, scale_of(self.routes[0])), duration=self.shown)
        if not given:
            return own
        slider, x0, v0 = with_values(own.slider, given), given.get("x0", own.x0), given.get("v0", own.v0)
        duration = given["duration"] if "duration" in given else until_rest(Decay.of(slider, x0, v0))
        return Scenario(self.name, slider, x0, v0, duration)

    def exact(self, scenario: Scenario, t: FloatArray) -> Trajectory:
        """See Kind.exact; a closed form."""
        return free_decay(scenario, t)

    def answers(self, scenario: Scenario) -> Answers:
        """See Kind.answers."""
        slider = scenario.slider
        known = {"x_k_m": slider.x_k, "zeta": slider.zeta}
        start = Decay.of_scenario(scenario)
        if not never_sticks(start):
            found = schedule(start, scenario.duration)
            if found.stick_time is not None:
                halves = float(len(found.turning_points) - 1)
                known |= {"stick_time_s": float(found.stick_time), "half_cycles": halves, "creep_m_s": 0.0}
        return known

    def measure(self, trace: Trajectory, scenario: Scenario) -> Metrics:
        """See Kind.measure."""
        return measure_decay(trace, scenario)
