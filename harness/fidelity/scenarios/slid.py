"""Static holds that slide first: a load below break-away on a slider that comes to rest under it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.events import Mode
from harness.core.scenario import Hold, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Source, Trajectory
from harness.fidelity import kind as suite
from harness.fidelity.scenarios.hold import SOFT, creep_scale

RESTS = 0.5
"""s that it is held after the exact slider has stopped; creep is that of the later half."""


@dataclass(frozen=True, slots=True)
class Stop:
    """The exact slide: about ``centre`` (m) with ``omega`` (rad/s) until ``time`` (s)."""

    centre: float
    omega: float
    time: float

    @classmethod
    def of(cls, slider: Slider, force: float, speed: float) -> "Stop":
        """Of a slider let go at x = 0 with a speed (m/s) along a force (N)."""
        centre, omega = (force - slider.f_k) / slider.k, slider.omega_n
        return cls(centre, omega, math.atan2(speed, -centre * omega) / omega)

    def place(self, speed: float) -> float:
        """Where it stops, m."""
        return self.centre + math.hypot(self.centre, speed / self.omega)


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class SlidKind(suite.Kind):
    """A load of half of break-away on a slider that has a speed along it, ``share`` of x_k omega of the free decay.

    A line search that is cut off leaves what remains of the speed after whole steps of braking, so that several speeds
    are needed to see it; a hold from rest misses it.
    """

    share: float
    load: float = 0.5

    def of_suite(self, sliders: suite.Sliders, scale: float) -> Scenario:
        """See Kind.of_suite; on the floor forces and lengths are a tenth, since a fast box lifts."""
        slider = suite.scaled(sliders.decay, scale)
        soft = Slider(slider.m, 0.0, suite.plain(SOFT * slider.k), slider.f_k)
        return self.slide(soft, self.share * slider.x_k * slider.omega_n)

    def slide(self, slider: Slider, speed: float) -> Scenario:
        """The scenario of a slider that begins at a speed, m/s. Raises InputError where the spring pulls it back."""
        force = suite.plain(self.load * slider.f_k)
        stop = Stop.of(slider, force, speed)
        if slider.k * stop.place(speed) - force > slider.f_k:
            found = f"{speed:g} m/s, after which the spring pulls it back"
            raise InputError("--v0", found, "a lower speed, or a smaller k")
        duration = stop.time + RESTS
        return Scenario(self.name, slider, 0.0, suite.plain(speed), duration, Hold(force))

    def chosen(self, given: Mapping[str, float]) -> Scenario:
        suite.only(self.name, given, ("m", "k", "f_k", "v0"))
        own = self.of_suite(suite.OWN, 1.0)
        slider = suite.with_values(own.slider, given)
        if slider.f_k == 0.0:
            raise InputError("--f-k", "0, and nothing holds the slider", "friction above 0")
        speed = given.get("v0", own.v0)
        if speed <= 0.0:
            raise InputError("--v0", f"{speed:g} m/s", "a speed above 0")
        return self.slide(slider, speed)

    def exact(self, scenario: Scenario, t: FloatArray) -> Trajectory:
        """See Kind.exact; a part of a swing, then rest."""
        assert isinstance(scenario.action, Hold)
        stop = Stop.of(scenario.slider, scenario.action.force, scenario.v0)
        phase = stop.omega * np.minimum(t, stop.time)
        sine, cosine, moving = np.sin(phase), np.cos(phase), t < stop.time
        x = scenario.x0 + stop.centre * (1.0 - cosine) + scenario.v0 / stop.omega * sine
        v = np.where(moving, stop.centre * stop.omega * sine + scenario.v0 * cosine, 0.0)
        a = np.where(moving, stop.omega * (stop.centre * stop.omega * cosine - scenario.v0 * sine), 0.0)
        mode = np.where(moving, int(Mode.SLIP_POSITIVE), int(Mode.STICK)).astype(np.int8)
        return Trajectory(t, x, v, a, Source("reference", "exact"), np.full(t.size, scenario.action.force), mode)

    def answers(self, scenario: Scenario) -> suite.Answers:
        return {"creep_m_s": 0.0}

    def measure(self, trace: Trajectory, scenario: Scenario) -> suite.Metrics:
        """Creep in the later half of the rest, m/s, and where it ends beside the exact place, m."""
        late = int(np.searchsorted(trace.t, scenario.duration - 0.5 * RESTS))
        creep = float((trace.x[-1] - trace.x[late]) / (trace.t[-1] - trace.t[late]))
        return {"creep_m_s": creep, "rest_error_m": float(trace.x[-1] - self.exact(scenario, trace.t).x[-1])}


SLOW, MIDDLE, FAST = (
    SlidKind(
        name=name,
        place=place,
        share=share,
        part="trained",
        routes=("joint", "contact"),
        figures=(suite.Figure("creep", "creep_m_s", creep_scale, "creep in one period after a slide, over x_k"),),
    )
    for name, place, share in (("hold-slid-slow", 20, 0.31), ("hold-slid", 21, 0.77), ("hold-slid-fast", 22, 1.63))
)
"""Speeds of no common measure: 0.093, 0.231 and 0.489 m/s of the suite's own slider."""
