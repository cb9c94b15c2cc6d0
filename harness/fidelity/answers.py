"""What the exact motion of a scenario gives for the metrics, and the motion itself for overlays."""

from collections.abc import Callable

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.events import Events, Mode
from harness.core.scenario import Belt, Harmonic, Hold, Scenario
from harness.core.trajectory import Source, Trajectory
from harness.exact import hold
from harness.exact.decay import Decay, free_decay, never_sticks, schedule
from harness.exact.harmonic import driven
from harness.fidelity.cases import cycle_of, response_of

Answers = dict[str, float]

NEAR = 0.01
"""Speeds within this share of the belt's count as riding along (near_belt_fraction)."""


def exact_answers(scenario: Scenario) -> Answers:
    """Exact values of the metrics that have one, by their names; the others are errors, whose exact value is 0.

    Raises InputError where the scenario has no such motion (a belt without stick-slip).
    """
    return _ANSWERS[type(scenario.action)](scenario)


def _decay(scenario: Scenario) -> Answers:
    slider = scenario.slider
    known = {"x_k_m": slider.x_k, "zeta": slider.zeta}
    start = Decay.of_scenario(scenario)
    if not never_sticks(start):
        found = schedule(start, scenario.duration)
        if found.stick_time is not None:
            halves = float(len(found.turning_points) - 1)
            known |= {"stick_time_s": float(found.stick_time), "half_cycles": halves, "creep_m_s": 0.0}
    return known


def _hold(scenario: Scenario) -> Answers:
    assert isinstance(scenario.action, Hold)
    return {"creep_m_s": hold.creep(scenario.slider, scenario.action)}


def _belt(scenario: Scenario) -> Answers:
    assert isinstance(scenario.action, Belt)
    speed = scenario.action.speed
    cycle = cycle_of(scenario.slider, speed)
    return {
        "period_s": cycle.period,
        "stick_fraction": cycle.stick_fraction,
        "near_belt_fraction": cycle.fraction_within(NEAR * speed),
        "amplitude_m": cycle.amplitude,
        "stick_deviation_m_s": 0.0,
    }


def _harmonic(scenario: Scenario) -> Answers:
    assert isinstance(scenario.action, Harmonic)
    found = response_of(scenario.slider, scenario.action)
    return {"amplitude_m": found.amplitude, "stop_fraction": found.stop_fraction}


_ANSWERS: dict[type, Callable[[Scenario], Answers]] = {
    type(None): _decay,
    Hold: _hold,
    Belt: _belt,
    Harmonic: _harmonic,
}


def exact_motion(scenario: Scenario, t: FloatArray) -> Trajectory:
    """The exact motion at times ``t`` (n,) in s from 0 on.

    Raises InputError for a belt or a force under which a scenario does not start on the motion this room knows.
    """
    action = scenario.action
    if action is None:
        return free_decay(scenario, t)
    if isinstance(action, Harmonic):
        return driven(scenario.slider, action, scenario.x0, scenario.v0, float(t[-1]) + 1e-9).sample(t)
    if isinstance(action, Hold):
        hold.creep(scenario.slider, action)
        still = np.zeros_like(t)
        mode = np.full(t.size, int(Mode.STICK), dtype=np.int8)
        force = np.full(t.size, action.force)
        return Trajectory(t, still + scenario.x0, still, still, Source("reference", "exact"), force, mode)
    cycle = cycle_of(scenario.slider, action.speed)
    waited = (scenario.x0 - cycle.stick_x) / action.speed
    if scenario.v0 != action.speed or not 0.0 <= waited <= cycle.stick_time:
        raise InputError("belt", "a start that does not ride with the belt", "a start within the stick is accepted")
    begun = cycle.slip_time + waited
    found = cycle.sample(t + begun)
    shifted = Events(
        found.events.t - begun, found.events.kind, found.events.x, found.events.a_before, found.events.a_after
    )
    return Trajectory(t, found.x, found.v, found.a, found.source, mode=found.mode, events=shifted)
