"""What a practitioner would do: it works where it ought to, and says where it has nothing to work on."""

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.proof.baselines.regression import BASE, States, name_by_r2, name_by_sindy, refusal, regressors, states_of
from harness.proof.baselines.sysid import holdout_by_sysid
from harness.proof.plant.base import Base
from harness.proof.plant.effects import FAMILY
from harness.proof.plant.hidden import build

BASE_CASE = Base(1.0, 20.0, 0.015, 0.001, 0.1, 0.0, 0.1, 4.0, 1200)
NOISE = 2e-5


def recording(**effects: dict[str, float]) -> dict[str, FloatArray]:
    """A decay with little noise."""
    model, sensors = build(BASE_CASE, effects)
    clean = sensors.read(model, BASE_CASE.times)[1]
    x = clean["x"] + NOISE * np.random.default_rng(1).standard_normal(BASE_CASE.samples)
    return {"t": BASE_CASE.times, "x": x, "a": clean["a"]}


CUBIC = {"cubic-stiffness": {"k3": 4000.0}}
CONSTANT = {"constant-force": {"force": 1.5}}


def test_regressors_are_names_of_the_catalogue_and_the_base_explains_a_control() -> None:
    states = states_of(recording())
    assert isinstance(states, States)
    laws = regressors(states)
    assert set(laws) - set(BASE) <= set(FAMILY)
    base = np.column_stack([states.smoothed(laws[name]) for name in BASE])
    found = np.linalg.lstsq(base, states.a, rcond=None)[0]
    # smoothing over a tenth of a period takes a little off the second derivative
    assert found[0] == pytest.approx(-400.0, rel=0.01)
    assert found[1] == pytest.approx(-2.0 * 0.015 * 20.0, rel=0.1)
    assert found[2] == pytest.approx(-400.0 * 0.001, rel=0.1)


@pytest.mark.parametrize("effects", [CUBIC, CONSTANT])
def test_r2_names_a_strong_law_of_little_noise(effects: dict[str, dict[str, float]]) -> None:
    assert name_by_r2(recording(**effects)).names == tuple(effects)


@pytest.mark.parametrize("effects", [CUBIC, CONSTANT])
def test_sparse_regression_finds_a_strong_law_of_little_noise(effects: dict[str, dict[str, float]]) -> None:
    pytest.importorskip("pysindy")
    assert set(effects) <= set(name_by_sindy(recording(**effects)).names)


def test_sysid_recovers_a_control_and_predicts_it_to_the_noise() -> None:
    if not hasattr(pytest.importorskip("mujoco.sysid"), "optimize"):
        pytest.skip("mujoco[sysid] is not installed")
    period = 2.0 * np.pi / 20.0
    spans = [[i * period, (i + 1) * period] for i in range(1, 12, 2)]
    found = holdout_by_sysid(recording(), spans)
    assert found.applies
    assert found.parameters is not None
    assert found.parameters["stiffness"] == pytest.approx(400.0, rel=1e-3)
    assert found.parameters["damping"] == pytest.approx(0.6, rel=0.02)
    assert found.parameters["frictionloss"] == pytest.approx(0.4, rel=0.02)
    assert found.rmse["x"] < 10.0 * NOISE
    hidden = holdout_by_sysid(recording(**CUBIC), spans)
    assert hidden.rmse["x"] > 10.0 * found.rmse["x"]


@pytest.mark.parametrize("left_out", ["x", "u"])
def test_what_a_baseline_cannot_use_it_says(left_out: str) -> None:
    seen = recording()
    if left_out == "x":
        del seen["x"]
    else:
        seen["u"] = np.zeros(BASE_CASE.samples)
    said = refusal(seen)
    assert said == ("no position was recorded" if left_out == "x" else "a driven recording")
    for found in (name_by_r2(seen), holdout_by_sysid(seen, [[0.0, 1.0]])):
        assert not found.applies
        assert found.why == said
