"""Scores: exact intervals, a perfect diagnosis passes, four that should not pass are condemned."""

import itertools
import math
import random
from collections.abc import Callable
from statistics import NormalDist
from typing import Any

import pytest

from harness.proof.plant.effects import ALIENS, BENCH, FAMILY, KINDS
from harness.proof.score import Scores, score
from harness.proof.statistics import Median, Rate

Result = dict[str, Any]
ERRORS = itertools.cycle([NormalDist().inv_cdf((i + 0.5) / 40) for i in range(40)])
"""Normal errors without chance: two in forty are beyond two standard errors."""


def truth_of(names: tuple[str, ...], r2: float) -> dict[str, Any]:
    families = [f for n in names for f in (ALIENS[n] if n in ALIENS else (FAMILY[n],))]
    return {
        "mechanisms": list(names),
        "families": families,
        "channels": "xa",
        "headline": {n: dict.fromkeys(BENCH[n].headline, 2.0) for n in names if n in FAMILY},
        "region": [[1.0, 2.0]] if "impulse" in names else None,
        "duration": 10.0,
        "base_r2": [r2, r2],
    }


def truths() -> dict[str, dict[str, Any]]:
    hidden: list[tuple[str, ...]] = [(k,) for k in KINDS for _ in range(4)] + [()] * 60
    hidden += [(a,) for a in ALIENS for _ in range(2)] + [("stribeck", "impulse"), ("cubic-stiffness", "sensor-gain")]
    rng = random.Random(1)
    return {f"{i:03d}.csv": truth_of(names, rng.uniform(0.981, 0.9999)) for i, names in enumerate(hidden)}


def finding(names: list[str], rng: random.Random) -> Result:
    """A result with everything a result can have to its credit."""
    better = {"baseline_rmse": {"x": 1.0, "a": 1.0}, "refined_rmse": {"x": 0.2, "a": 0.2}}
    return {
        "verdict": "missing_physics" if names else "adequate",
        "mechanisms": [
            {
                "name": n,
                "parameters": {p: {"value": 2.0 + 0.1 * next(ERRORS), "stderr": 0.1} for p in BENCH[n].headline},
                "where": {"time_s": [[1.0, 2.0]]},
                "alternatives": [],
            }
            for n in names
        ],
        "holdout": better,
        "engines": {"mujoco": better, "pybullet": better},
    }


def answered(by: Callable[[dict[str, Any], random.Random], Result]) -> Scores:
    known, rng = truths(), random.Random(2)
    return score(known, {file: by(truth, rng) for file, truth in known.items()})


def shortfalls(scores: Scores) -> list[str]:
    return [figure.sentence for figure in scores.figures if figure.met is False]


def knowing(truth: dict[str, Any], rng: random.Random) -> Result:
    if any(n in ALIENS for n in truth["mechanisms"]):
        return {"verdict": "unexplained", "mechanisms": []}
    return finding(truth["mechanisms"], rng)


def at_random(truth: dict[str, Any], rng: random.Random) -> Result:
    return finding(rng.choice([[], [rng.choice(KINDS)]]), rng)


def always_stribeck(truth: dict[str, Any], rng: random.Random) -> Result:
    return finding(["stribeck"], rng)


def lists_everything(truth: dict[str, Any], rng: random.Random) -> Result:
    return finding(list(KINDS), rng)


def by_r2_alone(truth: dict[str, Any], rng: random.Random) -> Result:
    # a fit above 0.99 is called adequate, one below it gets the most usual suspect
    return finding([] if min(truth["base_r2"]) > 0.99 else ["stribeck"], rng)


def test_a_diagnosis_that_knows_passes() -> None:
    scores = answered(knowing)
    assert shortfalls(scores) == []
    assert scores.found["named"].value == 1.0
    assert scores.confusion["stribeck"] == {"stribeck": 4}
    assert scores.confusion["nothing"] == {"nothing": 60}
    assert scores.found["overlap"].value == 1.0
    assert scores.not_tested == ()


@pytest.mark.parametrize("diagnosis", [at_random, always_stribeck, lists_everything, by_r2_alone])
def test_diagnoses_that_must_fail_are_condemned(diagnosis: Callable[[dict[str, Any], random.Random], Result]) -> None:
    scores = answered(diagnosis)
    assert any(line.startswith("single effects named") for line in shortfalls(scores))
    assert scores.found["named"].high is not None
    assert scores.found["named"].high < 0.5
    assert len(shortfalls(scores)) >= 2


def test_what_is_withheld_counts_against() -> None:
    scores = score(truths(), {})
    assert scores.found["named"].value == 0.0
    assert scores.found["false_alarms"].value == 1.0
    assert scores.found["misled"].value == 1.0
    assert scores.found["wrong_family"].value == 0.0
    assert scores.found["holdout"].value == math.inf
    assert scores.found["holdout"].as_dict()["value"] is None


@pytest.mark.parametrize(
    ("hits", "cases", "low", "high"),
    # exact binomial intervals: zero of n gives 1 - 0.025^(1/n), all of n its mirror image
    [(0, 10, 0.0, 1.0 - 0.025**0.1), (10, 10, 0.025**0.1, 1.0), (0, 300, 0.0, 1.0 - 0.025 ** (1.0 / 300.0))],
)
def test_exact_intervals(hits: int, cases: int, low: float, high: float) -> None:
    rate = Rate.of([True] * hits + [False] * (cases - hits))
    assert rate.low == pytest.approx(low, abs=1e-12)
    assert rate.high == pytest.approx(high, abs=1e-12)


def test_rate_and_median_without_cases_say_so() -> None:
    assert Rate.of([]).value is None
    assert Median.of([]).value is None
    known = Median.of([1.0, 2.0, 3.0, 4.0, 100.0])
    assert known.value == 3.0
    assert known.low is not None
    assert known.low <= 3.0
