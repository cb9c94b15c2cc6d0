"""An oscillator near whose resonance a period has ten samples, driven by a multisine: a circuit, a beam, a speaker."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness import stages
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import driven_scales
from harness.diagnosis.fit.model_fit import Fit, fit
from harness.diagnosis.parameters import free_of
from harness.diagnosis.pipeline import diagnose
from harness.diagnosis.prepare.intersample import between_samples
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.search.search import noise_of, under
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring

RATE = 610.0
OMEGA = 2.0 * math.pi * 60.0
T: FloatArray = np.arange(1200.0) / RATE
LINES: FloatArray = 2.0 * math.pi * np.arange(1.0, 200.0, 0.7)
PHASES: FloatArray = np.random.default_rng(5).uniform(0.0, 2.0 * math.pi, LINES.size)
LINEAR = Model(m=1.5, c=2.0 * 0.05 * 1.5 * OMEGA, k=1.5 * OMEGA**2, f_k=0.0)
HARDENING = replace(LINEAR, terms=(ModelTerm.named("cubic-stiffness", k3=0.4 * LINEAR.k / 5e-5**2),))


def multisine(t: FloatArray) -> FloatArray:
    """Lines up to a third of the sampling rate, N."""
    return np.asarray(np.cos(np.multiply.outer(t, LINES) + PHASES) @ np.full(LINES.size, LINES.size**-0.5))


def steady(t: FloatArray) -> FloatArray:
    """How the linear oscillator moves under it, m."""
    moves = np.exp(1j * PHASES) / (LINEAR.k - LINEAR.m * LINES**2 + 1j * LINEAR.c * LINES) / LINES.size**0.5
    return np.asarray((np.exp(1j * np.multiply.outer(t, LINES)) @ moves).real)


def recorded(x: FloatArray, noise: float = 0.005) -> Recording:
    """With noise of the position, of its rms."""
    seen = x + noise * float(np.std(x)) * np.random.default_rng(6).standard_normal(T.size)
    return Recording(t=T, channels={"x": seen, "u": multisine(T)})


def finely(model: Model) -> FloatArray:
    """A motion under the multisine itself, from rest."""
    fine = np.arange(T.size * 16) / (16.0 * RATE)
    return solve(model, T, drive=Drive(fine, multisine(fine))).x


def prepared(recording: Recording) -> Driven:
    problem = stages.prepare(recording).problem
    assert isinstance(problem, Driven)
    return problem


def is_linear(found: Fit) -> None:
    errors = np.sqrt(np.diag(found.covariance()))
    told = {f.name: (v, e) for f, v, e in zip(found.free, found.values, errors, strict=True)}
    for name in ("m", "c", "k"):
        value, error = told[name]
        assert value == pytest.approx(getattr(LINEAR, name), abs=4.0 * error)
        assert error < 0.01 * value


def test_a_force_is_known_between_its_samples_where_its_spectrum_ends() -> None:
    drive, _ = between_samples(T, multisine(T))
    inside = np.arange(0.1, 0.3, 1e-5)
    momentum = np.cumsum(np.interp(inside, drive.t, drive.u) - multisine(inside)) * 1e-5
    lines = np.cumsum(np.interp(inside, T, multisine(T)) - multisine(inside)) * 1e-5
    assert float(np.std(momentum)) < 0.01 * float(np.std(lines))


def test_a_linear_oscillator_is_followed_and_has_its_numbers() -> None:
    problem = prepared(recorded(steady(T)))
    assert problem.restoring is Restoring.SPRING
    based = stages.fit_base(problem)
    assert based.fit.chi2 / based.fit.points < 1.2
    is_linear(based.fit)


def test_a_force_that_is_held_is_told_from_one_whose_spectrum_ends() -> None:
    held = Drive(T, multisine(T), held=True)
    problem = prepared(recorded(solve(LINEAR, T, drive=held).x))
    assert problem.is_held
    is_linear(stages.fit_base(problem).fit)


def test_a_hardening_spring_is_a_spring_and_its_law_leaves_noise() -> None:
    problem = prepared(recorded(finely(HARDENING)))
    assert problem.restoring is Restoring.SPRING
    for name in ("m", "c", "k"):
        assert getattr(problem.first, name) == pytest.approx(getattr(LINEAR, name), rel=0.03)
    near = replace(problem.first, terms=(ModelTerm.named("cubic-stiffness", k3=0.3 * LINEAR.k / 5e-5**2),))
    scales = driven_scales(problem, problem.first)
    found = fit(near, problem, free_of(near, problem.base_names), scales)
    found = under(found, replace(problem, noise=noise_of(found, problem, scales.omega)))
    assert found.chi2 / found.points < 1.2
    assert found.model.terms[0].values[0] == pytest.approx(HARDENING.terms[0].values[0], rel=0.01)


@pytest.mark.full
@pytest.mark.parametrize("model", [LINEAR, HARDENING])
def test_what_hardens_is_named_and_nothing_else(model: Model) -> None:
    outcome = diagnose(prepared(recorded(finely(model))))
    assert [m.name for m in outcome.mechanisms] == [entry.term.name for entry in model.terms]
    assert outcome.verdict == ("missing_physics" if model.terms else "adequate")
