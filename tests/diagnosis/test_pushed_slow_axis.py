"""A slow axis that something pushes all the time: what the push does is not taken for a mass, a spring or a clock."""

import numpy as np
import pytest

from harness import stages
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.inverse_dynamics.unseen_mass import with_unseen_mass
from harness.diagnosis.pipeline import diagnose
from harness.diagnosis.problems.driven import InverseDynamics

PUSH, MASS = 150.0, 0.1


def recorded(push: float = PUSH) -> Recording:
    """Strokes of 36 mm in about 4 s each, of which no two are alike; the force that they take beside what pushes."""
    t: FloatArray = np.arange(4000.0) / 100.0
    phase = 0.77 * t + 0.25 * np.sin(0.23 * t) + 0.1 * np.sin(0.41 * t + 1.0)
    x = 0.018 * np.tanh(1.6 * np.sin(phase)) / np.tanh(1.6) + 0.017
    v, random = np.gradient(x, t), np.random.default_rng(5)
    a = np.gradient(v, t)
    own = np.zeros(t.size)
    for i in range(1, t.size):
        # what a seal does that nobody models, correlated over a tenth of a second
        own[i] = 0.9 * own[i - 1] + 0.1 * random.standard_normal()
    u = MASS * a + 300.0 * v + 4.0 * np.tanh(v / 1e-3) + push + own
    return Recording(t=t, channels={"x": x + 2e-5 * random.standard_normal(t.size), "u": u})


def test_a_push_is_named() -> None:
    outcome = diagnose(stages.prepare(recorded()).problem)
    (push,) = (m for m in outcome.mechanisms if m.name == "constant-force")
    assert push.grade is not None
    assert push.grade.value in ("main", "one-of", "explains")
    (force,) = push.parameters.values()
    assert force.value is not None
    # as the equation of motion has it: on the side of what drives
    assert force.value == pytest.approx(-PUSH, rel=0.01)
    assert [m.name for m in outcome.mechanisms].count("harmonic-force") <= 1


def test_its_mass_is_not_seen() -> None:
    problem = stages.prepare(recorded(), restoring="none").problem
    assert isinstance(problem, InverseDynamics)
    known = with_unseen_mass(problem)
    # a tenth of what the best law leaves, by far not of what the base does
    assert known.mass is not None
    assert MASS < known.mass < 10.0
    assert any("does not show the mass" in said for said in known.choices)
