"""Standard errors: beside a misfit, at a bound, of noise that is the sensor's own, and what could hide."""

import math
from dataclasses import replace

import numpy as np
import pytest

import harness
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.core.slider import Slider
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.fit.standard_errors import AT_LEAST, base_parameters, clustered_covariance, term_parameters
from harness.diagnosis.parameters import free_of
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.request import Asked
from harness.exact.decay import Decay, free_decay
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring
from harness.results.common import P

SIGMA = 1e-4


def recorded(model: Model, seed: int) -> Recording:
    t = np.arange(0.0, 6.0, 0.004)
    x = solve(model, t).x
    return Recording(t, {"x": x + SIGMA * np.random.default_rng(seed).standard_normal(t.size)}, "decay")


def slider(*terms: ModelTerm) -> Model:
    return Model(1.0, 0.3, 100.0, 0.8, x0=1.0, terms=terms)


def test_on_noise_alone_blocks_say_what_the_curvature_says() -> None:
    ratios = []
    for seed in range(6):
        problem, _ = prepare(recorded(slider(), seed), Asked())
        found, scales = baseline(problem)
        plain = found.covariance()
        ratios.append(np.diag(clustered_covariance(found, problem, scales.omega)) / np.diag(plain))
    mean = np.mean(ratios, axis=0)
    assert np.all(mean > 0.4)
    assert np.all(mean < 2.0)


def test_with_a_misfit_the_truth_lies_within_two_standard_errors() -> None:
    """A hum of any frequency and phase left out: zeta of the base model errs by what the hum happens to do."""
    random = np.random.default_rng(3)
    draws, inside = 10, 0
    for seed in range(draws):
        hum = ModelTerm.named("harmonic-force", A=0.4, Omega=random.uniform(3.0, 30.0), phase=random.uniform(0.0, 6.0))
        problem, _ = prepare(recorded(slider(hum), seed), Asked())
        found, scales = baseline(problem)
        zeta = base_parameters(found, problem, scales.omega, explained=False)["zeta"]
        assert zeta.value is not None
        assert zeta.stderr is not None
        inside += abs(zeta.value - 0.015) < 2.0 * zeta.stderr
    assert inside >= 0.8 * draws


def test_a_phase_is_within_half_a_turn_however_far_its_fit_has_wandered() -> None:
    hum = ModelTerm.named("harmonic-force", A=0.4, Omega=7.0, phase=0.3)
    problem, _ = prepare(recorded(slider(hum), 1), Asked(restoring=Restoring.SPRING, zero_free=False))
    model = slider(ModelTerm.named("harmonic-force", A=0.4, Omega=7.0, phase=0.3 + 400.0 * math.pi))
    found = fit(model, problem, free_of(model, problem.base_names))
    phase = term_parameters(found, problem, 0, 10.0)["phase"]
    assert phase.value == pytest.approx(0.3, abs=5.0 * (phase.stderr or 0.0))


@pytest.mark.parametrize("span", [40, 100])
def test_too_short_a_stretch_gives_no_finite_error(span: int) -> None:
    problem, _ = prepare(recorded(slider(), 0), Asked())
    found, scales = baseline(problem)
    # as if the swing were so slow that the recording held a few blocks alone
    assert np.all(np.isinf(clustered_covariance(found, problem, scales.omega / span)))


def test_on_its_upper_bound_a_number_is_a_least_one() -> None:
    t = np.arange(0.0, 3.0, 2e-3)
    slider = Model(1.0, 0.4, 100.0, 2.0, x0=1.0)
    x = solve(slider, t).x + 1e-4 * np.random.default_rng(0).standard_normal(t.size)
    problem, _ = prepare(Recording(t, {"x": x}, "coulomb"), Asked())
    found, scales = baseline(problem)
    stiff = replace(found.model, terms=(ModelTerm.named("presliding", sigma0=1e4 * found.model.k, sigma1=0.0),))
    seen = fit(stiff, problem, free_of(stiff, ("c", "f_k")), scales, iterations=0)
    quantity = term_parameters(seen, problem, 0, scales.omega)["sigma0"]
    assert quantity.stderr is None
    assert quantity.why == AT_LEAST


@pytest.mark.parametrize(
    ("law", "values", "parameter", "most"),
    [
        ("sensor-lag", {"lag": -7.8e13}, "lag", 3.0),
        ("end-stop", {"gap": 1e12, "k_stop": 50.0}, "gap", 20.0),
        ("viscoelastic", {"k_m": 10.0, "tau": 1e15}, "tau", 60.0),
        ("harmonic-force", {"A": 0.1, "Omega": 1e14, "phase": 0.0}, "Omega", 7e3),
    ],
)
def test_no_fit_goes_where_the_recording_could_show_nothing(
    law: str, values: dict[str, float], parameter: str, most: float
) -> None:
    t = np.arange(0.0, 3.0, 2e-3)
    seen = solve(Model(1.0, 0.4, 100.0, 2.0, x0=1.0), t)
    random = np.random.default_rng(0)
    x, a = (y + level * random.standard_normal(t.size) for y, level in ((seen.x, 1e-4), (seen.a, 1e-2)))
    problem, _ = prepare(Recording(t, {"x": x, "a": a}, "coulomb"), Asked())
    found, scales = baseline(problem)
    far = replace(found.model, terms=(ModelTerm.named(law, **values),))
    ended = fit(far, problem, free_of(far, ("c", "f_k")), scales, iterations=4, thorough=False)
    assert abs(ended.model.terms[0].value(parameter)) <= most


def test_a_drag_too_small_to_be_seen_is_within_what_is_said_of_the_damping() -> None:
    t: FloatArray = np.arange(1000.0) / 70.0
    u = 6.0 * np.sin(3.1 * t) + 4.0 * np.sin(7.3 * t + 1.1)
    drag = ModelTerm.named("quadratic-drag", c2=0.08)
    x = solve(Model(2.0, 3.0, 80.0, 1.5, terms=(drag,)), t, drive=Drive(t, u)).x
    x = x + 1e-3 * np.random.default_rng(3).standard_normal(t.size)
    outcome = diagnose(prepare(Recording(t, {"x": x, "u": u}), Asked(Restoring.SPRING, zero_free=False))[0])
    assert outcome.verdict == "adequate"
    assert any("could be hidden" in warning for warning in outcome.warnings)
    for name, true in (("omega_n", 40.0**0.5), ("zeta", 3.0 / 2.0 / (2.0 * 40.0**0.5)), ("x_k", 1.5 / 80.0)):
        number = outcome.base_parameters[name]
        assert number.value is not None
        assert number.stderr is not None
        assert number.systematic is not None
        assert 0.0 < number.systematic < 30.0 * number.stderr
        assert abs(number.value - true) <= 2.0 * number.stderr + number.systematic
        assert P.of(number).model_dump()["systematic"] == number.systematic


@pytest.mark.parametrize("jitter", [0.0, 5e-4])
def test_stamps_that_jitter_are_part_of_the_noise(jitter: float) -> None:
    """An acceleration jumps where dry friction turns round, and a late sample is then taken on the other side."""
    random, t = np.random.default_rng(8), np.arange(0.0, 5.0, 0.01)
    late = np.maximum(t + jitter * random.standard_normal(t.size), 0.0)
    a = free_decay(Decay(15.0, 0.01, 0.8e-3, 0.1), late).a + 0.02 * random.standard_normal(t.size)
    found = harness.diagnose(Recording(t, {"a": a}, "phone.csv"), engines=())
    assert found.verdict == "adequate"
    assert any("stamps jitter" in line for line in found.warnings) == (jitter > 0.0)
    for name, true in (("omega_n", 15.0), ("zeta", 0.01), ("x_k", 0.8e-3)):
        one = found.baseline.parameters[name]
        assert one.value is not None
        assert one.stderr is not None
        assert abs(one.value - true) < 3.0 * one.stderr


@pytest.mark.parametrize("zero", [0.1, 0.4, 0.7])
def test_an_encoder_that_stands_at_the_end_of_a_decay_shifts_nothing(zero: float) -> None:
    """Half of the recording is rest, in which one rounding is read a thousand times; zero : of the encoder, counts."""
    count, true = 9e-5, Slider(1.0, 0.24, 98.6, 0.0756)
    omega_n = math.sqrt(true.k)
    t: FloatArray = 0.0063 * np.arange(3000.0)
    x = free_decay(Decay.of(true, 0.092), t).x
    read = count * np.round(x / count + zero)
    assert np.ptp(read[-1000:]) == 0.0
    found = harness.diagnose(Recording(t, {"x": read}, "encoder.csv"), zero="free", engines=())
    assert found.verdict == "adequate"
    for name, truth in (("omega_n", omega_n), ("zeta", 0.5 * true.c / omega_n), ("x_k", true.f_k / true.k)):
        told = found.baseline.parameters[name]
        assert told.value is not None
        assert told.stderr is not None
        assert abs(told.value - truth) < 3.0 * told.stderr
