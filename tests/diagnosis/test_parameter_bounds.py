"""A parameter that runs away stops where the recording can no longer tell, and is said to be at least that."""

from dataclasses import replace

import numpy as np
import pytest

from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.fit.parameters import free_of
from harness.diagnosis.fit.standard_errors import AT_LEAST, term_parameters
from harness.diagnosis.pipeline import prepare
from harness.diagnosis.request import Asked
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm


def test_a_bristle_is_no_stiffer_than_a_recording_of_the_spring_can_show() -> None:
    model = Model(1.0, 0.4, 100.0, 2.0, x0=1.0, terms=(ModelTerm.named("presliding", sigma0=1e3, sigma1=0.0),))
    sigma0 = next(f for f in free_of(model, ("k",)) if f.name == "presliding.sigma0")
    assert sigma0.upper == pytest.approx(1e4 * 100.0)


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
