"""Draws: repeatable, concealed, decidable; sensors and noise; files; nothing shared with the fitting side."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from harness.proof.plant.base import Base
from harness.proof.plant.base_fit import Seen, fit_decay, fit_simulated, replayed, whiten
from harness.proof.plant.cases import Case, draw, truth
from harness.proof.plant.effects import ALIENS, KINDS
from harness.proof.plant.hidden import Noise, build, regions
from harness.proof.plant.integrate import simulate

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
