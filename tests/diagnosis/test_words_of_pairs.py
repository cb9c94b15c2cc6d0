"""A pair that meets the noise needs evidence in words of the motion, as a graded term does."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.diagnosis.residual_tests.lack_of_fit import Left
from harness.diagnosis.search.search import Search
from harness.diagnosis.verdict import weighed
from harness.model.model import ModelTerm

DRAG = ModelTerm.named("quadratic-drag", c2=0.2)
OMEGA = 60.0


def search(
    terms: int, base: float, turns: int, left: Left = Left.NOISE, named: bool = True, bench: bool = True
) -> Search:
    """A search by hand: ``terms`` laws of two numbers each meet 1000 points, the base leaves chi-square ``base``."""
    t = np.arange(1000) * 1e-3

    def fit(chi2: float, count: int) -> Any:
        model = SimpleNamespace(terms=(DRAG,) * count)
        return SimpleNamespace(
            model=model, chi2=chi2, free=range(6 + 2 * count), shown=SimpleNamespace(v=t), explains_as_named=named
        )

    problem: Any = SimpleNamespace(
        t=t, duration=1.0, turns=lambda v: np.linspace(1, 998, turns).astype(np.int64), on_bench=bench
    )
    return Search(problem, fit(base, 0), fit(1000.0, terms), (), (), left)


def test_few_words_of_a_small_misfit_do_not_carry_a_pair() -> None:
    """9 words, chi-square 1.57 a point: 9 ln 1.57 - 4 ln 9 = -4.7; at 60, the most that count, 10.7."""
    assert weighed(search(2, 1570.0, 8), OMEGA).left is Left.STRUCTURE
    assert weighed(search(2, 1570.0, 99), OMEGA).left is Left.NOISE


@pytest.mark.parametrize("terms", [0, 1])
def test_a_lone_law_and_none_are_judged_by_samples_alone(terms: int) -> None:
    assert weighed(search(terms, 1100.0, 8), OMEGA).left is Left.NOISE


def test_a_large_misfit_carries_a_pair_in_few_cycles() -> None:
    """12 words, chi-square 50 a point: 12 ln 50 - 4 ln 12 = 37."""
    assert weighed(search(2, 50000.0, 11), OMEGA).left is Left.NOISE


@pytest.mark.parametrize(
    ("bench", "turns", "left"),
    [(True, 8, Left.NOISE), (False, 8, Left.STRUCTURE), (False, 11, Left.NOISE), (False, 99, Left.NOISE)],
)
def test_where_nobody_knows_the_zero_the_base_takes_its_words_first(bench: bool, turns: int, left: Left) -> None:
    """9 words less six, chi-square 50 a point: 3 ln 50 - 4 ln 3 = 7.3; of 12 words 6 ln 50 - 4 ln 6 = 16."""
    found = weighed(search(2, 50000.0, turns, bench=bench), OMEGA)
    assert found.left is left
    assert (found.doubted is None) is (left is Left.NOISE)


def force(rate: float) -> ModelTerm:
    """A harmonic force at so many rad/s."""
    return ModelTerm.named("harmonic-force", A=1.0, Omega=rate, phase=0.3)


# a second of recording: 3 pi rad/s is a period and a half of it
@pytest.mark.parametrize(
    ("terms", "left"),
    [
        ((force(OMEGA + 9.4),), Left.STRUCTURE),
        ((force(OMEGA + 9.5),), Left.NOISE),
        ((force(OMEGA - 9.4),), Left.STRUCTURE),
        ((force(9.4),), Left.STRUCTURE),
        ((force(9.5),), Left.NOISE),
        ((force(2.0 * OMEGA),), Left.NOISE),
        ((DRAG, force(OMEGA)), Left.STRUCTURE),
        ((force(150.0), force(159.3)), Left.STRUCTURE),
        ((force(150.0), force(159.5)), Left.NOISE),
        ((ModelTerm.named("normal-load-variation", depth=0.5, Omega=OMEGA, phase=0.3),), Left.NOISE),
    ],
)
def test_a_force_in_step_with_the_swing_or_with_another_explains_nothing(
    terms: tuple[ModelTerm, ...], left: Left
) -> None:
    found = search(len(terms), 50000.0, 99)
    found.chosen.model.terms = terms  # type: ignore[misc]
    assert weighed(found, OMEGA).left is left
