"""How likely a name is the main effect: what it hangs on, what it comes to, and whence its weights."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.calibrate.posterior import Row, fitted, said
from harness.core.arrays import FloatArray
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.grading.clocks import beat
from harness.diagnosis.grading.contest import (
    Contest,
    Finalist,
    answered,
    shown_as_part,
    softmax,
)
from harness.diagnosis.grading.likely import Chosen, of_steps, ranked, with_unseen
from harness.diagnosis.grading.prediction import Predicted
from harness.diagnosis.outcome import Grade
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import (
    FORCE_POSTERIOR,
    LISTED_FROM,
    MAIN_FROM,
    MOST_LIKELY,
    MOST_LISTED,
    OF_LIST,
    POSTERIOR,
    TIMES_NEXT,
    UNSEEN,
    Weights,
)
from harness.model.model import Model, ModelTerm


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Largest(Contest):
    """A contest that came to a largest part, of which nothing but its finalists is asked."""

    words: float = 10.0
    cycles: float = 20.0
    weights: Weights = POSTERIOR

    @property
    def refined(self) -> Fit:
        return self.finalists[0].fit


def missed(*squares: float) -> Predicted:
    return Predicted({"x": np.array(squares)}, np.ones(len(squares)), {"x": 1.0}, tuple((i, i + 1.0) for i in range(8)))


def largest(share: float, other: float, left: Sequence[float]) -> Grade | None:
    """What the largest part comes to by its share, another's, and what it misses of spans that the base misses by 1."""
    names = [ModelTerm.named("quadratic-drag", c2=1.0), ModelTerm.named("stribeck", f_s=2.0, v_s=0.1)]
    fits = [cast(Fit, SimpleNamespace(model=Model(1.0, 0.1, 10.0, 1.0, terms=(one,)))) for one in names]
    first = Finalist(fits[0], 100.0, share, False, held=missed(*left))
    found = Largest(
        finalists=(first, Finalist(fits[1], 50.0, other, False)),
        grade=Grade.MINOR,
        named=(first,),
        base_held=missed(*np.ones(len(left))),
    )
    return shown_as_part(found).grade


def test_a_law_that_stands_out_is_a_part_beside_an_unexplained_rest() -> None:
    better = [0.5] * 7 + [0.99]
    assert largest(0.6, 0.2, better) is Grade.PART
    assert largest(0.6, 0.4, better) is Grade.MINOR, "another law does as much"
    assert largest(0.6, 0.2, [0.1] * 7 + [1.01]) is Grade.MINOR, "a stretch is missed more"
    assert largest(0.1, 0.02, better) is Grade.MINOR, "little of the misfit"
    assert largest(0.6, 0.2, [0.5] * 3) is Grade.MINOR, "few stretches fall by chance"


@pytest.mark.parametrize(
    ("moved", "period"),
    [
        (lambda t: np.sin(2.0 * np.pi * t / 1.5), 1.5),
        # a stroke and back in 3 s, of which the half is a motion the other way
        (lambda t: np.sign(np.sin(2.0 * np.pi * t / 3.0)) * np.abs(np.sin(2.0 * np.pi * t / 1.5)), 3.0),
        # a chirp repeats nothing
        (lambda t: np.sin(2.0 * np.pi * (0.2 + 0.1 * t) * t), None),
    ],
    ids=["sine", "to and fro", "chirp"],
)
def test_a_driven_motion_has_a_clock_where_it_repeats_itself(
    moved: Callable[[FloatArray], FloatArray], period: float | None
) -> None:
    t = np.linspace(0.0, 30.0, 3001)
    base = cast(Fit, SimpleNamespace(shown=SimpleNamespace(v=moved(t))))
    problem = cast(Problem, SimpleNamespace(t=t, drive=object()))
    about = 2.0 * np.pi / (period or 1.0)
    expected = 0.0 if period is None else 2.0 * np.pi / period
    assert beat(base, problem, about) == pytest.approx(expected, rel=0.02)


def test_models_that_a_search_in_steps_fitted_are_as_likely_as_their_evidence() -> None:
    """Of ten names each counts a tenth, beside half its evidence in the exponent."""
    steps = [Chosen("stribeck", 30.0, {}), Chosen("backlash", 5.0, {"end-stop": 2.0})]
    others: dict[tuple[str, ...], float] = {("quadratic-drag",): 36.0, ("magnetic",): 60.0}
    found = of_steps(steps, 40.0, others, 10)
    pair = ("stribeck", "backlash")
    odds: dict[tuple[str, ...], tuple[float, int]] = {
        ("stribeck",): (-2.5, 1),
        ("backlash",): (-15.0, 1),
        ("stribeck", "end-stop"): (-1.0, 2),
        (): (-20.0, 0),
    }
    odds |= {("quadratic-drag",): (-2.0, 1)}
    for names, (half, count) in odds.items():
        assert found[names] / found[pair] == pytest.approx(np.exp(half) * 10.0 ** (2 - count))
    # what the search passed by with more evidence was refused, and is no likelier by that
    assert found["magnetic",] / found[pair] == pytest.approx(10.0)
    assert sum(found.values()) == pytest.approx(1.0)
    # however loud it was
    loud = of_steps([], 0.0, {("magnetic",): 9000.0}, 10)
    assert loud == pytest.approx({(): 10.0 / 11.0, ("magnetic",): 1.0 / 11.0})


def test_what_is_not_identified_takes_its_share_of_none_and_has_no_name() -> None:
    before = {(): 0.9, ("stribeck",): 0.08, ("backlash",): 0.015, ("end-stop",): 0.005}
    (none, first, *rest) = ranked(with_unseen(before))
    assert (none.names, first.names) == ((), ("stribeck",))
    assert none.probability / first.probability == pytest.approx(0.9 / 0.08)
    # of an end stop one in two hundred is not worth a word
    assert [one.names for one in rest] == [("backlash",)]
    left_open = 1.0 - sum(with_unseen(before).values())
    assert left_open == pytest.approx(UNSEEN.value * none.probability)
