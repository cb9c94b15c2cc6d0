"""Scenarios by name, metrics of errors that a test put in, and exact answers against an integration."""

import dataclasses
from dataclasses import replace

import numpy as np
import pytest
from fidelity_draws import drawn_suites

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.scenario import FREE_DECAY, Belt, Harmonic, Hold, Scenario
from harness.core.slider import PAPER, Slider
from harness.core.trajectory import Source, Trajectory
from harness.exact.decay import Decay, free_decay, schedule
from harness.fidelity import metrics
from harness.fidelity.kind import OWN, chosen, kind_of, suite
from harness.fidelity.metrics import lift_m
from harness.fidelity.row import describe, measure_row, scenario_of
from harness.fidelity.scenarios import belt, harmonic
from harness.fidelity.scenarios.harmonic import PERIODS

DT = 1e-3
T: FloatArray = np.arange(3001, dtype=np.float64) * DT
STICK_TIME = 2.51642


def blind(x: FloatArray, v: FloatArray, a: FloatArray) -> Trajectory:
    """A trace whose source knows no events."""
    return Trajectory(T, x, v, a, Source("test"))


def exact() -> Trajectory:
    return free_decay(FREE_DECAY, T)


def test_the_exact_trace_has_no_error() -> None:
    found = metrics.measure_decay(exact(), FREE_DECAY)
    assert found["max_error_m"] == 0.0
    assert found["rest_error_m"] == 0.0
    assert found["stick_time_s"] == pytest.approx(STICK_TIME, abs=1e-5)
    assert found["creep_m_s"] == 0.0
    assert found["half_cycles"] == 8
    assert found["reversal_lead_s"] == 0.0
    assert found["energy_error"] == pytest.approx(0.0, abs=2e-6)


def test_a_trace_without_events_is_read_to_one_sample() -> None:
    e = exact()
    found = metrics.measure_decay(blind(e.x, e.v, e.a), FREE_DECAY)
    assert found["stick_time_s"] == pytest.approx(2.517, abs=1e-12)
    assert found["half_cycles"] == 8


def test_creep_is_the_speed_put_in_and_not_a_half_cycle() -> None:
    e = exact()
    creep = np.where(T > STICK_TIME, -1.15e-3, 0.0)
    trace = blind(e.x + creep * np.maximum(T - STICK_TIME, 0.0), e.v + creep, e.a)
    found = metrics.measure_decay(trace, FREE_DECAY)
    assert found["creep_m_s"] == pytest.approx(-1.15e-3, rel=1e-9)
    assert found["stick_time_s"] is None
    assert found["half_cycles"] == 8
    assert found["rest_error_m"] == pytest.approx(-1.15e-3 * (3.0 - STICK_TIME), rel=1e-4)


@pytest.mark.parametrize("lead", [0.0, 3e-3, 10e-3])
def test_lead_is_the_one_put_in(lead: float) -> None:
    e = exact()
    ahead = np.interp(T + lead, T, e.v)
    sliding = np.abs(e.v) > 0.0
    friction = -PAPER.f_k * np.sign(ahead)
    a = np.where(sliding, (friction - PAPER.c * e.v - PAPER.k * e.x) / PAPER.m, 0.0)
    assert metrics.reversal_lead_s(blind(e.x, e.v, a), PAPER) == pytest.approx(lead, abs=0.5 * DT)


def test_energy_error_is_the_one_put_in() -> None:
    e = exact()
    weaker = dataclasses.replace(PAPER, c=0.9)
    lost = 0.1 * np.trapezoid(e.v**2, T) / (0.5 * PAPER.k)
    assert metrics.energy_error(e, weaker) == pytest.approx(lost, rel=1e-3)


def test_energy_balance_converges_with_the_step() -> None:
    errors = []
    for dt in (4e-3, 2e-3, 1e-3):
        t: FloatArray = np.arange(round(2.4 / dt) + 1, dtype=np.float64) * dt
        error = metrics.energy_error(free_decay(FREE_DECAY, t), PAPER)
        assert error is not None
        errors.append(error)
    assert errors[0] < 1e-4
    assert errors[2] < errors[1] < errors[0]


def test_largest_error_is_the_one_put_in() -> None:
    e = exact()
    x = e.x.copy()
    x[700] += 0.0128
    assert metrics.max_error_m(blind(x, e.v, e.a), e) == pytest.approx(0.0128, rel=1e-12)


def test_what_a_slider_without_friction_has_no_figure_for_is_none() -> None:
    scenario = Scenario("free-decay", Slider(m=1.0, c=1.0, k=100.0, f_k=0.0), 1.0, 0.0, 3.0)
    found = metrics.measure_decay(free_decay(scenario, T), scenario)
    assert found["rest_error_m"] is None
    assert found["stick_time_s"] is None
    assert found["creep_m_s"] is None
    assert found["reversal_lead_s"] is None
    assert found["half_cycles"] == 10


def test_a_slider_that_is_stuck_from_the_start() -> None:
    scenario = Scenario("free-decay", PAPER, 0.02, 0.0, 1.0)
    found = metrics.measure_decay(free_decay(scenario, T), scenario)
    assert found["stick_time_s"] == 0.0
    assert found["half_cycles"] == 0
    assert found["creep_m_s"] == 0.0


def test_lift_is_read_where_there_is_one() -> None:
    e = exact()
    trace = Trajectory(T, e.x, e.v, e.a, Source("test"), extra={"lift": np.where(T > 1.0, -1e-4, -3e-4)})
    # a soft floor lets the box rest below 0
    assert lift_m(trace) == pytest.approx(2e-4, rel=1e-12)


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


DRAWN = list(drawn_suites(31, 6))


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
