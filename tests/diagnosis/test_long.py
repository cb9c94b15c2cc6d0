"""A long recording is searched in means of its samples and told on all of them: the same answer, sooner."""

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import diagnose
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.search import long_recordings as long
from harness.estimate.noise import channel_noise
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm

STEP, SAMPLES = 0.002, 6_000
CUBIC = ModelTerm.named("cubic-stiffness", k3=3.0)


def decay(terms: tuple[ModelTerm, ...]) -> Problem:
    t: FloatArray = STEP * np.arange(float(SAMPLES))
    run = solve(Model(1.0, 0.12, 40.0, 0.06, x0=1.0, terms=terms), t)
    draw = np.random.default_rng(4)
    channels: dict[str, FloatArray] = {
        "x": run.x + 2e-3 * draw.standard_normal(t.size),
        "a": run.a + 0.2 * draw.standard_normal(t.size),
    }
    return FreeDecay(t, channels, {c: channel_noise(t, y) for c, y in channels.items()})


def told(problem: Problem, monkeypatch: pytest.MonkeyPatch, samples: int) -> Outcome:
    monkeypatch.setattr(long, "LONG", samples)
    return diagnose(problem)


@pytest.mark.parametrize(
    "terms", [pytest.param((), id="nothing", marks=pytest.mark.full), pytest.param((CUBIC,), id="cubic-stiffness")]
)
def test_means_of_samples_tell_what_all_of_them_tell(
    terms: tuple[ModelTerm, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = decay(terms)
    whole, short = (told(problem, monkeypatch, samples) for samples in (SAMPLES, 1500))
    assert [m.name for m in short.mechanisms] == [m.name for m in whole.mechanisms] == [e.term.name for e in terms]
    assert short.verdict == whole.verdict
    assert short.problem.t.size == whole.problem.t.size == SAMPLES
    for name, quantity in whole.refined_parameters.items():
        assert quantity.stderr is not None
        assert short.refined_parameters[name].value == pytest.approx(quantity.value, abs=0.2 * quantity.stderr + 1e-12)
    for mine, theirs in zip(short.mechanisms, whole.mechanisms, strict=True):
        assert mine.delta_bic == pytest.approx(theirs.delta_bic, rel=0.05)
    for channel, level in {"x": 2e-3, "a": 0.2}.items():
        assert short.problem.noise[channel].sigma == pytest.approx(level, rel=0.03)
