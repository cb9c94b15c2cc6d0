"""The second source: engines at converged settings agree with the plant to a fraction of the noise, and share nothing
with the fitting side."""

import math
import subprocess
import sys

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.proof.engine_source import ENGINE_KINDS, ENGINES, EngineName, Task, draw_engine, engine_motion
from harness.proof.plant.base import draw_decay
from harness.proof.plant.cases import draw, truth
from harness.proof.plant.hidden import build
from harness.proof.plant.integrate import simulate
from harness.proof.plant.model import base_model
from harness.proof.plant.strengths import DRAWS

SHORT = ("stribeck", "asymmetric-viscous", "impulse", "end-stop")
LONG = tuple(k for k in ENGINE_KINDS if k not in SHORT and not k.startswith("sensor"))


def _rms(difference: FloatArray) -> float:
    return float(np.sqrt(np.mean(difference**2)))


@pytest.mark.parametrize("engine", ENGINES)
def test_a_control_of_an_engine_is_the_plant_s_to_a_tenth_of_its_noise(engine: EngineName) -> None:
    case = draw_engine("control", np.random.default_rng(0), engine)
    exact = simulate(case.base.model(), case.base.times)
    for channel, values in (("x", exact.x), ("a", exact.a)):
        assert _rms(case.clean[channel] - values) < 0.1 * case.noise.total(channel)
    assert case.source == truth(case)["source"] == engine


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("kind", [*SHORT, *(pytest.param(kind, marks=pytest.mark.full) for kind in LONG)])
def test_a_hidden_force_is_the_plant_s_to_a_tenth_of_the_least_noise(engine: EngineName, kind: str) -> None:
    rng = np.random.default_rng([3, len(kind)])
    base = draw_decay(rng, at_rest=False, length=0.3 if kind == "pendulum-stiffness" else None)
    model = build(base, {kind: DRAWS[kind](base, rng)})[0]
    said, exact = engine_motion(model, base.times, engine), simulate(model, base.times)
    assert _rms(said.x - exact.x) < 0.1 * 0.0005 * base.length
    # a sample beside a jump of the acceleration may lie on its other side
    off = np.sort(np.abs(said.a - exact.a))
    assert _rms(off[:-2]) < 0.1 * 0.002 * base.length * base.omega_n**2
    assert off[-1] < 2.5 * max(base.x_k, 0.05 * base.length) * base.omega_n**2
    assert np.median(np.abs(said.friction - exact.friction)) < 2e-3 * base.f_k


@pytest.mark.parametrize("engine", ENGINES)
def test_dry_friction_stops_the_paper_s_slider_where_it_should(engine: EngineName) -> None:
    run = engine_motion(base_model(1.0, 1.0, 100.0, 3.0, 1.0), np.linspace(0.0, 3.0, 601), engine)
    assert run.x[-1] == pytest.approx(0.010511325485945, abs=5e-5)
    assert run.x[-1] - run.x[540] == pytest.approx(0.0, abs=1e-6)
    turning = run.reversals[(run.reversals < 2.4)]
    assert turning == pytest.approx(math.pi / (10.0 * math.sqrt(1.0 - 0.05**2)) * np.arange(1, 8), abs=5e-4)


def test_draws_are_concealed_decidable_and_repeatable() -> None:
    case, again = (draw_engine("quadratic-drag", np.random.default_rng(6), noise="mixed") for _ in range(2))
    assert case.mechanisms == ("quadratic-drag",)
    assert min(case.base_r2) > 0.98
    assert case.base_chi2_excess > 100.0
    assert all(np.array_equal(case.recorded[c], again.recorded[c]) for c in case.recorded)


def test_sensors_see_the_engine_s_motion_too() -> None:
    case = draw_engine("sensor-lag", np.random.default_rng(2))
    lag = case.effects["sensor-lag"]["lag"]
    exact = simulate(case.base.model(), case.base.times)
    late = np.interp(case.base.times - lag, case.base.times, exact.x)
    assert _rms(case.clean["x"] - late) < _rms(case.clean["x"] - exact.x) / 10.0


@pytest.mark.parametrize(
    ("kind", "engine", "said"),
    [
        ("presliding", "mujoco", "kind: presliding"),
        ("nonsense", "mujoco", "kind: nonsense"),
        ("stribeck", "bullet", "engine: bullet"),
    ],
)
def test_what_an_engine_cannot_hide_is_refused(kind: str, engine: EngineName, said: str) -> None:
    with pytest.raises(InputError, match=said):
        draw_engine(kind, np.random.default_rng(0), engine)


def test_a_plant_with_states_of_its_own_is_refused() -> None:
    case = draw("presliding", np.random.default_rng(3))
    with pytest.raises(SimulationError, match="states of their own"):
        Task(build(case.base, case.effects)[0], 1.0)


@pytest.mark.usefixtures("pybullet")
def test_drawing_from_engines_loads_nothing_of_the_fitting_side() -> None:
    code = (
        "import sys, numpy as np;"
        "from harness.proof.engine_source import ENGINES, draw_engine;"
        "[draw_engine('control', np.random.default_rng(1), engine) for engine in ENGINES];"
        "ours = ('harness.core', 'harness.proof');"
        "print([m for m in sys.modules if m.startswith('harness.') and not m.startswith(ours)])"
    )
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.strip() == "[]"
    assert said.stderr == ""
