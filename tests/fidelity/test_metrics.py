"""Metrics of traces whose errors are known because the test put them in."""

import dataclasses

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.scenario import FREE_DECAY, Scenario
from harness.core.slider import PAPER, Slider
from harness.core.trajectory import Source, Trajectory
from harness.exact.decay import free_decay
from harness.fidelity import metrics
from harness.fidelity.metrics import lift_m

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
