"""Static holds: a constant load below break-away on a slider at rest."""

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
from harness.exact.decay import creep
from harness.fidelity import kind as suite


def creep_m_s(trace: Trajectory) -> float:
    """Mean velocity in m/s over the later half of the hold, when what a soft contact needs to build up is over.

    Good: 0. MuJoCo creeps at F (1 - d0)/(d0 b m), in proportion to the load.
    """
    half = len(trace) // 2
    return float((trace.x[-1] - trace.x[half]) / (trace.t[-1] - trace.t[half]))


def drift_m(trace: Trajectory) -> float:
    """Distance in m from the start at the end, elastic give included. Good: 0."""
    return float(trace.x[-1] - trace.x[0])


SOFT = 0.01
"""Stiffness of a hold over that of the free decay: creep must not unload it."""


def creep_scale(row: suite.Row) -> float:
    """x_k in a period of the free decay, to which the soft spring does not belong, m/s."""
    k = float(row["slider"]["k"]) / SOFT
    slider = {**row["slider"], "k": k}
    return suite.x_k({"slider": slider}) / suite.period({"slider": slider})


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class HoldKind(suite.Kind):
    """A load of ``share`` of break-away for half a second; the spring is soft, so that creep does not unload it."""

    share: float
    duration: float = 0.5

    def of_suite(self, sliders: suite.Sliders, scale: float) -> Scenario:
        """See Kind.of_suite; a box at rest does not lift, so friction is the same on every route."""
        slider = sliders.decay
        return self.load(Slider(slider.m, 0.0, suite.plain(SOFT * slider.k), slider.f_k))

    def load(self, slider: Slider, duration: float | None = None) -> Scenario:
        """The scenario of a slider; duration in s."""
        force = Hold(suite.plain(self.share * slider.break_away))
        return Scenario(self.name, slider, 0.0, 0.0, self.duration if duration is None else duration, force)

    def chosen(self, given: Mapping[str, float]) -> Scenario:
        suite.only(self.name, given, (*suite.VALUES, "duration"))
        slider = suite.with_values(self.of_suite(suite.OWN, 1.0).slider, given)
        if slider.break_away == 0.0:
            raise InputError("--f-k", "0, and nothing holds the slider", "friction above 0")
        return self.load(slider, given.get("duration"))

    def exact(self, scenario: Scenario, t: FloatArray) -> Trajectory:
        """See Kind.exact; nothing moves."""
        assert isinstance(scenario.action, Hold)
        creep(scenario.slider, scenario.action)
        still = np.zeros_like(t)
        mode = np.full(t.size, int(Mode.STICK), dtype=np.int8)
        force = np.full(t.size, scenario.action.force)
        return Trajectory(t, still + scenario.x0, still, still, Source("reference", "exact"), force, mode)

    def answers(self, scenario: Scenario) -> suite.Answers:
        assert isinstance(scenario.action, Hold)
        return {"creep_m_s": creep(scenario.slider, scenario.action)}

    def measure(self, trace: Trajectory, scenario: Scenario) -> suite.Metrics:
        return {"creep_m_s": creep_m_s(trace), "drift_m": drift_m(trace)}


HOLD_50, HOLD_97 = (
    HoldKind(
        name=f"hold-{100.0 * share:g}",
        place=place,
        share=share,
        figures=(
            suite.Figure(
                f"creep {100.0 * share:g} %",
                "creep_m_s",
                creep_scale,
                f"creep in one period at {said} of break-away, over x_k",
            ),
        ),
    )
    for share, place, said in ((0.5, 2, "half"), (0.97, 3, "97 %"))
)
"""Loads of half of break-away, and of 97 %."""
