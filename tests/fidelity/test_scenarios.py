"""Scenarios by name and parameters, and one that is added."""

import pytest

from harness.core.scenario import FREE_DECAY, Hold
from harness.exact.decay import Decay, schedule
from harness.fidelity.kind import chosen


def test_without_parameters_it_is_the_papers_case() -> None:
    assert chosen("free-decay", {"m": None, "x0": None}) == FREE_DECAY


def test_given_values_take_the_place_of_the_papers() -> None:
    scenario = chosen("free-decay", {"m": 2.42, "k": 2310.0, "c": 4.79, "f_k": 0.351, "x0": 0.01})
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
    assert least <= chosen("free-decay", given).duration <= most


def test_values_change_what_a_scenario_is_about() -> None:
    # break-away follows friction in proportion: 3 -> 4 N becomes 1.5 -> 2 N
    belt = chosen("belt", {"f_k": 1.5})
    assert belt.slider.break_away == pytest.approx(2.0, rel=1e-12)
    hold = chosen("hold-50", {"f_k": 5.0, "duration": 2.0})
    assert hold.action == Hold(2.5)
    assert hold.duration == 2.0
