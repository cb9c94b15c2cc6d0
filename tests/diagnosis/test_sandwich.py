"""Standard errors of a model that leaves something over: a misfit counts once for half a swing."""

import numpy as np
import pytest

from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.fit.standard_errors import base_parameters, clustered_covariance
from harness.diagnosis.pipeline import prepare
from harness.diagnosis.request import Asked
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm

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
    draws, inside = 20, 0
    for seed in range(draws):
        hum = ModelTerm.named("harmonic-force", A=0.4, Omega=random.uniform(3.0, 30.0), phase=random.uniform(0.0, 6.0))
        problem, _ = prepare(recorded(slider(hum), seed), Asked())
        found, scales = baseline(problem)
        zeta = base_parameters(found, problem, scales.omega, explained=False)["zeta"]
        assert zeta.value is not None
        assert zeta.stderr is not None
        inside += abs(zeta.value - 0.015) < 2.0 * zeta.stderr
    assert inside >= 0.8 * draws


@pytest.mark.parametrize("span", [40, 100])
def test_too_short_a_stretch_gives_no_finite_error(span: int) -> None:
    problem, _ = prepare(recorded(slider(), 0), Asked())
    found, scales = baseline(problem)
    # as if the swing were so slow that the recording held a few blocks alone
    assert np.all(np.isinf(clustered_covariance(found, problem, scales.omega / span)))
