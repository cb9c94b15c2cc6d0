"""Measured covariates, of driven recordings and of decays: what was put in is found, what says nothing is refused."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.fit.standard_errors import base_parameters
from harness.diagnosis.inverse_dynamics.search import force_baseline
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.parameters import free_of, values_of, with_values
from harness.diagnosis.pipeline import diagnose, fit_base, prepare
from harness.diagnosis.problems.asked import given_force, inverse_force
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.request import Asked, AskedCovariate
from harness.diagnosis.residual_tests.structure import structure
from harness.diagnosis.rules import STRUCTURE
from harness.estimate.noise import Noise
from harness.io.options import ReadOptions
from harness.io.recording import read_recording
from harness.kernels.solve import Scales
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


def fitted(recording: Recording, *asked: AskedCovariate) -> tuple[InverseDynamics, Fit]:
    problem, _ = prepare(recording, Asked(Restoring.NONE, covariates=asked))
    assert isinstance(problem, InverseDynamics)
    return problem, fit(problem.first, problem, free_of(problem.first, problem.base_names))


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
    with pytest.raises(InputError, match="column Q: no such column; expected t, x, u, P"):
        read_recording(text, ReadOptions(covariates=("Q",)))


def test_a_force_has_a_level_of_its_own_where_its_covariate_has_its_mean() -> None:
    """What is proportional to a pressure is not nil at its mean; the level is a base parameter, not a missing term."""
    plain = cylinder(Acts.FORCE, 6.0)
    shifted = Recording(plain.t, {**plain.channels, "u": plain["u"] + 40.0}, "bench.csv", covariates=plain.covariates)
    found = []
    for recording in (plain, shifted):
        problem = prepare(recording, Asked(Restoring.NONE, covariates=(AskedCovariate("P", Acts.FORCE),)))[0]
        assert isinstance(problem, InverseDynamics)
        found.append(force_baseline(problem)[0].model)
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
    (base, _), measured = force_baseline(problem), problem.measured
    rms = float(np.sqrt(np.mean(measured.blocks(measured.a) ** 2)))
    assert problem.mass * rms <= 0.1001 * math.sqrt(base.chi2 / base.residual.size)
    assert base.model.f_k == pytest.approx(2.0, rel=0.02)


OMEGA, X, K3 = 7.0, 0.3, 25.0
ZETA, X_K = 0.01, 0.0015
GAINS = {Acts.FORCE: 0.3, Acts.FRICTION: 0.3, Acts.DAMPING: 0.4}
T: FloatArray = 0.021 * np.arange(400, dtype=np.float64)
STEPS = 600
"""Steps between samples."""


def column(t: FloatArray) -> FloatArray:
    """Of no simple relation to the motion, in bar."""
    return 3.0 + 0.8 * np.sin(1.1 * t + 0.4) + 0.5 * np.sin(2.3 * t + 1.0)


@cache
def stepped(acts: Acts | None, pendulum: bool = False, cubic: float = 0.0) -> FloatArray:
    """Positions (400,) of a decay stepped here by itself, without noise.

    Semi-implicit steps of 35 us; friction takes off what speed there is and no more (Moreau's projection).
    """
    h = (T[1] - T[0]) / STEPS
    t = np.arange((T.size - 1) * STEPS + 1) * h
    change = (GAINS[acts] if acts else 0.0) * (column(t) - float(np.mean(column(T))))
    push = change if acts is Acts.FORCE else np.zeros(t.size)
    dry = X_K * OMEGA**2 * (1.0 + change if acts is Acts.FRICTION else np.ones(t.size))
    wet = 2.0 * ZETA * OMEGA * (1.0 + change if acts is Acts.DAMPING else np.ones(t.size))
    x, v, path = X, 0.0, []
    for force, friction, damping in zip(push.tolist(), dry.tolist(), wet.tolist(), strict=True):
        path.append(x)
        back = OMEGA**2 * (math.sin(x) if pendulum else x) + cubic * x**3
        free = v + h * (force - damping * v - back)
        v = math.copysign(max(abs(free) - h * friction, 0.0), free)
        x += h * v
    return np.array(path)[::STEPS]


def decay(acts: Acts | None, pendulum: bool = False, cubic: float = 0.0, seed: int = 1) -> Recording:
    """The motion with noise of 20 um, the pressure with noise of 2 mbar."""
    draw = np.random.default_rng(seed)
    x = stepped(acts, pendulum, cubic) + 2e-5 * draw.standard_normal(T.size)
    p = column(T) + 2e-3 * draw.standard_normal(T.size)
    return Recording(T, {"x": x}, "rig.csv", covariates={"P": p}, units={"P": "bar"}, angular=pendulum)


def asked(kind: Acts | None = None, restoring: Restoring = Restoring.SPRING) -> Asked:
    return Asked(restoring, False, covariates=(AskedCovariate("P", kind),))


@cache
def answered(acts: Acts | None, cubic: float = 0.0, said: Acts | None = None) -> Outcome:
    return diagnose(prepare(decay(acts, cubic=cubic), asked(said))[0])


@pytest.mark.parametrize("acts", list(Acts))
def test_partials_are_those_of_the_motion(acts: Acts) -> None:
    """Central differences of the motion itself, through reversals; of v0 none, which is a corner at rest."""
    law = (ModelTerm.named("cubic-stiffness", k3=K3), ModelTerm.named("stribeck", f_s=0.25, v_s=0.6))
    covariate = Covariate("P", acts, 0.2, 3.0, "bar", 0.1)
    model = Model(1.0, 0.14, OMEGA**2, 0.1, x0=X, t0=0.05, terms=law, covariates=(covariate,))
    t = T[:200]
    problem = FreeDecay(t, {"x": t}, {"x": Noise(1e-4, True)}, covariates={"P": column(t)})
    free, scales = free_of(model, ("c", "k", "f_k", "x0")), Scales.of(model)
    seen, values = observe(model, problem, tuple(f.by for f in free), scales), values_of(model, free)
    for i in range(len(free)):
        h = np.zeros(len(free))
        h[i] = 1e-4 * max(abs(values[i]), 0.01)
        up, down = (observe(with_values(model, free, values + s * h), problem, (), scales).y["x"] for s in (1.0, -1.0))
        difference = (up - down) / (2.0 * h[i])
        assert seen.dy["x"][:, i] == pytest.approx(difference, abs=2e-3 * float(np.max(np.abs(difference))))


@pytest.mark.parametrize("acts", [pytest.param(Acts.FORCE, marks=pytest.mark.full), Acts.FRICTION, Acts.DAMPING])
def test_the_way_in_is_chosen_and_its_gain_recovered_within_three_standard_errors(acts: Acts) -> None:
    found = fit_base(prepare(decay(acts), asked())[0])
    (chosen,) = found.fit.model.covariates
    gain = base_parameters(found.fit, found.problem, found.scales.omega, explained=True)["gain_P"]
    assert structure(found.fit, found.problem, found.scales.omega).p_value > STRUCTURE.value
    assert chosen.acts is acts
    assert gain.stderr is not None
    assert gain.stderr < 0.03 * GAINS[acts]
    assert gain.value is not None
    assert abs(gain.value - GAINS[acts]) < 3.0 * gain.stderr
    assert gain.unit == ("N per kg per bar" if acts is Acts.FORCE else "1 per bar")
    assert found.problem.choices[0].startswith("P enters as ")
    assert "not predicted" in found.problem.choices[0]


def test_a_pendulum_has_covariates_too() -> None:
    problem, _ = prepare(decay(Acts.FRICTION, pendulum=True), asked(restoring=Restoring.PENDULUM))
    based = fit_base(problem)
    assert kind_of(based.whole) is kind_of(problem)
    assert based.fit.chi2 < 1.2 * based.fit.points
    assert based.fit.model.covariates[0].gain == pytest.approx(GAINS[Acts.FRICTION], rel=0.03)


def test_what_does_not_act_is_said_not_to() -> None:
    found = answered(None)
    assert found.verdict == "adequate"
    assert "nothing shows that P acts at all" in found.problem.choices[0]


@pytest.mark.parametrize("said", [Acts.FRICTION, pytest.param(None, marks=pytest.mark.full)])
def test_what_is_missing_besides_is_named(said: Acts | None) -> None:
    """Where nobody says how it enters, that is looked at again beside what was found."""
    found = answered(Acts.FRICTION, cubic=K3, said=said)
    assert [m.name for m in found.mechanisms] == ["cubic-stiffness"]
    assert found.mechanisms[0].parameters["k3"].value == pytest.approx(K3, rel=0.05)
    assert found.refined.model.covariates[0].gain == pytest.approx(GAINS[Acts.FRICTION], rel=0.05)
    assert found.holdout.spans


@pytest.mark.parametrize(
    ("values", "why"),
    [
        (np.full(T.size, 3.0), "the constant 3;"),
        (3.0 + 0.1 * np.random.default_rng(0).standard_normal(T.size), "hardly varies"),
        (3.0 + 0.2 * T, "the base model and time say what it does: as friction 100 %"),
    ],
    ids=["constant", "noise", "time"],
)
def test_a_column_beside_a_decay_that_says_nothing_is_refused_in_one_line(values: FloatArray, why: str) -> None:
    recording = replace(decay(None), covariates={"P": values})
    with pytest.raises(InputError) as error:
        fit_base(prepare(recording, asked(Acts.FRICTION))[0])
    assert "covariate P: " in str(error.value)
    assert why in str(error.value)
    assert "\n" not in str(error.value)
