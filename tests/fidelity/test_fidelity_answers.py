"""Exact answers of the scenarios against an integration that knows only the equation of motion."""

from dataclasses import replace

import numpy as np
import pytest
from fidelity_draws import drawn_suites, integrated

from harness.core.errors import InputError
from harness.core.scenario import Belt, Harmonic, Scenario
from harness.fidelity.kind import OWN, kind_of, suite
from harness.fidelity.row import describe, measure_row, scenario_of
from harness.fidelity.scenarios import belt, harmonic
from harness.fidelity.scenarios.harmonic import PERIODS

DRAWN = list(drawn_suites(31, 6))


@pytest.mark.parametrize("scenario", DRAWN, ids=lambda one: one.name)
def test_exact_motion_agrees_with_integration(scenario: Scenario) -> None:
    t = np.linspace(0.0, scenario.duration, 400)
    exact = kind_of(scenario).exact(scenario, t)
    size = max(np.abs(exact.x).max(), scenario.slider.x_k)
    assert np.abs(exact.x - integrated(scenario, t)).max() < 2e-8 * size


@pytest.mark.parametrize("scenario", DRAWN, ids=lambda one: one.name)
def test_metrics_of_the_exact_motion_are_the_exact_answers(scenario: Scenario) -> None:
    # a run long enough for every metric, sampled as an engine would at a fine step
    longer = scenario
    if isinstance(scenario.action, Belt):
        longer = belt.BELT.ride(scenario.slider, scenario.action.speed)
    if isinstance(scenario.action, Harmonic):
        longer = replace(harmonic.HARMONIC.shake(scenario.slider, scenario.action), name=scenario.name)
    t = np.linspace(0.0, longer.duration, 40_001)
    step = float(t[1])
    found = measure_row(kind_of(longer).exact(longer, t), longer)
    for name, truth in kind_of(longer).answers(longer).items():
        value = found[name]
        assert value is not None, name
        if name.endswith("fraction"):
            assert value == pytest.approx(truth, abs=4.0 * step / longer.duration * PERIODS), name
        elif name == "x_k_m":
            assert value == pytest.approx(truth, abs=1e-6), name
        else:
            assert value == pytest.approx(truth, rel=2e-4, abs=1e-9 + (step if name == "stick_time_s" else 0.0)), name


@pytest.mark.parametrize("scenario", DRAWN, ids=lambda one: one.name)
def test_a_scenario_survives_being_written_down(scenario: Scenario) -> None:
    assert scenario_of(describe(scenario)) == scenario


def test_the_checked_cases() -> None:
    answers = {name: kind_of(one).answers(one) for name, one in suite("joint").items()}
    riding, forced = answers["belt"], answers["harmonic"]
    assert riding["period_s"] == pytest.approx(0.6658, abs=5e-5)
    assert riding["near_belt_fraction"] == pytest.approx(0.286, abs=5e-4)
    assert riding["stick_fraction"] == pytest.approx(0.2830, abs=5e-5)
    assert forced["amplitude_m"] == pytest.approx(0.262610, abs=1e-6)
    assert forced["stop_fraction"] == 0.0
    assert 0.3 < answers["harmonic-stops"]["stop_fraction"] < 0.4


def test_contact_scenarios_are_those_of_the_joint_on_a_smaller_scale() -> None:
    joint, contact = suite("joint"), suite("contact")
    assert set(joint) < set(contact)
    for name in ("free-decay", "harmonic", "harmonic-stops"):
        large, small = (kind_of(one).answers(one) for one in (joint[name], contact[name]))
        assert contact[name].slider.x_k == pytest.approx(0.1 * joint[name].slider.x_k)
        for metric in ("amplitude_m", "x_k_m"):
            if metric in large:
                assert small[metric] == pytest.approx(0.1 * large[metric], rel=1e-9)


def test_a_run_that_does_not_start_riding_has_no_exact_motion_here() -> None:
    scenario = Scenario("belt", OWN.sticky, 0.0, 0.0, 1.0, Belt(0.1))
    with pytest.raises(InputError, match="does not ride with the belt"):
        kind_of(scenario).exact(scenario, np.linspace(0.0, 1.0, 10))
