"""Two laws that bend the base model's numbers towards each other: both are named, and advice is theirs."""

import numpy as np
import pytest

import harness
from harness.model.model import Model, ModelTerm
from harness.results.diagnosis import DiagnosisResult

BASE = Model(1.0, 0.3, 150.0, 0.1, x0=0.05, mass_known=False)


def diagnosed(*terms: ModelTerm) -> DiagnosisResult:
    """A recording of position and acceleration, held against a simulation without these laws and too much damping."""
    t = np.arange(0.0, 5.0, 1.0 / 80.0)
    motion, random = harness.simulate(BASE.with_terms(*terms), t), np.random.default_rng(5)
    noisy = {c: y + s * random.standard_normal(t.size) for c, y, s in (("x", motion.x, 2e-5), ("a", motion.a, 0.05))}
    given = Model(1.0, 0.75, 150.0, 0.1, x0=0.05, mass_known=False)
    return harness.diagnose(harness.Recording(t, noisy, "made"), model=given, zero="spring", engines=())


@pytest.fixture(scope="module")
def both() -> DiagnosisResult:
    stribeck = ModelTerm.named("stribeck", f_s=0.18, v_s=0.04)
    return diagnosed(stribeck, ModelTerm.named("quadratic-drag", c2=2.0))


def test_both_of_two_laws_that_stand_in_for_each_other_are_named(both: DiagnosisResult) -> None:
    assert both.verdict == "missing_physics"
    assert {m.name: m.grade for m in both.mechanisms} == {"stribeck": "explains", "quadratic-drag": "explains"}
    (drag,) = (m.parameters["c2"] for m in both.mechanisms if m.name == "quadratic-drag")
    assert drag.value is not None
    assert drag.stderr is not None
    assert abs(drag.value - 2.0) < 4.0 * drag.stderr


def test_advice_is_to_add_both_and_to_give_the_damping_back(both: DiagnosisResult) -> None:
    assert both.attribution is not None
    to = {change.name: change.after for change in both.attribution.changes}
    assert to["stribeck"] == to["quadratic-drag"] == "present"
    assert to["c"] == pytest.approx(0.3, rel=0.1)
