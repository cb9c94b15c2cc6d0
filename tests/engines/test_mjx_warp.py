"""MJX and MuJoCo Warp: MuJoCo's motion, what they drop without a word, and what a cut line search leaves in them.

Run where the extras mjx and warp are installed, since both compile for minutes.
"""

from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from engine_cases import INSTALLED, decay, engine, sliders, stiff
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.core.scenario import Belt, Harmonic, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.engines.base import Task
from harness.fidelity.laws import line_search_creep
from harness.fidelity.matrix import GPU, TRAINED, Matrix
from harness.fidelity.scenarios.slid import MIDDLE


def only(name: str) -> pytest.MarkDecorator:
    return pytest.mark.skipif(name not in INSTALLED, reason=f"{name} is not installed")


BOTH = [pytest.param(name, marks=only(name)) for name in ("mjx", "warp")]
ROUNDED: list[tuple[str, dict[str, Any], float]] = [
    ("mjx", {"precision": 64}, 1e-13),
    ("mjx", {"precision": 32}, 1e-5),
    ("warp", {}, 1e-5),
]

STEP = 2e-3
SCENARIOS = {
    "decay": decay(duration=2.0),
    "belt": Scenario("belt", Slider(1.0, 0.2, 100.0, 3.0, 4.0), 0.0, 0.1, 1.0, Belt(0.1)),
    "harmonic": Scenario("harmonic", Slider(1.0, 0.0, 100.0, 3.0), 0.0, 0.0, 1.0, Harmonic(10.0, 8.0)),
}


@pytest.mark.parametrize(
    ("name", "chosen", "slack"), [pytest.param(*row, marks=only(row[0])) for row in ROUNDED], ids=str
)
@pytest.mark.parametrize("scenario", SCENARIOS.values(), ids=SCENARIOS)
def test_as_shipped_they_move_as_mujoco_to_the_rounding_of_their_numbers(
    scenario: Scenario, name: str, chosen: dict[str, Any], slack: float
) -> None:
    own = engine(name).simulate(Task(scenario, "joint", "as-shipped", settings=chosen))
    of_c = engine("mujoco").simulate(Task(scenario, "joint", "as-shipped"))
    assert np.abs(own.x - of_c.x).max() < slack
    assert np.abs(own.v - of_c.v).max() < 20.0 * slack
    assert any("single" in line for line in own.source.ignored) == (slack > 1e-9)


REFUSED: list[tuple[str, dict[str, Any], str]] = [
    ("mjx", {"noslip_iterations": 10}, "unknown; expected one of"),
    ("mjx", {"integrator": "implicit"}, "one of Euler, RK4, implicitfast"),
    ("mjx", {"integrator": "discrete"}, "one of Euler, RK4, implicitfast"),
    ("mjx", {"solver": "PGS"}, "one of CG, Newton"),
    ("mjx", {"precision": 16}, "32 or 64"),
    ("mjx", {"device": "tpu"}, "one of cpu, gpu"),
    ("warp", {"integrator": "discrete"}, "one of Euler, RK4, implicit, implicitfast"),
    ("warp", {"solver": "PGS"}, "one of CG, Newton"),
    ("warp", {"precision": 64}, "unknown; expected one of"),
    ("warp", {"device": "tpu"}, "one of cpu, gpu"),
]


@pytest.mark.parametrize(
    ("name", "chosen", "message"), [pytest.param(*row, marks=only(row[0])) for row in REFUSED], ids=str
)
def test_a_setting_that_they_have_not_is_refused(name: str, chosen: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        engine(name).simulate(Task(decay(duration=0.1), "joint", settings=chosen))


@pytest.mark.skipif(Path("/dev/nvidiactl").exists(), reason="there is a GPU")
@pytest.mark.parametrize("name", BOTH)
def test_a_gpu_that_is_not_here_is_an_error_that_says_so(name: str) -> None:
    with pytest.raises(SimulationError, match=f"{name}: no gpu that"):
        engine(name).simulate(Task(decay(duration=0.1), "joint", settings={"device": "gpu"}))


DROPPED = {
    "damping": ('damping="1 2 0"', "", 'damping="1"', ""),
    "stiffness": ('stiffness="10 0 500"', "", 'stiffness="10"', ""),
    "springyield": ('stiffness="100" springyield="0.01"', "", 'stiffness="100"', ""),
    "motor_damping": ("", 'damping="3"', "", ""),
    "motor_armature": ("", 'armature="2"', "", ""),
}
"""Words of a joint and of its motor, and what is left of them."""


def _scene(words: bool, noslip: int) -> Any:
    bodies, motors = "", ""
    for name, (joint, motor, left, left_motor) in DROPPED.items():
        said, driven = (joint, motor) if words else (left, left_motor)
        body = f'<joint name="{name}" type="slide" axis="1 0 0" {said}/><geom size="0.1" mass="1"/>'
        bodies += f"<body>{body}</body>"
        motors += f'<motor joint="{name}" {driven}/>'
    rubbing = '<joint name="noslip" type="slide" axis="1 0 0" frictionloss="3"/><geom size="0.1" mass="1"/>'
    option = f'<option timestep="0.002" noslip_iterations="{noslip}"><flag contact="disable"/></option>'
    return mujoco.MjModel.from_xml_string(
        f"<mujoco>{option}<worldbody>{bodies}<body>{rubbing}</body></worldbody><actuator>{motors}</actuator></mujoco>"
    )


def _pushed(model: Any) -> FloatArray:
    """Positions after 200 steps under 1.5 N, from 0.3 m/s but for the joint that is held."""
    data = mujoco.MjData(model)
    data.qfrc_applied[:], data.qvel[:-1] = 1.5, 0.3
    for _ in range(200):
        mujoco.mj_step(model, data)
    return np.array(data.qpos)


@pytest.fixture(scope="module")
def moved() -> Any:
    """The same in MJX, by a friction of the last joint: (model, friction) -> positions."""
    import jax
    from jax import numpy as jnp
    from mujoco import mjx

    with jax.enable_x64(True):
        model = mjx.put_model(_scene(words=True, noslip=50))
        start = mjx.make_data(model)

        def run(friction: Any) -> Any:
            m = model.replace(dof_frictionloss=model.dof_frictionloss.at[-1].set(friction))
            pushed = jnp.full(model.nv, 1.5)
            d = start.replace(qfrc_applied=pushed, qvel=jnp.full(model.nv, 0.3).at[-1].set(0.0))
            return jax.lax.fori_loop(0, 200, lambda _, d: mjx.step(m, d), d).qpos

        compiled = jax.jit(run)
        yield lambda friction: np.asarray(compiled(friction))


@only("mjx")
def test_mjx_drops_polynomials_yield_noslip_and_what_a_motor_adds_without_a_word(moved: Any) -> None:
    with_words, without = _pushed(_scene(words=True, noslip=50)), _pushed(_scene(words=False, noslip=0))
    assert np.all(np.abs(with_words - without) > 1e-5)
    # the solver stops at a tolerance of 1e-8
    assert moved(3.0) == pytest.approx(without, abs=1e-10)


@only("mjx")
def test_mjx_locks_a_joint_whose_friction_becomes_nothing_at_run_time(moved: Any) -> None:
    assert abs(moved(0.0)[-1]) < 1e-3
    assert moved(1e-9)[-1] == pytest.approx(0.5 * 1.5 * 0.4**2, rel=0.01)


@only("warp")
def test_warp_drops_none_of_them() -> None:
    import mujoco_warp
    import warp

    compiled = _scene(words=True, noslip=50)
    with warp.ScopedDevice("cpu"):
        model, data = mujoco_warp.put_model(compiled), mujoco_warp.make_data(compiled)
        data.qfrc_applied.fill_(1.5)
        data.qvel.assign(np.array([[*[0.3] * (compiled.nv - 1), 0.0]]))
        for _ in range(200):
            mujoco_warp.step(model, data)
        assert data.qpos.numpy()[0] == pytest.approx(_pushed(compiled), abs=1e-6)


@pytest.mark.parametrize("name", BOTH)
def test_many_at_once_move_as_each_alone_and_what_cannot_run_says_so_in_its_place(name: str) -> None:
    random = np.random.default_rng(8)
    tasks: list[Task] = []
    for _ in range(4):
        slider = Slider(*(float(one) for one in random.uniform((0.3, 0.2, 60.0, 1.0), (3.0, 2.0, 140.0, 4.0))))
        scenario = decay(slider, 1.0, float(random.uniform(0.3, 0.9)))
        tasks.append(Task(scenario, "joint", "as-shipped"))
    tasks.insert(2, Task(decay(), "joint", restoring="pendulum"))
    tasks.insert(4, Task(decay(Slider(1.0, 1.0, 100.0, 0.0), 1.0, 0.4), "joint", "as-shipped"))
    found = engine(name).simulate_all(tasks)
    assert isinstance(found[2], SimulationError)
    for task, one in zip(tasks, found, strict=True):
        if one is not found[2]:
            assert isinstance(one, Trajectory)
            alone = engine(name).simulate(task)
            assert one.t.size == alone.t.size
            assert np.abs(one.x - alone.x).max() < 1e-5
            of_c = engine("mujoco").simulate(task)
            assert np.abs(one.x - of_c.x).max() < 1e-5


@pytest.mark.parametrize("name", BOTH)
def test_the_same_slider_many_times_moves_the_same_in_every_world_to_the_last_bit(name: str) -> None:
    found = engine(name).simulate_all([Task(decay(duration=1.0), "joint", "as-shipped")] * 16)
    assert all(isinstance(one, Trajectory) for one in found)
    assert len({one.x.tobytes() + one.v.tobytes() for one in found if isinstance(one, Trajectory)}) == 1


@only("mjx")
def test_sliders_of_other_masses_springs_and_friction_move_as_in_mujoco_to_the_last_digits() -> None:
    """One program serves them all: what differs between their models is given to it."""
    for slider in sliders(seed=3, count=5):
        task = Task(decay(slider, 1.0, 0.5), "joint", "as-shipped", settings={"precision": 64} | stiff(STEP))
        own, of_c = engine("mjx").simulate(task), engine("mujoco").simulate(replace(task, settings=stiff(STEP)))
        assert np.abs(own.x - of_c.x).max() < 1e-11, slider


def creep(name: str, slider: Slider, speed: float, iterations: int, ls_iterations: int, **more: Any) -> float:
    """m/s, after a slide, as tests/fidelity/test_effort.py has it of MuJoCo."""
    effort = {"iterations": iterations, "ls_iterations": ls_iterations, **more}
    scenario = MIDDLE.slide(slider, speed)
    trace = engine(name).simulate(Task(scenario, "joint", "as-shipped", STEP, effort | stiff(STEP)))
    found = MIDDLE.measure(trace, scenario)["creep_m_s"]
    assert found is not None
    return abs(found)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "chosen"), [pytest.param(*row[:2], marks=only(row[0])) for row in ROUNDED], ids=str)
@settings(max_examples=6, deadline=None, derandomize=True)
@given(m=st.floats(0.1, 10.0), f=st.floats(0.3, 30.0), steps=st.floats(20.0, 120.0))
def test_the_search_that_is_recommended_is_as_good_as_full_effort(
    name: str, chosen: dict[str, Any], m: float, f: float, steps: float
) -> None:
    slider = Slider(m, 0.0, 1e-3 * f, f)
    speed = steps * 0.5 * f / m * STEP
    full = creep(name, slider, speed, 100, 50, **chosen)
    assert creep(name, slider, speed, 1, 50, **chosen) <= 1.01 * full + line_search_creep(m, f, STEP, 30)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "chosen"), [pytest.param(*row[:2], marks=only(row[0])) for row in ROUNDED], ids=str)
def test_on_a_floor_four_iterations_with_the_recommended_search_are_as_good_as_full_effort(
    name: str, chosen: dict[str, Any]
) -> None:
    """A box that stops under half of its friction, on an elliptic cone of impratio 100."""
    random = np.random.default_rng(12)
    for _ in range(4):
        m, mu = float(np.exp(random.uniform(-1.5, 1.5))), float(random.uniform(0.02, 0.06))
        slider = Slider(m, 0.0, 1e-3 * m, mu * m * 9.81)
        scenario = MIDDLE.slide(slider, float(random.uniform(20.0, 120.0)) * 0.5 * mu * 9.81 * STEP)
        found = []
        for iterations in (100, 4):
            effort = {"iterations": iterations, "ls_iterations": 50, "cone": "elliptic", "impratio": 100.0} | chosen
            trace = engine(name).simulate(Task(scenario, "contact", "as-shipped", STEP, effort))
            found.append(MIDDLE.measure(trace, scenario))
        full, few = (abs(one["creep_m_s"] or 0.0) for one in found)
        assert few <= 1.05 * full + 1e-5
        assert abs((found[0]["rest_error_m"] or 0.0) - (found[1]["rest_error_m"] or 0.0)) < 1e-5


@pytest.mark.parametrize("name", BOTH)
def test_rows_of_a_gpu_are_made_where_they_are_asked_for_alone(name: str) -> None:
    engines = {name: engine(name)}
    assert not [spec for spec in Matrix().specs(engines) if spec.preset == GPU]
    asked = list(Matrix(presets=(GPU,)).specs(engines))
    assert asked
    assert all(dict(spec.changed)["device"] == "gpu" and "device=gpu" in spec.name for spec in asked)
    trained = [dict(spec.changed) for spec in Matrix(presets=(TRAINED,)).specs(engines)]
    assert {one.get("precision") for one in trained} == ({32, 64} if name == "mjx" else {None})
