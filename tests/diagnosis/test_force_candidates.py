"""Laws as inverse dynamics show them, where a simulation of the base model has gone astray."""

import numpy as np
import pytest

from harness import stages
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.inverse_dynamics.search import by_the_force
from harness.diagnosis.problems.driven import Driven
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring

_PERIOD = 0.014


def _rippled() -> Recording:
    """A free axis that is drawn into the wells of a ripple as it turns: a model without it stops elsewhere."""
    t: FloatArray = np.arange(2500.0) * 5e-3
    random = np.random.default_rng(5)
    sines = zip((0.35, 0.3, 0.2), (1.7, 2.9, 4.7), random.uniform(0.0, 6.0, 3), strict=True)
    u: FloatArray = np.sum([size * np.sin(rate * t + phase) for size, rate, phase in sines], axis=0)
    terms = (ModelTerm.named("force-ripple", amplitude=0.03, period=_PERIOD, phase=1.0),)
    model = Model(m=1.0, c=0.8, k=0.0, f_k=0.12, restoring=Restoring.NONE, terms=terms)
    x = solve(model, t, drive=Drive(t, u)).x + 5e-5 * random.standard_normal(t.size)
    return Recording(t=t, channels={"x": x, "u": u})


def test_the_force_shows_a_ripple_wherever_the_model_has_gone() -> None:
    problem = stages.prepare(_rippled(), restoring="none").problem
    assert isinstance(problem, Driven)
    based = stages.fit_base(problem)
    assert based.fit.chi2 > 30.0 * based.fit.points
    laws = by_the_force(problem, based.fit.model)
    ripple = next(model.terms[0] for model in laws if model.terms[0].term.name == "force-ripple")
    assert ripple.value("period") == pytest.approx(_PERIOD, rel=0.02)
    assert {(model.x0 + model.offset, model.v0, model.t0) for model in laws} == {
        (based.fit.model.x0, based.fit.model.v0, based.fit.model.t0)
    }
    found = stages.search(based).search
    (law,) = found.chosen.model.terms
    assert found.explained
    assert law.term.name == "force-ripple"
    assert law.value("period") == pytest.approx(_PERIOD, rel=1e-3)
    assert abs(law.value("amplitude")) == pytest.approx(0.03, rel=1e-2)
