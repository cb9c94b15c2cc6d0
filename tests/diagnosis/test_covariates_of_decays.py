"""Covariates of free decays: what was put in is found, what says nothing is refused, what else is missing is named."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.fit.observe import observe
from harness.diagnosis.fit.parameters import free_of, values_of, with_values
from harness.diagnosis.fit.standard_errors import base_parameters
from harness.diagnosis.kinds.known import kind_of
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import diagnose, fit_base, prepare
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.request import Asked, AskedCovariate
from harness.diagnosis.residual_tests.structure import structure
from harness.diagnosis.rules import STRUCTURE
from harness.estimate.noise import Noise
from harness.kernels.solve import Scales
from harness.model.covariate import Acts, Covariate
from harness.model.model import Model, ModelTerm, Restoring

OMEGA, X, K3 = 7.0, 0.3, 25.0
ZETA, X_K = 0.01, 0.0015
GAIN = {Acts.FORCE: 0.3, Acts.FRICTION: 0.3, Acts.DAMPING: 0.4}
T: FloatArray = 0.021 * np.arange(400, dtype=np.float64)
FINE = 600
"""Steps between samples."""


def pressure(t: FloatArray) -> FloatArray:
    """Of no simple relation to the motion, in bar."""
    return 3.0 + 0.8 * np.sin(1.1 * t + 0.4) + 0.5 * np.sin(2.3 * t + 1.0)


@cache
def stepped(acts: Acts | None, pendulum: bool = False, cubic: float = 0.0) -> FloatArray:
    """Positions (400,) of a decay stepped here by itself, without noise.

    Semi-implicit steps of 35 us; friction takes off what speed there is and no more (Moreau's projection).
    """
    h = (T[1] - T[0]) / FINE
    t = np.arange((T.size - 1) * FINE + 1) * h
    change = (GAIN[acts] if acts else 0.0) * (pressure(t) - float(np.mean(pressure(T))))
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
    return np.array(path)[::FINE]


def decay(acts: Acts | None, pendulum: bool = False, cubic: float = 0.0, seed: int = 1) -> Recording:
    """The motion with noise of 20 um, the pressure with noise of 2 mbar."""
    draw = np.random.default_rng(seed)
    x = stepped(acts, pendulum, cubic) + 2e-5 * draw.standard_normal(T.size)
    p = pressure(T) + 2e-3 * draw.standard_normal(T.size)
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
    problem = FreeDecay(t, {"x": t}, {"x": Noise(1e-4, True)}, covariates={"P": pressure(t)})
    free, scales = free_of(model, ("c", "k", "f_k", "x0")), Scales.of(model)
    seen, values = observe(model, problem, tuple(f.by for f in free), scales), values_of(model, free)
    for i in range(len(free)):
        h = np.zeros(len(free))
        h[i] = 1e-4 * max(abs(values[i]), 0.01)
        up, down = (observe(with_values(model, free, values + s * h), problem, (), scales).y["x"] for s in (1.0, -1.0))
        difference = (up - down) / (2.0 * h[i])
        assert seen.dy["x"][:, i] == pytest.approx(difference, abs=2e-3 * float(np.max(np.abs(difference))))


@pytest.mark.parametrize("acts", list(Acts))
def test_the_way_in_is_chosen_and_its_gain_recovered_within_three_standard_errors(acts: Acts) -> None:
    found = fit_base(prepare(decay(acts), asked())[0])
    (chosen,) = found.fit.model.covariates
    gain = base_parameters(found.fit, found.problem, found.scales.omega, explained=True)["gain_P"]
    assert structure(found.fit, found.problem, found.scales.omega).p_value > STRUCTURE.value
    assert chosen.acts is acts
    assert gain.stderr is not None
    assert gain.stderr < 0.03 * GAIN[acts]
    assert gain.value is not None
    assert abs(gain.value - GAIN[acts]) < 3.0 * gain.stderr
    assert gain.unit == ("N per kg per bar" if acts is Acts.FORCE else "1 per bar")
    assert found.problem.choices[0].startswith("P enters as ")
    assert "not predicted" in found.problem.choices[0]


def test_a_pendulum_has_covariates_too() -> None:
    problem, _ = prepare(decay(Acts.FRICTION, pendulum=True), asked(restoring=Restoring.PENDULUM))
    based = fit_base(problem)
    assert kind_of(based.whole) is kind_of(problem)
    assert based.fit.chi2 < 1.2 * based.fit.points
    assert based.fit.model.covariates[0].gain == pytest.approx(GAIN[Acts.FRICTION], rel=0.03)


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
    assert found.refined.model.covariates[0].gain == pytest.approx(GAIN[Acts.FRICTION], rel=0.05)
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
def test_a_covariate_that_says_nothing_is_refused_in_one_line(values: FloatArray, why: str) -> None:
    recording = replace(decay(None), covariates={"P": values})
    with pytest.raises(InputError) as error:
        fit_base(prepare(recording, asked(Acts.FRICTION))[0])
    assert "covariate P: " in str(error.value)
    assert why in str(error.value)
    assert "\n" not in str(error.value)
