"""Every known trap of the engines: a default or a habit that would spoil friction without a word."""

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from engine_cases import GENTLE, decay, engine, short

from harness.core.errors import SimulationError
from harness.core.scenario import Belt, Hold, Scenario
from harness.core.slider import PAPER, Slider
from harness.core.trajectory import Trajectory
from harness.engines.base import Task
from harness.engines.mujoco.presets import INTEGRATORS

LOOSE = 1e-12  # N/m: as good as no spring, which a Slider must have


def coast(f_k: float, v0: float, m: float = 1.0, c: float = 0.0, **task: Any) -> Trajectory:
    scenario = Scenario("coast", Slider(m, c, LOOSE, f_k), 0.0, v0, 0.02)
    return engine("pybullet").simulate(Task(scenario, **task))


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_mujoco_acceleration_belongs_to_its_own_time_stamp(integrator: str) -> None:
    trace = engine("mujoco").simulate(Task(decay(), "joint", "as-shipped", 1e-3, {"integrator": integrator}))
    # as shipped friction reverses up to a0/b, about 1 m/s, before the speed
    sliding = np.abs(trace.v) > 1.2
    x, v = trace.x[sliding], trace.v[sliding]
    exact = -(PAPER.c * v + PAPER.k * x + PAPER.f_k * np.sign(v)) / PAPER.m
    assert np.abs(trace.a[sliding] - exact).max() < 1e-6
    assert trace.a[0] == pytest.approx(-97.0, abs=1e-9)


def test_pybullet_acceleration_belongs_to_its_own_time_stamp() -> None:
    for leapfrog, slack in ((False, 1e-9), (True, 1e-2)):
        trace = engine("pybullet").simulate(Task(decay(), "joint", "tuned", 1e-3, {"leapfrog": leapfrog}))
        sliding = np.abs(trace.v) > 0.5
        sliding[0] = False
        x, v = trace.x[sliding], trace.v[sliding]
        exact = -(PAPER.c * v + PAPER.k * x + PAPER.f_k * np.sign(v)) / PAPER.m
        assert np.abs(trace.a[sliding] - exact).max() < slack


def test_pybullet_damping_of_its_own_is_off_when_tuned_and_on_as_shipped() -> None:
    assert np.abs(coast(0.0, 5.0, preset="tuned").a).max() < 1e-9
    shipped = coast(0.0, 5.0, preset="as-shipped").a
    # 0.04 v and a quadratic part of the same size
    assert shipped[0] == pytest.approx(-(0.04 * 5.0 + 0.04 * 25.0), rel=1e-6)


def test_pybullet_friction_is_not_multiplied_by_sub_steps_and_the_next_run_has_none() -> None:
    one = coast(2.0, 5.0, preset="tuned")
    four = coast(2.0, 5.0, preset="tuned", settings={"numSubSteps": 4})
    assert np.allclose(four.a, -2.0, atol=1e-9)
    assert np.allclose(four.extra["friction_force"], 2.0, atol=1e-9)
    again = coast(2.0, 5.0, preset="tuned")
    assert np.array_equal(one.x, again.x)
    assert any("frozen" in line for line in four.source.ignored)


def test_pybullet_reads_each_model_anew() -> None:
    light, heavy = coast(2.0, 5.0, 1.0, preset="tuned"), coast(2.0, 5.0, 4.0, preset="tuned")
    assert light.a[0] == pytest.approx(-2.0, abs=1e-9)
    assert heavy.a[0] == pytest.approx(-0.5, abs=1e-9)


def test_pybullet_force_lasts_for_the_whole_run() -> None:
    scenario = Scenario("push", Slider(2.0, 0.0, LOOSE, 0.0), 0.0, 0.0, 0.1, Hold(3.0))
    trace = engine("pybullet").simulate(Task(scenario))
    assert np.allclose(trace.a, 1.5, atol=1e-9)


def test_pybullet_does_not_cap_the_speed_when_tuned() -> None:
    assert np.allclose(coast(0.0, 500.0, preset="tuned").v, 500.0)


IGNORED = [
    ("mujoco", "joint", {"impratio": 10.0}, "impratio: there is no contact on this route"),
    ("mujoco", "law", {"solreffriction": (0.1, 1.0)}, "solreffriction: the joint has no friction on this route"),
    ("mujoco", "contact", {"noslip_iterations": 5}, "noslip_iterations: does nothing with an elliptic cone"),
    ("mujoco", "contact", {"cone": "pyramidal", "solreffriction": (0.1, 1.0)}, "only an elliptic cone looks at it"),
    ("pybullet", "joint", {"contactERP": 0.5}, "contactERP: there is no contact on this route"),
]


@pytest.mark.parametrize(("name", "route", "settings", "line"), IGNORED)
def test_a_setting_without_effect_is_listed_and_has_none(
    name: str, route: str, settings: dict[str, Any], line: str
) -> None:
    without = {key: value for key, value in settings.items() if key == "cone"}
    plain = engine(name).simulate(short(route, settings=without))
    trace = engine(name).simulate(short(route, settings=settings))
    assert any(line in said for said in trace.source.ignored)
    assert not any(line in said for said in plain.source.ignored)
    # a solver that is run in vain still rounds
    assert np.abs(trace.x - plain.x).max() < 1e-12


def test_noslip_acts_on_joint_friction() -> None:
    scenario = Scenario("hold", Slider(1.0, 1.0, LOOSE, 3.0), 0.0, 0.0, 1.0, Hold(1.5))
    creeping = engine("mujoco").simulate(Task(scenario, "joint", "as-shipped"))
    held = engine("mujoco").simulate(Task(scenario, "joint", "as-shipped", None, {"noslip_iterations": 50}))
    assert creeping.v[-1] > 1e-3
    assert abs(held.v[-1]) < 1e-8


@pytest.mark.usefixtures("pybullet")
def test_a_box_on_a_floor_starts_at_rest_and_keeps_its_weight() -> None:
    for name in ("mujoco", "pybullet"):
        scenario = Scenario("hold", GENTLE, 0.0, 0.0, 0.3, Hold(0.1))
        trace = engine(name).simulate(Task(scenario, "contact", "tuned"))
        assert trace.extra["normal_force"] == pytest.approx(9.81, rel=1e-3)
        assert np.ptp(trace.extra["lift"]) < 1e-7


@pytest.mark.parametrize("name", ["mujoco", "pybullet"])
def test_a_belt_carries_a_box_that_sticks(name: str) -> None:
    scenario = Scenario("belt", GENTLE, 0.0, 0.01, 0.2, Belt(0.01))
    trace = engine(name).simulate(Task(scenario, "contact", "tuned"))
    assert trace.v == pytest.approx(0.01, rel=1e-3)
    assert trace.x[-1] == pytest.approx(0.002, rel=1e-3)


def test_mujoco_reports_divergence_and_writes_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SimulationError, match="diverged"):
        engine("mujoco").simulate(Task(decay(Slider(1.0, 1.0, 1e6, 3.0), 1.0, 200.0), "joint", "as-shipped", 1.0))
    assert list(tmp_path.iterdir()) == []
    assert mujoco.get_mjcb_passive() is None
