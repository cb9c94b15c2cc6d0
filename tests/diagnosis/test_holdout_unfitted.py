"""A fit that fails without what is held out leaves no figure, and says so: a fit of all samples never stands in."""

import math

import numpy as np
import pytest

from harness.core.errors import SimulationError
from harness.core.recording import Recording
from harness.diagnosis.explain import holdout as periods
from harness.diagnosis.inverse_dynamics import holdout as windows
from harness.diagnosis.pipeline import diagnose, explain, fit_base, judge, prepare, search
from harness.diagnosis.problems.driven import InverseDynamics
from harness.diagnosis.request import Asked
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring


def fails(*_: object, **__: object) -> None:
    raise SimulationError("it diverged")


def test_a_fitted_force_without_its_held_out_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    """A force that nobody measured acts too, so that the recorded one is what is fitted."""
    t, draw = np.arange(3000) / 1000.0, np.random.default_rng(7)
    unseen = np.zeros(t.size)
    for i in range(1, t.size):
        unseen[i] = 0.975 * unseen[i - 1] + 0.1 * draw.standard_normal()
    u = 6.0 * np.sin(3.1 * t) + 4.0 * np.sin(7.3 * t + 1.1) + 3.0 * np.sin(14.0 * t + 2.0)
    truth = Model(2.0, 3.0, 0.0, 1.5, restoring=Restoring.NONE)
    x = solve(truth, t, drive=Drive(t, u + unseen)).x + 1e-7 * draw.standard_normal(t.size)
    problem, _ = prepare(Recording(t, {"x": x, "u": u}), Asked(Restoring.NONE))
    assert isinstance(problem, InverseDynamics)
    judged = judge(search(fit_base(problem)))
    whole = explain(judged)
    assert whole.holdout.spans
    # the force that nobody measured is more than noise, and no law
    assert whole.verdict == "unexplained"
    monkeypatch.setattr(windows, "refitted", fails)
    outcome = explain(judged)
    assert (outcome.holdout.spans, outcome.holdout.baseline_rmse, outcome.holdout.refined_rmse) == ((), {}, {})
    assert "the base model, fitted to the rest, cannot be followed" in " ".join(outcome.warnings)
    assert (outcome.verdict, outcome.base_parameters) == (whole.verdict, whole.base_parameters)


def decay() -> Recording:
    truth = Model(1.0, 0.3, 100.0, 0.4, x0=0.1, terms=(ModelTerm.named("quadratic-drag", c2=2.0),))
    t = np.arange(0.0, 4.0, 0.01)
    return Recording(t, {"x": solve(truth, t).x + 1e-5 * np.random.default_rng(2).standard_normal(t.size)})


def test_a_decay_without_its_held_out_periods_and_what_a_lone_term_is_worth(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(periods, "fit", fails)
    outcome = diagnose(prepare(decay(), Asked(zero_free=False))[0])
    assert [m.name for m in outcome.mechanisms] == ["quadratic-drag"]
    assert (outcome.holdout.spans, outcome.holdout.refined_rmse) == ((), {})
    assert "there is no prediction of what is held out: the base model" in " ".join(outcome.warnings)
    # taken out of the refined model, a lone term leaves the base
    assert math.isclose(outcome.mechanisms[0].delta_bic, outcome.base.bic - outcome.refined.bic, rel_tol=1e-12)
