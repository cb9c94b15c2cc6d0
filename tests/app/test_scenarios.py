"""Scenarios by name and parameters."""

import pytest

from harness.app.scenarios import scenario_json, scenario_named, scenario_of_json
from harness.core.errors import InputError
from harness.core.scenario import FREE_DECAY
from harness.exact.decay import Decay, schedule


def test_without_parameters_it_is_the_papers_case() -> None:
    assert scenario_named("free-decay", {"m": None, "x0": None}) == FREE_DECAY


def test_given_values_take_the_place_of_the_papers() -> None:
    scenario = scenario_named("free-decay", {"m": 2.42, "k": 2310.0, "c": 4.79, "f_k": 0.351, "x0": 0.01})
    assert (scenario.slider.m, scenario.slider.k, scenario.x0) == (2.42, 2310.0, 0.01)
    stick = schedule(Decay.of(scenario.slider, 0.01)).stick_time
    assert stick is not None
    assert 1.2 * stick <= scenario.duration <= 1.4 * stick


@pytest.mark.parametrize(
    ("given", "least", "most"),
    [
        ({"f_k": 0.0}, 6.28, 6.3),  # ten periods of 0.628 s, for it never sticks
        ({"c": 0.0, "f_k": 0.0}, 6.28, 6.3),
        ({"x0": 0.02}, 0.62, 0.64),  # stuck from the start: one period
        ({"c": 50.0}, 6.28, 6.3),
        ({"duration": 1.25}, 1.25, 1.25),
    ],
)
def test_runs_are_long_enough(given: dict[str, float], least: float, most: float) -> None:
    assert least <= scenario_named("free-decay", given).duration <= most


def test_break_away_follows_kinetic_friction_unless_given() -> None:
    assert scenario_named("free-decay", {"f_k": 2.0}).slider.break_away == 2.0
    assert scenario_named("free-decay", {"f_s": 4.0}).slider.break_away == 4.0


@pytest.mark.parametrize("given", [{}, {"f_s": 4.0, "v0": -1.0}, {"c": 0.0}])
def test_a_scenario_survives_json(given: dict[str, float]) -> None:
    scenario = scenario_named("free-decay", given)
    again = scenario_of_json(scenario_json(scenario))
    assert scenario_json(again) == scenario_json(scenario)


def test_an_unknown_scenario_lists_those_there_are() -> None:
    with pytest.raises(InputError, match="'belt'; free-decay is accepted"):
        scenario_named("belt", {})
