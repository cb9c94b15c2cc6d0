"""Effort of the solver as an axis: holds that slide first, a line search that is cut off, and what is recommended."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.iterations import chain_creep
from harness.core.scenario import Hold
from harness.core.slider import Slider
from harness.engines import registry
from harness.engines.base import Task
from harness.fidelity.kind import drawn, kinds, names, suite
from harness.fidelity.laws import CONVERGED, line_search_creep, newton_iterations
from harness.fidelity.matrix import EFFORTS, TRAINED, Matrix
from harness.fidelity.row import run_row
from harness.fidelity.scenarios.slid import MIDDLE, SlidKind
from harness.show.report.effort import Effort, efforts

STEP = 2e-3


def creep(slider: Slider, speed: float, iterations: int, ls_iterations: int, integrator: str = "Euler") -> float:
    """m/s, half of friction as the load, after a slide at this speed with friction as stiff as a step allows."""
    effort = {"iterations": iterations, "ls_iterations": ls_iterations, "integrator": integrator}
    stiff = {"solreffriction": (2 * STEP, 1.0), "solimpfriction": (0.9999, 0.9999, 0.001, 0.5, 2.0)}
    scenario = MIDDLE.slide(slider, speed)
    trace = registry.load("mujoco").simulate(Task(scenario, "joint", "as-shipped", STEP, effort | stiff))
    found = MIDDLE.measure(trace, scenario)["creep_m_s"]
    assert found is not None
    return abs(found)


masses, frictions, shares = st.floats(0.1, 10.0), st.floats(0.3, 30.0), st.floats(20.0, 120.0)


@settings(max_examples=20, deadline=None, derandomize=True)
@given(m=masses, f=frictions, k=st.floats(0.5, 5.0), share=st.floats(0.2, 1.9))
def test_the_exact_slide_obeys_the_equation_of_motion_and_then_rests(
    m: float, f: float, k: float, share: float
) -> None:
    slider = Slider(m, 0.0, k * f, f)
    scenario = MIDDLE.slide(slider, share * slider.x_k * slider.omega_n)
    assert isinstance(scenario.action, Hold)
    t = np.linspace(0.0, scenario.duration, 20_001)
    exact = MIDDLE.exact(scenario, t)
    moving = exact.v > 0.0
    force = scenario.action.force - slider.k * exact.x[moving] - f
    assert np.allclose(m * exact.a[moving], force, rtol=1e-9, atol=1e-9 * f)
    assert np.allclose(np.gradient(exact.x, t)[1:-1], exact.v[1:-1], atol=2.0 * float(np.ptp(t)) / t.size * f / m)
    assert exact.v[0] == pytest.approx(scenario.v0)
    assert not moving[-1]
    # at rest friction has to carry less than it can
    assert abs(scenario.action.force - slider.k * exact.x[-1]) < f


@settings(max_examples=6, deadline=None, derandomize=True)
@given(m=masses, f=frictions, steps=shares, search=st.integers(8, 24))
def test_a_cut_line_search_creeps_by_no_more_than_its_law(m: float, f: float, steps: float, search: int) -> None:
    """steps : of braking, until it stops."""
    slider = Slider(m, 0.0, 1e-3 * f, f)
    speed = steps * 0.5 * f / m * STEP
    full = creep(slider, speed, 100, 50)
    assert creep(slider, speed, 4, search) <= line_search_creep(m, f, STEP, search) + 1.01 * full


@settings(max_examples=6, deadline=None, derandomize=True)
@given(m=masses, f=frictions, steps=shares, integrator=st.sampled_from(("Euler", "implicitfast")))
def test_the_search_that_is_recommended_is_as_good_as_full_effort(
    m: float, f: float, steps: float, integrator: str
) -> None:
    slider = Slider(m, 0.0, 1e-3 * f, f)
    speed = steps * 0.5 * f / m * STEP
    full = creep(slider, speed, 100, 100, integrator)
    for iterations, search in ((1, 50), (4, 50), (4, CONVERGED)):
        assert creep(slider, speed, iterations, search, integrator) == pytest.approx(full, rel=0.01)


LINK = st.tuples(st.floats(0.3, 5.0), st.floats(0.01, 2.0), st.floats(0.1, 1.0))
"""Friction, N m, damping, N m s/rad, mass, kg."""


@settings(max_examples=12, deadline=None, derandomize=True)
@given(links=st.lists(LINK, min_size=2, max_size=6), integrator=st.sampled_from(("Euler", "implicitfast")))
def test_joints_that_move_one_another_want_an_iteration_each_and_one_more(
    links: list[tuple[float, float, float]], integrator: str
) -> None:
    full, _ = chain_creep(links, integrator, 100)
    assert full < 1e-3
    assert chain_creep(links, integrator, newton_iterations(len(links)))[0] == pytest.approx(full, rel=0.01)


def test_one_iteration_is_enough_for_one_damped_joint_alone() -> None:
    one, three = [(1.0, 0.2, 0.5)], [(1.0, 0.2, 0.5), (0.6, 0.1, 0.4), (2.0, 0.5, 0.3)]
    assert chain_creep(one, "Euler", 1)[0] == pytest.approx(chain_creep(one, "Euler", 100)[0], rel=0.01)
    assert chain_creep(three, "Euler", 1)[0] > 100.0 * chain_creep(three, "Euler", 100)[0]


def test_a_hold_from_rest_does_not_see_a_cut_search() -> None:
    """Which is why holds slide first, at three speeds."""
    slid = [kind for kind in kinds().values() if kind.part == "trained"]
    assert len(slid) == 3
    sliders = drawn(1)
    worst = {}
    for effort in ((100, 50), (4, 8)):
        creeps = []
        for one in slid:
            assert isinstance(one, SlidKind)
            scenario = one.of_suite(sliders, 1.0)
            creeps.append(creep(scenario.slider, scenario.v0, *effort))
        worst[effort] = max(creeps)
    assert worst[4, 8] > 20.0 * worst[100, 50]
    assert {row.row["scenario"] for row in found()} <= {*names("joint"), *names("joint", "trained")}


@cache
def found() -> list[Effort]:
    """The efforts of the joint route, three of them and full effort, run as a sweep does."""
    engine = registry.load("mujoco")
    wanted = ((100, 50), (4, 8), (4, 50), (1, 50))
    rows: list[dict[str, Any]] = []
    for spec in Matrix(routes=("joint",), presets=(TRAINED,)).specs({"mujoco": engine}):
        changed = dict(spec.changed)
        effort = (changed.get("iterations"), changed.get("ls_iterations"))
        if changed.get("integrator") == "Euler" and effort in wanted and "noslip_iterations" not in changed:
            rows.append(run_row(engine, spec).model_dump(mode="json"))
    return efforts(rows)


def test_the_least_iterations_that_are_as_good_as_what_ships_are_recommended() -> None:
    every = found()
    assert [one.effort for one in every if one.recommended] == [(1, 50)]
    by = {one.effort: one for one in every}
    assert by[4, 8].rest == pytest.approx(by[100, 50].rest, rel=1e-6)
    assert by[4, 8].slid is not None
    assert by[1, 50].slid is not None
    assert by[4, 8].slid > 100.0 * by[1, 50].slid
    assert all(
        one.row["effort"] == dict(zip(("iterations", "ls_iterations"), one.effort, strict=True)) for one in every
    )
    assert all(one.steps_per_s > 0.0 for one in every)


def test_what_is_not_of_the_suite_leaves_the_suite_alone() -> None:
    assert EFFORTS[0] == (100, 50)
    for route in ("joint", "contact"):
        assert not set(names(route, "trained")) & set(suite(route))
    short = Matrix(routes=("joint",), short=True).specs({"mujoco": registry.load("mujoco")})
    assert all(spec.preset != TRAINED for spec in short)
