"""Measured covariates: a simulated cylinder whose pressure acts, and what is refused."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.fit.observe import observe
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.inverse_dynamics.asked import given_force, inverse_force
from harness.diagnosis.inverse_dynamics.force_fit import ForceFit, fit_force
from harness.diagnosis.inverse_dynamics.measured import Measured
from harness.diagnosis.inverse_dynamics.search import force_baseline
from harness.diagnosis.pipeline import prepare
from harness.diagnosis.problems.driven import InverseDynamics
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.request import Asked, AskedCovariate
from harness.estimate.noise import Noise
from harness.io.options import ReadOptions
from harness.io.recording import read_recording
from harness.model.covariate import Acts, Covariate
from harness.model.model import Model, ModelTerm, Restoring

M, C, F_K = 2.0, 3.0, 1.5
GAIN = {Acts.FORCE: 1.2, Acts.FRICTION: 0.4, Acts.DAMPING: 0.5}
RATE, FINE = 500, 20


def pressure(t: FloatArray) -> FloatArray:
    """Of no simple relation to the motion, in bar."""
    return 3.0 + 0.8 * np.sin(0.71 * t + 0.4) + 0.5 * np.sin(1.93 * t)


@cache
def cylinder(acts: Acts, seconds: float = 24.0, seed: int = 3) -> Recording:
    """A slider under a known force, stepped here by itself, whose pressure acts; noise of x 1 um, of P 0.01 bar.

    Semi-implicit steps of 0.1 ms; friction takes off what speed there is and no more (Moreau's projection).
    """
    draw = np.random.default_rng(seed)
    n, h = int(seconds * RATE * FINE), 1.0 / (RATE * FINE)
    t = np.asarray(h * np.arange(n), dtype=np.float64)
    u = 6.0 * np.sin(3.1 * t + 0.3) + 4.0 * np.sin(7.3 * t + 1.1) + 3.0 * np.sin(14.0 * t + 2.0)
    change = GAIN[acts] * (pressure(t) - float(np.mean(pressure(t[::FINE]))))
    push = u + (change if acts is Acts.FORCE else 0.0)
    dry = F_K * (1.0 + change) if acts is Acts.FRICTION else np.full(n, F_K)
    wet = C * (1.0 + change) if acts is Acts.DAMPING else np.full(n, C)
    x, v, path = 0.0, 0.0, []
    for force, friction, damping in zip(push.tolist(), dry.tolist(), wet.tolist(), strict=True):
        path.append(x)
        free = v + h / M * (force - damping * v)
        v = math.copysign(max(abs(free) - h / M * friction, 0.0), free)
        x += h * v
    at = slice(None, None, FINE)
    size = t[at].size
    return Recording(
        t[at],
        {"x": np.array(path)[at] + 1e-6 * draw.standard_normal(size), "u": u[at]},
        "cylinder",
        covariates={"P": pressure(t[at]) + 0.01 * draw.standard_normal(size)},
    )


def fitted(recording: Recording, *asked: AskedCovariate) -> tuple[InverseDynamics, ForceFit]:
    problem, _ = prepare(recording, Asked(Restoring.NONE, covariates=asked))
    assert isinstance(problem, InverseDynamics)
    return problem, fit_force(problem.first, Measured.of(problem), free_of(problem.first, problem.base_names))


@pytest.mark.parametrize("acts", list(Acts))
def test_the_way_in_is_chosen_and_its_gain_recovered_within_two_standard_errors(acts: Acts) -> None:
    problem, found = fitted(cylinder(acts), AskedCovariate("P"))
    (chosen,) = found.model.covariates
    assert chosen.acts is acts
    at = [f.name for f in found.free].index("gain_P")
    error = math.sqrt(found.covariance()[at, at])
    assert error < 0.05 * GAIN[acts]
    assert abs(chosen.gain - GAIN[acts]) < 2.0 * error
    assert problem.choices[0].startswith(f"P enters as {chosen.said[:12]}")
    assert "not predicted" in problem.choices[0]


def test_a_simulation_is_given_the_covariate() -> None:
    """Over windows the truth follows a recording with pressure-dependent friction, and a constant one does not."""
    problem, found = fitted(cylinder(Acts.FRICTION, 10.0), AskedCovariate("P", Acts.FRICTION))
    shown, without = (
        observe(model, problem).y["x"] - problem.channels["x"]
        for model in (found.model, Model(found.model.m, found.model.c, 0.0, found.model.f_k, restoring=Restoring.NONE))
    )
    assert np.std(shown) < 0.2 * np.std(without)


def test_friction_of_any_law_is_what_a_covariate_scales() -> None:
    """Where it stays, the model with it is that with its friction so much larger; force and motion agree on it."""
    t = np.linspace(0.0, 1.0, 50)
    x, v, a = 0.1 * np.sin(3.0 * t), 0.3 * np.cos(3.0 * t), -0.9 * np.sin(3.0 * t)
    law = (ModelTerm.named("stribeck", f_s=2.5, v_s=0.1), ModelTerm.named("cubic-stiffness", k3=4.0))
    beside = (Covariate("P", Acts.FRICTION, 0.4, 3.0), Covariate("T", Acts.DAMPING, 0.1, 20.0))
    model = Model(M, C, 50.0, F_K, x0=0.3, terms=law, covariates=beside)
    given = {"P": np.full(50, 3.5), "T": np.full(50, 18.0)}
    scaled = (ModelTerm.named("stribeck", f_s=1.2 * 2.5, v_s=0.1), law[1])
    same = replace(model, f_k=1.2 * F_K, c=0.8 * C, terms=scaled, covariates=())
    assert given_force(model, t, x, v, a, given) == pytest.approx(inverse_force(same, t, x, v, a), rel=1e-12)
    problem = FreeDecay(t, {"x": x}, {"x": Noise(1e-4, True)}, covariates=given)
    assert observe(model, problem).y["x"] == pytest.approx(observe(same, problem).y["x"], abs=1e-8)


def with_covariate(values: FloatArray) -> Recording:
    plain = cylinder(Acts.FORCE, 6.0)
    return Recording(plain.t, dict(plain.channels), "bench.csv", covariates={"P": values})


TIME = np.arange(6 * RATE) / RATE


@pytest.mark.parametrize("kind", [None, Acts.FORCE], ids=["chosen", "given"])
@pytest.mark.parametrize(
    ("values", "why"),
    [
        (np.full(TIME.size, 3.0), "the constant 3;"),
        (3.0 + 0.1 * np.random.default_rng(0).standard_normal(TIME.size), "hardly varies"),
        (
            3.0 + 0.2 * TIME + 0.01 * np.random.default_rng(0).standard_normal(TIME.size),
            "the base model and time say what it does: as a force ",
        ),
        (3.0 + 0.2 * TIME, "the base model and time say what it does: as a force 100 %"),
    ],
    ids=["constant", "noise", "noisy time", "time"],
)
def test_a_covariate_that_says_nothing_is_refused_in_one_line(values: FloatArray, why: str, kind: Acts | None) -> None:
    with pytest.raises(InputError) as error:
        prepare(with_covariate(values), Asked(Restoring.NONE, covariates=(AskedCovariate("P", kind),)))
    assert str(error.value).startswith("bench.csv: covariate P: ")
    assert why in str(error.value)
    assert "\n" not in str(error.value)


def test_columns_are_read_by_name_in_every_format(tmp_path: Path) -> None:
    t = np.arange(100) / 10.0
    table = np.column_stack((t, np.sin(t), np.cos(t), pressure(t)))
    text, arrays = tmp_path / "a.csv", tmp_path / "a.npz"
    np.savetxt(text, table, delimiter=",", header="t,x,u,P [bar]", comments="")
    np.savez(arrays, t=t, x=table[:, 1], u=table[:, 2], P=table[:, 3])
    for path in (text, arrays):
        found = read_recording(path, ReadOptions(start=1.0, covariates=("P",)))
        assert found.covariates["P"] == pytest.approx(pressure(t[10:]))
        assert found.cut(slice(0, 60)).covariates["P"].size == 60
    assert read_recording(text, ReadOptions(covariates=("P",))).units["P"] == "bar"
    with pytest.raises(InputError, match="column Q: no such column; t, x, u, P are accepted"):
        read_recording(text, ReadOptions(covariates=("Q",)))


def test_a_force_has_a_level_of_its_own_where_its_covariate_has_its_mean() -> None:
    """What is proportional to a pressure is not nil at its mean; the level is a base parameter, not a missing term."""
    plain = cylinder(Acts.FORCE, 6.0)
    shifted = Recording(plain.t, {**plain.channels, "u": plain["u"] + 40.0}, "bench.csv", covariates=plain.covariates)
    found = []
    for recording in (plain, shifted):
        problem = prepare(recording, Asked(Restoring.NONE, covariates=(AskedCovariate("P", Acts.FORCE),)))[0]
        assert isinstance(problem, InverseDynamics)
        found.append(force_baseline(problem)[1].model)
    levels = [model.covariates[0].level for model in found]
    assert levels[1] - levels[0] == pytest.approx(-40.0, abs=1e-6)
    assert found[0].covariates[0].gain == pytest.approx(found[1].covariates[0].gain, rel=1e-6)


def test_a_mass_that_the_force_does_not_show_is_taken_so_large_that_its_motion_can_be_simulated() -> None:
    """A slow axis: m a is 1e-5 of the friction. The mass is said to be taken, and moves no number of the fit."""
    t = np.arange(8 * RATE) / RATE
    x = 0.02 * np.sin(0.8 * t) + 0.01 * np.sin(0.31 * t)
    v = 0.016 * np.cos(0.8 * t) + 0.0031 * np.cos(0.31 * t)
    rng = np.random.default_rng(3)
    u = 20.0 * v + 2.0 * np.sign(v) + 0.05 * rng.standard_normal(t.size)
    recording = Recording(t, {"x": x, "u": u}, "slow.csv", covariates={"P": pressure(t)})
    problem, _ = prepare(recording, Asked(Restoring.NONE, covariates=(AskedCovariate("P", Acts.FORCE),)))
    assert isinstance(problem, InverseDynamics)
    assert problem.mass is not None
    assert any("does not show the mass" in said for said in problem.choices)
    measured, base, _ = force_baseline(problem)
    rms = float(np.sqrt(np.mean(measured.blocks(measured.a) ** 2)))
    assert problem.mass * rms <= 0.1001 * math.sqrt(base.squares / base.residual.size)
    assert base.model.f_k == pytest.approx(2.0, rel=0.02)
