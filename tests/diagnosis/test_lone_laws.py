"""A lone law that meets the noise is named on a bench; on a machine it needs what names a main effect."""

import numpy as np
import pytest

from harness.core.recording import Recording
from harness.diagnosis.explain.verdict_sentence import sentence_of
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.request import Asked
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm, Restoring


def recorded(seconds: float) -> Recording:
    """Quadratic drag on a spring of 1 Hz, let go from .1 m; x at 200 Hz, noise .6 mm, the encoder's zero .03 m off."""
    model = Model(1.0, 0.02, 40.0, 0.01, x0=0.1, terms=(ModelTerm.named("quadratic-drag", c2=1.5),))
    t = np.arange(0.0, seconds, 0.005)
    noise = np.random.default_rng(20261124).normal(0.0, 6e-4, t.size)
    return Recording(t=t, channels={"x": 0.03 + solve(model, t).x + noise}, file="drag.csv")


def test_few_cycles_with_an_unknown_zero_make_the_law_most_likely_and_name_the_recording_that_would_decide() -> None:
    asked = Asked(restoring=Restoring.SPRING, zero_free=True)
    short, long = (diagnose(prepare(recorded(seconds), asked)[0]) for seconds in (5.0, 14.0))
    assert (long.verdict, [m.name for m in long.mechanisms]) == ("missing_physics", ["quadratic-drag"])
    assert long.mechanisms[0].probability is not None
    # the rest belongs to a Stribeck curve of any shape
    assert long.mechanisms[0].probability > 0.8
    assert short.mechanisms[0].name == "quadratic-drag"
    assert short.refined.model.terms[0].term.name == "quadratic-drag"
    assert "to its noise" in sentence_of(short)
    assert any("cycles are few to exclude every other name; a decay of 8 would do" in one for one in short.warnings)
    assert short.next_experiment
    # a lone name is no list, and each name has its probability, which with that of none adds up to one
    assert (short.verdict == "one_of") is (len(short.mechanisms) > 1)
    assert sum(h.probability for h in short.posterior) == pytest.approx(1.0, abs=0.05)
    assert {h.names: h.probability for h in short.posterior}[("quadratic-drag",)] == short.mechanisms[0].probability
