"""Force laws, levels of friction, internal states and driving samples, against independent integration."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from engine_cases import CALLING, INSTALLED, JOINTED, OFF_FLOOR, TABLE, decay, engine, short
from scipy.integrate import solve_ivp

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.core.events import Mode
from harness.core.jit import compiled
from harness.core.scenario import Harmonic, Hold, Scenario
from harness.core.slider import Slider
from harness.engines.base import Task
from harness.engines.forces import Drive, ForceLaw
from harness.exact.decay import free_decay

FREE = Slider(1.0, 1.0, 100.0, 0.0)
STEPPED = [(name, route) for name, route in CALLING if name != "mujoco"]


def _drag(t: float, x: float, v: float, state: FloatArray, params: FloatArray) -> float:
    return float(-params[0] * abs(v) * v - params[1] * x**3)


def _stribeck(t: float, x: float, v: float, state: FloatArray, params: FloatArray) -> float:
    return float(params[0] + (params[1] - params[0]) * np.exp(-((v / params[2]) ** 2)))


def _branch(t: float, x: float, v: float, state: FloatArray, params: FloatArray) -> float:
    # y at the start of the step, carried to this stage by how far the slider has come since
    return float(-params[0] * (state[0] * np.exp(-(t - state[1]) / params[1]) + (x - state[2])))


def _relax(t: float, x: float, v: float, dt: float, state: FloatArray, params: FloatArray) -> None:
    # y' = v - y/tau from the start of the step before (state[1], state[2]) to this one
    passed = t - state[1]
    keep = np.exp(-passed / params[1])
    mean = (x - state[2]) / passed if passed > 0.0 else 0.0
    state[0] = state[0] * keep + mean * params[1] * (1.0 - keep)
    state[1], state[2] = t, x


drag, stribeck, branch, relax = compiled(_drag), compiled(_stribeck), compiled(_branch), compiled(_relax)


def solved(
    slider: Slider, t: FloatArray, force: Callable[[float, float, float], float], start: tuple[float, float]
) -> FloatArray:
    """Positions by an independent integrator; ``force`` holds everything but spring and damper."""

    def slope(now: float, y: Any) -> list[float]:
        return [y[1], (force(now, y[0], y[1]) - slider.c * y[1] - slider.k * y[0]) / slider.m]

    done = solve_ivp(slope, (t[0], t[-1]), start, method="DOP853", t_eval=t, rtol=1e-11, atol=1e-13)
    return np.asarray(done.y[0])


def test_a_law_is_called_at_every_stage_of_rk4() -> None:
    law = ForceLaw(drag, params=np.array([0.4, 60.0]))
    errors = []
    for dt in (4e-3, 2e-3):
        task = Task(decay(FREE, 1.0, 1.0), "joint", "tuned", dt, {"integrator": "RK4"}, law)
        trace = engine("mujoco").simulate(task)
        exact = solved(FREE, trace.t, lambda t, x, v: -0.4 * abs(v) * v - 60.0 * x**3, (1.0, 0.0))
        errors.append(np.abs(trace.x - exact).max())
    # the corner of |v| v at a reversal costs a little of the fourth order
    assert np.log2(errors[0] / errors[1]) > 2.9
    assert errors[1] < 2e-6


@pytest.mark.parametrize(("name", "route"), STEPPED)
def test_a_law_in_a_stepped_engine_is_second_order(name: str, route: str) -> None:
    law = ForceLaw(drag, params=np.array([0.4, 60.0]))
    trace = engine(name).simulate(Task(decay(FREE, 1.0, 1.0), route, "tuned", 1e-3, {}, law))  # type: ignore[arg-type]
    exact = solved(FREE, trace.t, lambda t, x, v: -0.4 * abs(v) * v - 60.0 * x**3, (1.0, 0.0))
    assert np.abs(trace.x - exact).max() < 1e-4


@pytest.mark.parametrize(("name", "route"), CALLING)
def test_a_level_of_friction_follows_its_curve(name: str, route: str) -> None:
    slider, params = Slider(1.0, 1.0, 100.0, 3.0, 5.0), np.array([3.0, 5.0, 0.3])
    law = ForceLaw(level=stribeck, params=params)
    scenario = decay(replace(slider, f_s=3.0), 1.0, 0.31)
    trace = engine(name).simulate(Task(scenario, route, "tuned", 1e-3, {}, law))  # type: ignore[arg-type]

    def friction(t: float, x: float, v: float) -> float:
        return float(3.0 + 2.0 * np.exp(-((v / 0.3) ** 2)))  # v < 0 throughout the first half-cycle

    moving = trace.t < 0.3
    exact = solved(slider, trace.t[moving], friction, (1.0, 0.0))
    assert np.abs(trace.x[moving] - exact).max() < 2e-3
    fast = moving & (trace.v < -0.5)
    expected = [-friction(0.0, 0.0, v) for v in trace.v[fast]]
    assert trace.extra["friction_force"][fast] == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize(("name", "route"), CALLING)
def test_an_internal_state_moves_once_a_step(name: str, route: str) -> None:
    tolerance = 5e-5 if name == "mujoco" else 1e-3
    k_m, tau = 40.0, 0.05
    law = ForceLaw(branch, advance=relax, params=np.array([k_m, tau]), state=np.array([0.0, 0.0, 1.0]))
    trace = engine(name).simulate(Task(decay(FREE, 1.0, 2.0), route, "tuned", 5e-4, {}, law))  # type: ignore[arg-type]

    def slope(t: float, y: Any) -> list[float]:
        return [y[1], -k_m * y[2] - y[1] - 100.0 * y[0], y[1] - y[2] / tau]

    exact = solve_ivp(slope, (0.0, 2.1), (1.0, 0.0, 0.0), method="DOP853", t_eval=trace.t, rtol=1e-10, atol=1e-12)
    assert np.abs(trace.x - exact.y[0]).max() < tolerance
    assert law.state.tolist() == [0.0, 0.0, 1.0]


@pytest.mark.parametrize(("name", "route"), TABLE)
def test_samples_of_a_force_drive_as_the_formula_does(name: str, route: str) -> None:
    slider = Slider(1.0, 1.0, 100.0, 0.2)
    t = np.linspace(0.0, 2.0, 20001)
    by_samples = Scenario("driven", slider, 0.0, 0.0, 1.0)
    by_formula = replace(by_samples, action=Harmonic(2.0, 7.0, 0.3))
    drive = Drive(t, 2.0 * np.cos(7.0 * t + 0.3))
    sampled = engine(name).simulate(Task(by_samples, route, drive=drive))  # type: ignore[arg-type]
    closed = engine(name).simulate(Task(by_formula, route))  # type: ignore[arg-type]
    assert np.abs(sampled.x - closed.x).max() < 2e-5
    assert sampled.u == pytest.approx(2.0 * np.cos(7.0 * sampled.t + 0.3), abs=1e-6)


@pytest.mark.parametrize(("name", "route"), OFF_FLOOR)
def test_a_knock_makes_the_speed_jump_by_impulse_over_mass_wherever_it_falls(name: str, route: str) -> None:
    slider, knock = Slider(2.0, 1.0, 100.0, 0.0), 0.7
    for time in (0.2, 0.20037, 0.2005):
        drive = Drive.none().with_knock(time, knock, 1e-3)
        trace = engine(name).simulate(Task(Scenario("knock", slider, 0.0, 0.0, 1.0), route, drive=drive))  # type: ignore[arg-type]
        late = trace.t > 0.203
        exact = free_decay(Scenario("after", slider, 0.0, knock / slider.m), trace.t[late] - time)
        assert np.abs(trace.x[late] - exact.x).max() < 5e-4 * np.abs(exact.x).max()


@pytest.mark.parametrize(("name", "route"), CALLING)
def test_a_pendulum_swings_as_one(name: str, route: str) -> None:
    tolerance = 1e-6 if name == "mujoco" else 1e-3
    trace = engine(name).simulate(Task(decay(FREE, 2.0, 2.0), route, "tuned", 1e-3, restoring="pendulum"))  # type: ignore[arg-type]
    exact = solved(FREE, trace.t, lambda t, x, v: 100.0 * (x - np.sin(x)), (2.0, 0.0))
    assert np.abs(trace.x - exact).max() < tolerance


@pytest.mark.parametrize(("name", "route"), OFF_FLOOR)
def test_a_free_axis_has_no_spring(name: str, route: str) -> None:
    slider = Slider(2.0, 3.0, 1e4, 1.0)
    scenario = Scenario("axis", slider, 0.0, 0.0, 1.0, Hold(7.0))
    trace = engine(name).simulate(Task(scenario, route, "tuned", 1e-3, restoring="none"))  # type: ignore[arg-type]
    speed = (7.0 - 1.0) / 3.0 * (1.0 - np.exp(-3.0 / 2.0 * trace.t))
    assert trace.v == pytest.approx(speed, abs=5e-3)


@pytest.mark.parametrize(("name", "route"), TABLE)
def test_what_is_held_moves_only_above_break_away(name: str, route: str) -> None:
    slider = Slider(1.0, 0.0, 1e-9, 0.2, 0.4)
    for force, moves in ((0.38, False), (0.42, True)):
        scenario = Scenario("hold", slider, 0.0, 0.0, 0.2, Hold(force))
        trace = engine(name).simulate(Task(scenario, route))  # type: ignore[arg-type]
        assert trace.mode is not None
        if moves:
            assert trace.a[-1] == pytest.approx(force - slider.f_k, rel=1e-3)
            assert trace.mode[-1] == Mode.SLIP_POSITIVE
        else:
            assert abs(trace.v[-1]) < 1e-6
            assert trace.mode[-1] == Mode.STICK


@pytest.mark.parametrize("name", JOINTED)
def test_break_away_without_sliding_friction(name: str) -> None:
    slider = Slider(1.0, 0.0, 1e-9, 0.0, 0.4)
    for force, expected in ((0.3, 0.0), (0.5, 0.5)):
        scenario = Scenario("hold", slider, 0.0, 0.0, 0.2, Hold(force))
        trace = engine(name).simulate(Task(scenario))
        assert trace.a[-1] == pytest.approx(expected, abs=1e-4)


def test_a_level_that_depends_on_the_state_is_the_coefficient_of_mujocos_contact() -> None:
    law = ForceLaw(level=stribeck, params=np.array([0.3, 1.2, 0.3]))
    slides, rubs = (engine("mujoco").simulate(short(route, law=law)) for route in ("contact", "joint"))
    plain = engine("mujoco").simulate(short("contact"))
    assert np.abs(slides.x - rubs.x).max() < 0.1 * np.abs(plain.x - rubs.x).max()


def test_an_engine_within_whose_steps_nothing_can_be_called_says_so() -> None:
    law = ForceLaw(drag, params=np.array([0.4, 60.0]))
    for name in {*INSTALLED} - {name for name, _ in CALLING}:
        more: dict[str, Any]
        for more in ({"law": law}, {"restoring": "pendulum"}):
            with pytest.raises(SimulationError, match=f"{name}: no force laws and no pendulum"):
                engine(name).simulate(Task(decay(FREE), engine(name).routes[0], **more))


def test_laws_and_drives_are_checked_where_they_are_made() -> None:
    with pytest.raises(InputError, match="force law: neither force nor level"):
        ForceLaw()
    with pytest.raises(InputError, match="force law: params, row 1: nan"):
        ForceLaw(drag, params=np.array([np.nan]))
    with pytest.raises(InputError, match=r"drive: t, row 2: time 0 s does not come after 1 s"):
        Drive(np.array([1.0, 0.0]), np.zeros(2))
    with pytest.raises(InputError, match="drive: u"):
        Drive(np.array([0.0, 1.0]), np.zeros(3))
