"""Held out: predicted with a term too many, without a fit, and a fall that is sure or is not."""

import math

import numpy as np
import pytest

from harness.core.errors import SimulationError
from harness.core.recording import Recording
from harness.diagnosis.explain import holdout as periods
from harness.diagnosis.grading.prediction import Predicted, surely_less
from harness.diagnosis.inverse_dynamics import holdout as windows
from harness.diagnosis.pipeline import diagnose, explain, fit_base, judge, prepare, search
from harness.diagnosis.problems.driven import InverseDynamics
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.request import Asked
from harness.estimate.noise import channel_noise
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring
from harness.proof.plant.cases import draw


def test_a_control_is_predicted_as_well_with_the_best_ranked_term_forced_in() -> None:
    case = draw("control", np.random.default_rng(3))
    t, channels = case.recorded["t"], {c: case.recorded[c] for c in case.channels}
    outcome = diagnose(FreeDecay(t, channels, {c: channel_noise(t, y) for c, y in channels.items()}))
    assert outcome.verdict == "adequate"
    forced = outcome.holdout.forced
    assert forced is not None
    assert forced.name
    assert set(forced.refined_rmse) == set(channels)
    for channel, after in forced.refined_rmse.items():
        assert 0.95 < after / forced.baseline_rmse[channel] <= 1.05


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


def _by_span(squares: list[float]) -> Predicted:
    spans = tuple((float(i), float(i + 1)) for i in range(len(squares)))
    return Predicted({"x": np.array(squares)}, np.ones(len(squares)), {"x": 1.0}, spans)


@pytest.mark.parametrize(
    ("after", "sure"),
    [
        # a tenth of each block, though the first misses a hundred times the last
        ([10.0, 3.0, 0.9, 0.3, 0.11], True),
        # all but the largest nearly vanish, which falls to a fifth
        ([20.0, 0.6, 0.1, 0.05, 0.02], True),
        # the largest alone falls; the others rise
        ([10.0, 45.0, 14.0, 4.5, 1.5], False),
        # as much as before, give or take
        ([90.0, 33.0, 9.0, 3.3, 0.9], False),
        ([100.0, 30.0, 10.0, 3.0, 1.0], False),
    ],
)
def test_a_fall_is_sure_by_its_share_of_each_block(after: list[float], sure: bool) -> None:
    """The jackknife's error of a ratio: how unequal the blocks are is no scatter."""
    before = _by_span([100.0, 30.0, 10.0, 3.0, 1.0])
    assert surely_less(_by_span(after), before, 2.0) is sure
    assert not surely_less(before, _by_span(after), 2.0)
