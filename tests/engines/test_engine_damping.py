"""Numerical damping and creep: the laws of docs/fidelity.md against the engines, at random parameters."""

from typing import Any

import numpy as np
import pytest
from engine_cases import TABLE, engine

from harness.core.scenario import Harmonic, Hold, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.engines.base import Task
from harness.fidelity import laws

HAVE = {name for name, _ in TABLE}


def only(name: str) -> pytest.MarkDecorator:
    return pytest.mark.skipif(name not in HAVE, reason=f"{name} is not installed")


def acting(trace: Trajectory, m: float) -> float:
    """Damping that acts, N s/m: the determinant of the linear map from one sample's state to the next."""
    # both columns of about one size
    states = np.column_stack([trace.x / np.abs(trace.x).max(), trace.v / np.abs(trace.v).max()])
    step, *_ = np.linalg.lstsq(states[:-1], states[1:], rcond=None)
    return float(-m / (trace.t[1] - trace.t[0]) * np.log(np.linalg.det(step)))


def drawn(seed: int) -> tuple[Slider, float, int]:
    """A slider without friction, a step of 1 to 10 % of its time scale, and a number of sub-steps."""
    rng = np.random.default_rng(seed)
    m, omega = float(np.exp(rng.uniform(-1.0, 1.0))), float(rng.uniform(5.0, 60.0))
    slider = Slider(m, 2.0 * rng.uniform(0.05, 0.3) * m * omega, m * omega**2, 0.0)
    return slider, float(rng.uniform(0.01, 0.1) / omega), int(rng.integers(1, 9))


SERVO = (Slider(1.0, 20.0, 4500.0, 0.0), 4e-3, 4)
"""A robot's servo: 4500 N/m at 4 ms."""
CASES = [*(drawn(seed) for seed in range(6)), SERVO]


def free(name: str, slider: Slider, h: float, **settings: Any) -> Trajectory:
    scenario = Scenario("ring", slider, 0.1, 0.0, 300.0 * h)
    return engine(name).simulate(Task(scenario, "joint", "as-shipped", h, settings))


def settings_of(name: str, n: int) -> dict[str, Any]:
    return {"num_solver_iterations": n} if name == "rapier" else {"solverPositionIterationCount": n}


@pytest.mark.parametrize("name", [pytest.param(one, marks=only(one)) for one in ("rapier", "physx")])
@pytest.mark.parametrize(("slider", "h", "n"), CASES)
def test_a_held_force_takes_half_of_k_h_off_the_damping_as_sub_steps_grow(
    name: str, slider: Slider, h: float, n: int
) -> None:
    trace = free(name, slider, h, own_spring=False, **settings_of(name, n))
    assert acting(trace, slider.m) == pytest.approx(laws.held(slider.m, slider.c, slider.k, h, n), rel=1e-3)


@pytest.mark.parametrize("name", [pytest.param(one, marks=only(one)) for one in ("rapier", "physx")])
@pytest.mark.parametrize(("slider", "h", "n"), CASES)
def test_a_spring_of_the_joint_adds_k_h_over_the_sub_steps(name: str, slider: Slider, h: float, n: int) -> None:
    trace = free(name, slider, h, own_spring=True, **settings_of(name, n))
    assert acting(trace, slider.m) == pytest.approx(laws.implicit(slider.m, slider.c, slider.k, h, n), rel=1e-3)


@only("dart")
@pytest.mark.parametrize(("slider", "h", "n"), CASES)
def test_darts_own_spring_is_one_implicit_step(slider: Slider, h: float, n: int) -> None:
    trace = free("dart", slider, h)
    assert acting(trace, slider.m) == pytest.approx(laws.implicit(slider.m, slider.c, slider.k, h, 1), rel=1e-9)


@only("physx")
@pytest.mark.parametrize("settings", [{"solverType": "PGS"}, {"enableExternalForcesEveryIteration": False}])
@pytest.mark.parametrize(("slider", "h", "n"), CASES[:2])
def test_a_force_taken_once_a_step_leaves_the_damping_alone(
    settings: dict[str, Any], slider: Slider, h: float, n: int
) -> None:
    trace = free("physx", slider, h, own_spring=False, solverPositionIterationCount=n, **settings)
    assert acting(trace, slider.m) == pytest.approx(laws.held(slider.m, slider.c, slider.k, h, 1), rel=1e-3)


@only("physx")
@pytest.mark.parametrize(("slider", "h", "n"), [*CASES[:3], SERVO])
def test_the_viscous_part_of_physx_is_taken_at_the_end_of_a_step(slider: Slider, h: float, n: int) -> None:
    trace = free("physx", slider, h, own_spring=False, own_viscous=True, solverType="PGS")
    assert acting(trace, slider.m) == pytest.approx(laws.half_implicit(slider.m, 0.0, slider.c, h), rel=1e-3)


def creeping(name: str, route: str, m: float, load: float, limit: float, h: float, **settings: Any) -> float:
    """Mean speed over the later half of a hold of 400 steps, m/s."""
    scenario = Scenario("hold", Slider(m, 0.0, 1e-9, limit), 0.0, 0.0, 400.0 * h, Hold(load))
    trace = engine(name).simulate(Task(scenario, route, "as-shipped", h, settings))  # type: ignore[arg-type]
    half = len(trace) // 2
    return float((trace.x[-1] - trace.x[half]) / (trace.t[-1] - trace.t[half]))


def held_cases(seed: int, count: int) -> list[tuple[float, float, float, float]]:
    """Mass, load, limit and step at random."""
    rng = np.random.default_rng(seed)
    made = []
    for _ in range(count):
        m, limit, h = np.exp(rng.uniform(-1.0, 1.0)), rng.uniform(1.0, 6.0), np.exp(rng.uniform(-7.6, -5.5))
        made.append((float(m), float(limit * rng.uniform(0.2, 0.95)), float(limit), float(h)))
    return made


@pytest.mark.parametrize("name", [pytest.param(one, marks=only(one)) for one in ("rapier", "dart", "pybullet")])
@pytest.mark.parametrize(("m", "load", "limit", "h"), held_cases(1, 2))
def test_friction_that_is_a_limited_impulse_does_not_creep(
    name: str, m: float, load: float, limit: float, h: float
) -> None:
    assert abs(creeping(name, "joint", m, load, limit, h)) < 1e-8


@only("physx")
@pytest.mark.parametrize(("m", "load", "limit", "h"), held_cases(2, 4))
def test_tgs_creeps_in_proportion_to_the_step(m: float, load: float, limit: float, h: float) -> None:
    for n, again in ((1, 1), (4, 1), (8, 0)):
        counts = {"solverPositionIterationCount": n, "solverVelocityIterationCount": again}
        found = creeping("physx", "joint", m, load, limit, h, own_spring=False, **counts)
        assert found == pytest.approx(laws.tgs_creep(m, load, h, n, again), rel=5e-3)
    assert abs(creeping("physx", "joint", m, load, limit, h, own_spring=False, solverType="PGS")) < 1e-8


@only("drake")
@pytest.mark.parametrize(("m", "load", "limit", "h"), held_cases(3, 3))
def test_drakes_creep_follows_its_stiction_tolerance(m: float, load: float, limit: float, h: float) -> None:
    for tolerance in (1e-4, 1e-6):
        enough = max(tolerance, laws.least_tolerance(m, limit, h))
        expected = {
            "kTamsi": laws.tamsi_creep(tolerance, load, limit),
            "kLagged": laws.smooth_creep(enough, load, limit),
            "kSimilar": laws.smooth_creep(enough, load, limit),
            "kSap": laws.sap_creep(m, load, h),
        }
        for name, creep in expected.items():
            settings = {"contact_approximation": name, "stiction_tolerance": tolerance}
            assert creeping("drake", "contact", m, load, limit, h, **settings) == pytest.approx(creep, rel=1e-3), name


TOLD = [
    *(("rapier", {"num_solver_iterations": n, "own_spring": own}) for n in (1, 4) for own in (True, False)),
    *(
        (
            "physx",
            {
                "solverType": solver,
                "solverPositionIterationCount": n,
                "own_spring": own,
                "enableExternalForcesEveryIteration": every,
            },
        )
        for solver in ("TGS", "PGS")
        for n in (1, 4)
        for own in (True, False)
        for every in (True, False)
    ),
]


@pytest.mark.parametrize(("name", "settings"), [pytest.param(*one, marks=only(one[0])) for one in TOLD])
def test_the_friction_that_is_told_of_what_slides_is_its_limit(name: str, settings: dict[str, Any]) -> None:
    slider = Slider(1.3, 1.5, 90.0, 2.0)
    scenario = Scenario("pushed", slider, 0.2, 0.0, 2.0, Harmonic(15.0, 6.0))
    trace = engine(name).simulate(Task(scenario, "joint", "as-shipped", 1.0 / 60.0, settings))
    # a whole step on one side of rest
    slides = np.concatenate([[False], np.minimum(np.abs(trace.v[1:]), np.abs(trace.v[:-1])) > 0.3])
    assert np.count_nonzero(slides) > 50
    told = trace.extra["friction_force"][slides] * np.sign(trace.v[slides])
    assert np.abs(told - slider.f_k).max() < 1e-5 * slider.f_k
