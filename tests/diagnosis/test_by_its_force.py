"""Where the base model shows another motion and no law explains the recording, the force is fitted, not the motion."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from harness import stages
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.kinds import driven
from harness.diagnosis.pipeline import diagnose
from harness.diagnosis.problems.driven import Driven, InverseDynamics
from harness.diagnosis.rules import FOLLOWED
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring

NOTE = (
    "followed, the base model misses more than half of the motion and no law explains it: the force is fitted instead"
)
NAMED = ModelTerm.named


def _recorded(*terms: ModelTerm) -> Any:
    """A free axis under two sines of force."""
    t: FloatArray = np.arange(600.0) / 100.0
    u: FloatArray = 6.0 * np.sin(3.1 * t + 0.3) + 4.0 * np.sin(7.3 * t + 1.1)
    true = Model(2.0, 3.0, 0.0, 1.5, restoring=Restoring.NONE, terms=terms)
    x = solve(true, t, drive=Drive(t, u)).x + 1e-3 * np.random.default_rng(1).standard_normal(t.size)
    return stages.prepare(Recording(t=t, channels={"x": x, "u": u}), restoring="none").problem


def test_what_no_law_explains_is_fitted_by_its_force(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driven, "FOLLOWED", replace(FOLLOWED, value=100.0))
    # two that are not searched together: neither explains
    monkeypatch.setattr(Driven, "pairs_searched", False)
    problem = _recorded(NAMED("force-ripple", amplitude=2.0, period=0.15, phase=0.3), NAMED("quadratic-drag", c2=3.0))
    assert isinstance(problem, Driven)
    outcome = diagnose(problem)
    assert isinstance(outcome.problem, InverseDynamics)
    assert NOTE in outcome.warnings
    # what a force that was never measured leaves of it hides the weaker of the two
    assert outcome.verdict != "adequate"
    assert {m.name for m in outcome.mechanisms} <= {"force-ripple", "quadratic-drag"}


def test_a_law_that_explains_is_followed_however_much_the_base_misses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driven, "FOLLOWED", replace(FOLLOWED, value=100.0))
    outcome = diagnose(_recorded(NAMED("cubic-stiffness", k3=40.0)))
    assert isinstance(outcome.problem, Driven)
    assert [m.name for m in outcome.mechanisms] == ["cubic-stiffness"]
    (k3,) = outcome.mechanisms[0].parameters.values()
    assert k3.value is not None
    assert k3.stderr is not None
    assert abs(k3.value - 40.0) < 5.0 * k3.stderr
