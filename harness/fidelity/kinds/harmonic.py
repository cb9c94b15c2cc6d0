"""Motion under a harmonic force, with and without stops."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import final

from harness.core.arrays import FloatArray
from harness.core.scenario import Harmonic, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.exact.harmonic import driven, response
from harness.fidelity.kind import Answers, Kind, Metrics
from harness.fidelity.metrics.harmonic import measure_harmonic
from harness.fidelity.sliders import OWN, VALUES, Sliders, only, plain, scaled, with_values

PERIODS = 10


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class HarmonicKind(Kind):
    """Ten periods, started on the exact periodic motion, so that a run shows what an engine makes of it.

    drive : which of a suite's forces.
    """

    drive: Callable[[Sliders], Harmonic]

    def of_suite(self, sliders: Sliders, scale: float) -> Scenario:
        """See Kind.of_suite."""
        drive = self.drive(sliders)
        force = Harmonic(plain(scale * drive.amplitude), drive.omega)
        return self.shake(scaled(sliders.driven, scale), force)

    def shake(self, slider: Slider, drive: Harmonic, periods: int = PERIODS) -> Scenario:
        """The scenario of a slider under a force."""
        start = response(slider, drive).motion.table[0]
        duration = periods * 2.0 * math.pi / drive.omega
        return Scenario(self.name, slider, float(start[1]), float(start[2]), duration, drive)

    def chosen(self, given: Mapping[str, float]) -> Scenario:
        """See Kind.chosen."""
        only(self.name, given, (*VALUES, "duration"))
        found = self.shake(with_values(OWN.driven, given), self.drive(OWN))
        return replace(found, duration=given.get("duration", found.duration))

    def exact(self, scenario: Scenario, t: FloatArray) -> Trajectory:
        """See Kind.exact."""
        # the motion is followed a little beyond the last sample
        end = float(t[-1]) + 1e-9
        return driven(scenario.slider, force_of(scenario), scenario.x0, scenario.v0, end).sample(t)

    def answers(self, scenario: Scenario) -> Answers:
        """See Kind.answers."""
        found = response(scenario.slider, force_of(scenario))
        return {"amplitude_m": found.amplitude, "stop_fraction": found.stop_fraction}

    def measure(self, trace: Trajectory, scenario: Scenario) -> Metrics:
        """See Kind.measure."""
        return measure_harmonic(trace, force_of(scenario).omega)


def force_of(scenario: Scenario) -> Harmonic:
    """The force of a scenario."""
    assert isinstance(scenario.action, Harmonic)
    return scenario.action
