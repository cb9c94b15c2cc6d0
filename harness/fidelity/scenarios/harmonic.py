"""A harmonic force, with and without stops: exact motion, and what is measured of it."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.events import Mode
from harness.core.scenario import Harmonic, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.exact.harmonic import driven, response
from harness.fidelity import kind as suite
from harness.fidelity.metrics import highest

LAST = 4
"""Periods at the end of a run that are measured."""


def measure_harmonic(trace: Trajectory, omega: float) -> dict[str, float | None]:
    """Every metric of a run under a force of this frequency (rad/s)."""
    inside = last_periods(trace, omega)
    return {"amplitude_m": amplitude_m(trace, inside), "stop_fraction": stop_fraction(trace, inside)}


def last_periods(trace: Trajectory, omega: float) -> list[IntArray]:
    """Indices of the samples of each of the last whole periods."""
    period = 2.0 * math.pi / omega
    whole = math.floor(trace.duration / period * (1.0 + 1e-9))
    starts = [k * period for k in range(max(0, whole - LAST), whole)]
    late = 1e-9 * period
    return [np.flatnonzero((trace.t >= start - late) & (trace.t < start + period - late)) for start in starts]


def amplitude_m(trace: Trajectory, inside: list[IntArray]) -> float | None:
    """Half of the distance between the turning points in m, mean over the last periods. Good: Den Hartog's."""
    if not inside:
        return None
    return float(np.mean([0.5 * (highest(trace.x[one]) + highest(-trace.x[one])) for one in inside]))


def stop_fraction(trace: Trajectory, inside: list[IntArray]) -> float | None:
    """Share of the last periods in which the friction force is not at its limit: the slider stops, or creeps.

    Good: the exact share, 0 where the motion has no stops.
    """
    if trace.mode is None or not inside:
        return None
    return float(np.mean(trace.mode[np.concatenate(inside)] == int(Mode.STICK)))


PERIODS = 10


@final
@dataclass(frozen=True, slots=True, kw_only=True)
class HarmonicKind(suite.Kind):
    """Ten periods, started on the exact periodic motion, so that a run shows what an engine makes of it.

    drive : which of a suite's forces.
    """

    drive: Callable[[suite.Sliders], Harmonic]

    def of_suite(self, sliders: suite.Sliders, scale: float) -> Scenario:
        drive = self.drive(sliders)
        force = Harmonic(suite.plain(scale * drive.amplitude), drive.omega)
        return self.shake(suite.scaled(sliders.driven, scale), force)

    def shake(self, slider: Slider, drive: Harmonic, periods: int = PERIODS) -> Scenario:
        """The scenario of a slider under a force."""
        start = response(slider, drive).motion.table[0]
        duration = periods * 2.0 * math.pi / drive.omega
        return Scenario(self.name, slider, float(start[1]), float(start[2]), duration, drive)

    def chosen(self, given: Mapping[str, float]) -> Scenario:
        suite.only(self.name, given, (*suite.VALUES, "duration"))
        found = self.shake(suite.with_values(suite.OWN.driven, given), self.drive(suite.OWN))
        return replace(found, duration=given.get("duration", found.duration))

    def exact(self, scenario: Scenario, t: FloatArray) -> Trajectory:
        # the motion is followed a little beyond the last sample
        end = float(t[-1]) + 1e-9
        return driven(scenario.slider, force_of(scenario), scenario.x0, scenario.v0, end).sample(t)

    def answers(self, scenario: Scenario) -> suite.Answers:
        found = response(scenario.slider, force_of(scenario))
        return {"amplitude_m": found.amplitude, "stop_fraction": found.stop_fraction}

    def measure(self, trace: Trajectory, scenario: Scenario) -> suite.Metrics:
        return measure_harmonic(trace, force_of(scenario).omega)


def force_of(scenario: Scenario) -> Harmonic:
    assert isinstance(scenario.action, Harmonic)
    return scenario.action


HARMONIC = HarmonicKind(
    name="harmonic",
    place=5,
    drive=lambda sliders: sliders.drive,
    figures=(
        suite.Figure("forced", "amplitude_m", suite.exact("amplitude_m"), "amplitude without stops (Den Hartog)"),
    ),
)
"""Den Hartog's case of a harmonic force, without stops."""

HARMONIC_STOPS = HarmonicKind(
    name="harmonic-stops",
    place=6,
    drive=lambda sliders: sliders.stopping,
    figures=(
        suite.Figure("forced, stops", "amplitude_m", suite.exact("amplitude_m"), "amplitude with two stops a period"),
        suite.Figure("stop share", "stop_fraction", suite.one, "share of the period that stops, difference"),
    ),
)
"""A weaker and slower harmonic force: the slider stops twice a period."""
