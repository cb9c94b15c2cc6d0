"""Free decays: a release, with or without dry friction."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import final

from harness.core.arrays import FloatArray
from harness.core.scenario import Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.exact.decay import Decay, free_decay, never_sticks, schedule, until_rest
from harness.fidelity import kind as suite
from harness.fidelity.metrics import measure_decay


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class DecayKind(suite.Kind):
    """A release from rest.

    duration : s, in a suite; it should leave time at rest, in which creep shows. shown : s, of harness run.
    friction, reach : dry friction and release over those of the suite's slider.
    """

    duration: float
    shown: float
    friction: float = 1.0
    reach: float = 1.0

    def of_suite(self, sliders: suite.Sliders, scale: float) -> Scenario:
        slider = suite.scaled(suite.scaled(sliders.decay, scale), self.friction)
        return self.release(slider, suite.plain(suite.plain(scale * sliders.x0) * self.reach))

    def release(self, slider: Slider, x0: float, duration: float | None = None) -> Scenario:
        """The scenario of a slider that has the right friction already; x0 in m, duration in s."""
        return Scenario(self.name, slider, x0, 0.0, self.duration if duration is None else duration)

    def chosen(self, given: Mapping[str, float]) -> Scenario:
        """See Kind.chosen; with values of its own it lasts a fifth longer than it takes to stick, or ten periods."""
        values = suite.VALUES if self.friction > 0.0 else ("m", "c", "k")
        suite.only(self.name, given, (*values, "x0", "v0", "duration"))
        own = replace(self.of_suite(suite.OWN, suite.scale_of(self.routes[0])), duration=self.shown)
        if not given:
            return own
        slider, x0, v0 = suite.with_values(own.slider, given), given.get("x0", own.x0), given.get("v0", own.v0)
        duration = given["duration"] if "duration" in given else until_rest(Decay.of(slider, x0, v0))
        return Scenario(self.name, slider, x0, v0, duration)

    def exact(self, scenario: Scenario, t: FloatArray) -> Trajectory:
        """See Kind.exact; a closed form."""
        return free_decay(scenario, t)

    def answers(self, scenario: Scenario) -> suite.Answers:
        slider = scenario.slider
        known = {"x_k_m": slider.x_k, "zeta": slider.zeta, "x_k_local_m": slider.x_k}
        start = Decay.of_scenario(scenario)
        if not never_sticks(start):
            found = schedule(start, scenario.duration)
            if found.stick_time is not None:
                halves = float(len(found.turning_points) - 1)
                known |= {"stick_time_s": float(found.stick_time), "half_cycles": halves, "creep_m_s": 0.0}
        return known

    def measure(self, trace: Trajectory, scenario: Scenario) -> suite.Metrics:
        return measure_decay(trace, scenario)


FREE_DECAY = DecayKind(
    name="free-decay",
    place=0,
    duration=3.5,
    shown=3.0,
    figures=(
        suite.Figure(
            "position", "max_error_m", suite.release, "position error, over the release; at best the integrator's"
        ),
        suite.Figure("x_k wide", "x_k_rel_error", suite.one, "friction as read outside a guard at each reversal"),
        suite.Figure("x_k narrow", "x_k_local_rel_error", suite.one, "friction as read at the reversal itself"),
        suite.Figure("zeta", "zeta_rel_error", suite.one, "damping ratio as the estimator reads it"),
        suite.Figure("lead", "reversal_lead_s", suite.period, "friction reverses before the speed, over the period"),
        suite.Figure("rest", "rest_error_m", suite.x_k, "place of rest, over x_k"),
        suite.Figure("energy", "energy_error", suite.one, "largest error of the energy balance, over the start's"),
        suite.Figure("lift", "lift_m", suite.release, "contact: height over the floor, over the release"),
    ),
)
"""The paper's case: a release with viscous and dry friction."""

FREE_DECAY_NO_FRICTION = DecayKind(
    name="free-decay-no-friction",
    place=1,
    duration=3.0,
    shown=3.0,
    friction=0.0,
    figures=(
        suite.Figure("integrator", "max_error_m", suite.release, "position error without friction, over the release"),
    ),
)
"""The same slider without dry friction: what the integrator alone gets wrong."""

FREE_DECAY_X3, FREE_DECAY_X10 = (
    DecayKind(name=f"free-decay-x{n:g}", place=place, duration=3.5, shown=3.5, friction=n, reach=n, routes=("contact",))
    for n, place in ((3.0, 7), (10.0, 8))
)
"""A box on the floor, let go so many times as far away with as many times the friction, until it lifts."""
