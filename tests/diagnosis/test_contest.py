"""How likely a name is the main effect: what it hangs on, what it comes to, and whence its weights."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.calibrate.posterior import Row, fitted, said
from harness.diagnosis.grading.contest import answered, softmax
from harness.diagnosis.outcome import Grade
from harness.diagnosis.rules import (
    FORCE_POSTERIOR,
    LISTED_FROM,
    MAIN_FROM,
    MOST_LIKELY,
    MOST_LISTED,
    OF_LIST,
    POSTERIOR,
    TIMES_NEXT,
    Weights,
)


@given(odds=st.lists(st.floats(-8.0, 8.0), max_size=9))
def test_what_probabilities_come_to(odds: list[float]) -> None:
    """A main effect is likely by itself and beside any other; a list most likely holds what there is, and no more."""
    p = softmax(odds).tolist()
    assert sum(p) == pytest.approx(1.0)
    names = [str(i) for i in range(len(odds))]
    likely = dict(zip(["", *names], p, strict=True))
    grade, told = answered(likely)
    ranked = sorted(names, key=lambda name: -likely[name])
    assert list(told) == ranked[: len(told)]
    if grade is Grade.MAIN:
        assert len(told) == 1
        assert likely[told[0]] >= (MAIN_FROM if len(names) > 1 else MOST_LIKELY).value
        assert all(likely[told[0]] >= TIMES_NEXT.value * likely[other] for other in ranked[1:])
    elif grade is Grade.ONE_OF:
        assert 2 <= len(told) <= MOST_LISTED.count
        held = sum(likely[name] for name in told)
        assert len(told) == min(MOST_LISTED.count, len(names)) or held >= OF_LIST.value * (1.0 - p[0]) - 1e-12
    else:
        assert 1.0 - p[0] < LISTED_FROM.value or len(names) == 1


@pytest.mark.parametrize("weights", [POSTERIOR, FORCE_POSTERIOR])
def test_what_makes_a_name_more_likely(weights: Weights) -> None:
    """What it takes off, and keeps beside others; tight numbers, most evidence, and nothing else that takes much."""
    more = {"share", "company", "behind"}
    for name, weight in weights.values.items():
        if name not in ("one", "cycles"):
            assert (weight > 0.0) is (name in more), name


def rows_of(weights: Weights, count: int, seed: int) -> list[Row]:
    """Recordings whose main effect, or none, is drawn by the weights."""
    rng, size = np.random.default_rng(seed), len(weights.values)
    found = []
    for _ in range(count):
        names = ("a", "b", "c")
        x = np.column_stack((np.ones(3), rng.standard_normal((3, size - 1))))
        p = softmax((x @ np.array(list(weights.values.values()))).tolist())
        right = rng.choice(4, p=p)
        group = "main" if right else "machine-control"
        found.append(Row(names, x, names[right - 1] if right else None, frozenset(), group, ()))
    return found


def test_weights_are_found_again_from_draws_that_follow_them() -> None:
    """Within .15 of 3,000 draws by known weights: four standard errors (1 / sqrt(3000 p (1 - p)) = .037 at half)."""
    truth = Weights("w", {"one": -1.0, "share": 2.0, "loose": -0.5, "alike": 0.0}, "", "")
    found = fitted(rows_of(truth, 3000, 8))
    assert found == pytest.approx(list(truth.values.values()), abs=0.15)


def test_a_calibration_prints_the_weights_that_stand() -> None:
    """Draws by the weights as they stand are calibrated; few draws say that they are too few."""
    weights = Weights("w", {"one": -2.0, "share": 4.0}, "", "")
    rows = rows_of(weights, 1500, 9)
    found = [round(float(one), 3) for one in fitted(rows)]
    same = Weights("w", dict(zip(weights.values, found, strict=True)), "", "")
    lines = list(said(same, None, rows))
    assert any("as they stand" in line for line in lines)
    (off,) = (float(line.split()[-1]) for line in lines if line.startswith("expected calibration error"))
    assert off < 0.03
    assert all("too few draws" in line for line in said(same, None, rows[:3]))
