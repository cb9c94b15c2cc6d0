"""Draws: repeatable, concealed, decidable; engines as the second source; closed forms of what is drawn."""

import json
import math
import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError
from harness.proof.engine_source import ENGINE_KINDS, ENGINES, EngineName, Task, draw_engine, engine_motion
from harness.proof.plant.base import Base, draw_decay
from harness.proof.plant.base_fit import Seen, decay_motion, fit_decay, fit_simulated, replayed, whiten
from harness.proof.plant.cases import Case, decrement, draw, truth
from harness.proof.plant.effects import ALIENS, KINDS
from harness.proof.plant.hidden import Noise, build, regions
from harness.proof.plant.integrate import simulate
from harness.proof.plant.model import base_model
from harness.proof.plant.strengths import DRAWS
from harness.proof.score import forced

BASE = Base(1.0, 20.0, 0.02, 0.002, 0.1, 0.0, 0.1, 3.0, 1500)


def case_of(kind: str, seed: int = 3) -> Case:
    return draw(kind, np.random.default_rng(seed))


@pytest.mark.parametrize("kind", [*(k for k in KINDS if k != "static-friction"), *ALIENS])
def test_draws_are_concealed_and_decidable(kind: str) -> None:
    case = case_of(kind)
    assert case.mechanisms == (kind,)
    assert min(case.base_r2) > 0.98
    assert case.base_chi2_excess > 100.0
    said = truth(case)
    assert json.loads(json.dumps(said)) == said
    assert said["duration"] == pytest.approx(case.base.duration)
    assert (said["region"] is not None) == (kind in ("end-stop", "sensor-clipping", "impulse"))
    for channel in case.channels:
        left = case.recorded[channel] - case.clean[channel]
        assert np.std(left) == pytest.approx(case.noise.sigma[channel], rel=5.0 / math.sqrt(left.size))


def test_static_friction_is_driven_and_sticks() -> None:
    case = case_of("static-friction")
    assert case.setting == "driven"
    assert "u" in case.recorded
    run = simulate(build(case.base, case.effects)[0], case.base.times)
    assert 0.02 < run.stuck.mean() < 0.95


def test_base_fit_of_controls_is_as_good_as_the_truth() -> None:
    excess = np.array([draw("control", np.random.default_rng([7, i])).base_chi2_excess for i in range(12)])
    assert np.all(excess <= 1e-6)
    # five parameters are fitted: the loss of chi-square is chi-square with four or five degrees of freedom
    assert -7.0 < excess.mean() < -2.5


def test_both_fits_find_the_same_minimum() -> None:
    base = replace(BASE, v0=0.4)
    model, sensors = build(base, {"quadratic-drag": {"c2": 0.02}})
    noise = Noise({"x": 1e-4, "a": 0.3})
    clean = sensors.read(model, base.times)[1]
    seen = {c: noise.spoil(c, clean[c], np.random.default_rng(1)) for c in ("x", "a")}
    closed = fit_decay(base.times, Seen(seen, noise.sigma), (20.0, 0.02, 0.002, 0.1, 0.4))
    through = fit_simulated(base, {}, Seen(seen, noise.sigma))
    assert through.chi2 == pytest.approx(closed.chi2, rel=1e-3)
    assert through.parameters == pytest.approx(closed.parameters, rel=1e-3)


def test_pairs_are_decidable_part_by_part() -> None:
    case = draw(("cubic-stiffness", "sensor-gain"), np.random.default_rng(2))
    assert set(case.part_chi2_excess) == {"cubic-stiffness", "sensor-gain"}
    assert min(case.part_chi2_excess.values()) > 60.0
    assert case.channels == "xa"
    assert truth(case)["families"] == ["stiffness", "sensor"]


@pytest.mark.parametrize("setting", ["pendulum", "driven", "axis-unit-mass"])
def test_other_settings_give_controls(setting: str) -> None:
    case = draw("control", np.random.default_rng(11), setting=setting)
    assert ("u" in case.recorded) == (setting != "pendulum")
    assert case.base_chi2_excess < 10.0
    assert min(case.base_r2) > 0.98


def test_sensors_do_what_the_catalogue_says() -> None:
    plain, sensors = build(BASE, {})
    run, clean = sensors.read(plain, BASE.times)
    assert np.array_equal(clean["x"], run.x)
    effects = {
        "sensor-lag": {"lag": 0.05},
        "sensor-drift": {"rate": 0.001},
        "sensor-gain": {"gain": 1.1},
        "sensor-bias": {"bias": 0.5},
        "sensor-clipping": {"limit": 30.0},
    }
    model, sensors = build(BASE, effects)
    _, seen = sensors.read(model, BASE.times)
    late = simulate(plain, BASE.times + 0.0).x
    shifted = np.where(BASE.times < 0.05, 0.1, np.interp(BASE.times - 0.05, BASE.times, late))
    assert seen["x"] - 0.001 * BASE.times == pytest.approx(shifted, abs=1e-4)
    assert np.all(seen["x"][BASE.times < 0.05] == 0.1 + 0.001 * BASE.times[BASE.times < 0.05])
    assert seen["a"] == pytest.approx(np.clip(1.1 * run.a + 0.5, -30.0, 30.0), abs=1e-6)


def test_noise_has_the_colour_and_the_steps_it_is_given() -> None:
    rng = np.random.default_rng(5)
    coloured = Noise({"x": 2.0}, correlation=0.6).spoil("x", np.zeros(200_000), rng)
    assert np.std(coloured) == pytest.approx(2.0, rel=0.02)
    assert np.corrcoef(coloured[1:], coloured[:-1])[0, 1] == pytest.approx(0.6, abs=0.01)
    assert np.std(whiten(coloured, 2.0, 0.6)) == pytest.approx(1.0, rel=0.02)
    stepped = Noise({"x": 1.0}, step={"x": 3.0})
    values = stepped.spoil("x", np.linspace(0.0, 1000.0, 50_000), rng)
    assert np.array_equal(values, np.round(values / 3.0) * 3.0)
    assert np.std(values - np.linspace(0.0, 1000.0, 50_000)) == pytest.approx(stepped.total("x"), rel=0.02)


def test_regions_are_where_the_effect_acts() -> None:
    effects = {"end-stop": {"gap": 0.08, "k_stop": 100.0, "side": "upper"}}
    run = simulate(build(BASE, effects)[0], BASE.times)
    spans = regions(effects, BASE, run.x, np.zeros(BASE.samples, dtype=bool))
    assert spans is not None
    inside = np.zeros(BASE.samples, dtype=bool)
    for lo, hi in spans:
        inside |= (BASE.times >= lo) & (BASE.times < hi)
    assert np.array_equal(inside, run.x > 0.08)
    knock = regions({"impulse": {"time": 1.0, "impulse": 0.1}}, BASE, run.x, inside)
    assert knock is not None
    assert knock[0] == pytest.approx([1.0 - math.pi / 40.0, 1.0 + math.pi / 40.0], abs=0.005)
    assert regions({"quadratic-drag": {"c2": 1.0}}, BASE, run.x, inside) is None


def test_a_recorded_force_is_replayed() -> None:
    t = np.linspace(0.0, 2.0, 201)
    law = replayed(t, np.sin(5.0 * t), 5.0).law
    at = np.linspace(0.0, 2.0, 1777)
    assert [law(s, 0.0, 0.0) for s in at] == pytest.approx(list(np.sin(5.0 * at)), abs=1e-6)


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


T = np.linspace(0.0, 5.0, 3000)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("channel", ["x", "a"])
def test_a_decay_without_noise_gives_its_numbers(channel: str, sign: float) -> None:
    x, _, a = decay_motion(T, 20.0, 0.02, 0.02, sign, 0.0)
    found = decrement(T, x if channel == "x" else a, channel)
    assert found.omega_n == pytest.approx(20.0, rel=0.01)
    assert found.zeta == pytest.approx(0.02, rel=0.1)
    assert found.x_k == pytest.approx(0.02, rel=0.1)
    assert found.plausible(20.0, 1.0)


@pytest.mark.parametrize("kind", ["control", "cubic-stiffness", "stribeck"])
def test_what_is_drawn_is_plausible_in_each_channel(kind: str) -> None:
    for seed in range(4):
        case = draw(kind, np.random.default_rng([5, seed]))
        for channel in case.channels:
            found = decrement(case.recorded["t"], case.recorded[channel], channel)
            assert found.plausible(case.base.omega_n, case.base.length)


CONTROL: dict[str, Any] = {"mechanisms": [], "channels": "xa"}


def _said(x: float, a: float | None, verdict: str = "adequate") -> dict[str, Any]:
    after = {"x": x} if a is None else {"x": x, "a": a}
    block = {"name": "stribeck", "baseline_rmse": {"x": 1.0, "a": 2.0}, "refined_rmse": after}
    return {"verdict": verdict, "holdout": {"forced": block}}


def test_the_worst_channel_of_the_worst_control_counts() -> None:
    found = forced({"1": CONTROL, "2": CONTROL}, {"1": _said(1.01, 2.0), "2": _said(1.0, 2.08)})
    assert (found.cases, found.worst_file) == (2, "2")
    assert found.worst == pytest.approx(1.04)
    assert not found.above
    assert not found.shortfalls()


def test_what_is_withheld_counts_against_and_effects_do_not_count_at_all() -> None:
    truths = {"1": CONTROL, "2": CONTROL, "3": CONTROL, "4": {"mechanisms": ["stribeck"], "channels": "x"}}
    silent = {"verdict": "adequate", "holdout": {}}
    found = forced(truths, {"1": silent, "2": _said(1.0, None), "4": _said(9.0, 9.0)})
    assert found.withheld == ("1",)
    assert found.worst == math.inf
    assert found.named == ("3",)
    assert found.as_dict()["worst"] is None
    assert len(found.shortfalls()) == 2
