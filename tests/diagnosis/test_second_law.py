"""On a bench a pair of laws may explain a recording; on a machine a second law is told beside a main effect alone."""

import numpy as np
import pytest

from harness.core.recording import Recording
from harness.diagnosis.grading.beginning import with_second
from harness.diagnosis.outcome import Grade
from harness.diagnosis.pipeline import explain, fit_base, judge, prepare, search
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.lack_of_fit import Left
from harness.diagnosis.rules import SECOND_TERM
from harness.diagnosis.stages import Found, Judged
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm, Restoring

SIGMA = 4e-5


def recorded(drag: float, bend: float, zero: float = 0.013) -> Recording:
    """A spring of 1.5 Hz, let go from .1 m; x at 200 Hz, noise 40 um."""
    terms = (ModelTerm.named("quadratic-drag", c2=drag), ModelTerm.named("quadratic-stiffness", k2=bend))
    t = np.arange(0.0, 9.0, 0.005)
    x = solve(Model(1.0, 0.1, 90.0, 0.03, x0=0.1, terms=terms), t).x
    return Recording(t, {"x": x + zero + SIGMA * np.random.default_rng(8).standard_normal(t.size)}, "two.csv")


def searched(recording: Recording, zero_free: bool) -> Found:
    return search(fit_base(prepare(recording, Asked(Restoring.SPRING, zero_free))[0]))


@pytest.fixture(scope="module")
def found() -> Found:
    """A drag that makes most of the misfit, a spring that is bent a little."""
    return searched(recorded(0.6, 12.0), zero_free=True)


@pytest.fixture(scope="module")
def main_and_small(found: Found) -> Judged:
    return judge(found)


def test_the_main_effect_comes_first_and_the_small_one_with_its_numbers(main_and_small: Judged) -> None:
    outcome = explain(main_and_small)
    assert outcome.verdict == "missing_physics"
    first, second = outcome.mechanisms
    assert (first.name, second.name) == ("quadratic-drag", "quadratic-stiffness")
    for one, name, true in ((first, "c2", 0.6), (second, "k2", 12.0)):
        value, error = one.parameters[name].value, one.parameters[name].stderr
        assert value is not None
        assert error is not None
        assert abs(value - true) < 4.0 * error < 0.2 * true
    assert first.share is not None
    assert second.share is not None
    assert first.share > 0.6 > second.share
    pair = main_and_small.found.search
    assert all(one is not None and one.bic > pair.chosen.bic + SECOND_TERM.value for one in pair.without)


def test_no_pair_is_looked_for_on_a_machine(found: Found, main_and_small: Judged) -> None:
    assert len(found.search.chosen.model.terms) == 1
    assert found.search.left is Left.STRUCTURE
    assert main_and_small.found.search.left is Left.NOISE


def test_a_second_law_that_another_follows_is_not_told() -> None:
    """Bent by 4 N/m^2: a zero that drifts leaves 1.33 times what it leaves; 20 words ask for exp(6/20) = 1.35."""
    told = judge(searched(recorded(0.6, 4.0), zero_free=True))
    assert told.judgement.verdict == "main_effect"
    assert [entry.term.name for entry in told.judgement.refined.model.terms] == ["quadratic-drag"]


def test_two_that_are_alike_are_a_crowd_on_a_machine() -> None:
    free = judge(searched(recorded(0.19, 12.0), zero_free=True))
    assert free.graded is not None
    assert free.graded.grade is not Grade.MAIN
    assert with_second(free.graded) is None
    assert free.judgement.verdict not in ("missing_physics", "main_effect")


@pytest.mark.full
def test_two_that_are_alike_are_a_pair_on_a_bench() -> None:
    known = judge(searched(recorded(0.19, 12.0, zero=0.0), zero_free=False))
    assert known.judgement.verdict == "missing_physics"
    names = {entry.term.name for entry in known.judgement.refined.model.terms}
    assert names == {"quadratic-drag", "quadratic-stiffness"}
