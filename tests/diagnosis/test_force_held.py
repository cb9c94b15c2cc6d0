"""How a measured force acts between its samples is told beside the law that is left out, not by the base alone."""

import numpy as np
import pytest

from harness import stages
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.prepare.intersample_hold import ACTS_HELD, held
from harness.diagnosis.problems.driven import Driven
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring


def _pushed(is_held: bool) -> Recording:
    """A free axis under four sines, given every 8 ms, and a constant force that nobody measured."""
    t: FloatArray = np.arange(1500.0) * 8e-3
    random = np.random.default_rng(2)
    phases = random.uniform(0.0, 6.0, 4)
    sines = zip((1.2, 0.8, 0.6, 0.5), (2.0, 4.3, 7.1, 11.0), phases, strict=True)
    u: FloatArray = np.sum([size * np.sin(rate * t + phase) for size, rate, phase in sines], axis=0)
    drive = held(t, u) if is_held else Drive(t, u)
    terms = (ModelTerm.named("constant-force", force=0.06),)
    model = Model(m=1.0, c=1.6, k=0.0, f_k=0.1, restoring=Restoring.NONE, terms=terms)
    x = solve(model, t, drive=drive).x + 4e-4 * random.standard_normal(t.size)
    return Recording(t=t, channels={"x": x, "u": u})


@pytest.mark.parametrize("is_held", [False, True])
def test_a_force_that_is_left_out_does_not_decide_how_the_drive_acts(is_held: bool) -> None:
    problem = stages.prepare(_pushed(is_held), restoring="none").problem
    assert isinstance(problem, Driven)
    assert not problem.is_held, "the base model is misled: this is what the test is about"
    found = stages.search(stages.fit_base(problem))
    assert isinstance(found.search.problem, Driven)
    assert found.search.problem.is_held is is_held
    assert any(ACTS_HELD in note for note in found.notes) is is_held
    (law,) = found.search.chosen.model.terms
    assert found.search.explained
    assert law.term.name == "constant-force"
    assert law.values[0] == pytest.approx(0.06, abs=2e-3)


def test_the_other_way_and_back_is_the_same() -> None:
    problem = stages.prepare(_pushed(is_held=False), restoring="none").problem
    assert isinstance(problem, Driven)
    other = problem.the_other_way
    assert other is not None
    assert other.is_held
    assert other.drive.t[0] - problem.drive.t[0] == pytest.approx(4e-3)
    back = other.the_other_way
    assert back is not None
    assert back.drive is problem.drive
