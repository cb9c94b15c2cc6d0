"""Scores of a proof, the loss at which naming stops, and what a practitioner would do.

Baselines each find what they are made for in a balance of forces, and nothing in noise.
"""

import itertools
import math
import random
from collections.abc import Callable
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest

from benchmarks.beside import Balance, by_lasso, by_process, by_r2, by_regression, by_stlsq, table
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.proof.baselines.regression import BASE, States, name_by_r2, name_by_sindy, refusal, regressors, states_of
from harness.proof.baselines.sysid import holdout_by_sysid
from harness.proof.detection import LOSSES, clean_loss, curve, draw_series
from harness.proof.plant.base import Base
from harness.proof.plant.effects import ALIENS, BENCH, FAMILY, KINDS
from harness.proof.plant.hidden import build
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


def test_only_the_noise_grows_and_the_loss_falls_with_its_square() -> None:
    steps = draw_series("quadratic-drag", 4, losses=(1000.0, 10.0))
    first, second = (step.case for step in steps)
    assert first.base == second.base
    assert first.effects == second.effects
    for channel in first.channels:
        assert second.noise.sigma[channel] == pytest.approx(10.0 * first.noise.sigma[channel])
        unit = [(c.recorded[channel] - c.clean[channel]) / c.noise.sigma[channel] for c in (first, second)]
        assert unit[0] == pytest.approx(unit[1], abs=1e-6)
        assert np.array_equal(first.clean[channel], second.clean[channel])
    for step in steps:
        assert clean_loss(step.case) == pytest.approx(step.loss, rel=0.05)
        # one chance draw of the loss: its deviation is twice its root, and five numbers of the base are fitted to noise
        assert abs(step.case.base_chi2_excess - step.loss) < 8.0 * math.sqrt(step.loss) + 15.0
        assert step.price == pytest.approx(math.log(step.case.base.samples * len(step.case.channels)))


def test_a_series_is_repeatable_and_says_what_it_is() -> None:
    first, second = (draw_series("sensor-lag", 1, 3, losses=(100.0,))[0] for _ in range(2))
    answer = first.answer()
    assert answer == second.answer()
    assert (answer["series"], answer["loss"], answer["mechanisms"]) == (3, 100.0, ["sensor-lag"])


@pytest.mark.parametrize("kind", ["static-friction", "nonsense", "alien-rattle"])
def test_what_does_not_show_in_a_decay_has_no_curve(kind: str) -> None:
    with pytest.raises(InputError, match=f"kind: {kind}"):
        draw_series(kind, 0)


def _answers(limit: float, cases: int = 12) -> tuple[dict[str, Any], dict[str, Any]]:
    """Verdicts that name everything above a loss and nothing below."""
    answers, results = {}, {}
    for series in range(cases):
        for loss in LOSSES:
            file = f"{series}-{loss:g}"
            answers[file] = {"mechanisms": ["stribeck"], "series": series, "loss": loss, "price": 15.0}
            named = loss > limit
            results[file] = {"verdict": "missing_physics", "mechanisms": [{"name": "stribeck"}]} if named else {
                "verdict": "adequate"
            }  # fmt: skip
    return answers, results


def test_the_curve_crosses_a_half_between_the_losses_named_and_not_named() -> None:
    found = curve(*_answers(30.0))
    assert [level.named.value for level in found.levels] == [1.0, 1.0, 1.0, 1.0, 0.0, 0.0]
    assert [level.payable for level in found.levels] == [12, 12, 12, 12, 12, 0]
    assert found.half == pytest.approx(math.sqrt(80.0 * 16.0))
    assert found.low == found.high == pytest.approx(found.half)
    assert found.limit == 15.0


def test_chance_widens_the_interval_and_keeps_the_crossing_inside() -> None:
    answers, results = _answers(30.0)
    for series in range(4):
        results[f"{series}-80"] = {"verdict": "adequate"}
        results[f"{series + 6}-16"] = {"verdict": "missing_physics", "mechanisms": [{"name": "stribeck"}]}
    found = curve(answers, results)
    assert found.half is not None
    assert found.low is not None
    assert found.high is not None
    assert found.low < found.half < found.high
    assert found.low > 3.0
    assert found.high < 400.0


@pytest.mark.parametrize(("limit", "what"), [(1e9, "nothing"), (0.0, "everything")])
def test_without_a_crossing_there_is_no_half(limit: float, what: str) -> None:
    assert curve(*_answers(limit)).half is None, what


BASE_CASE = Base(1.0, 20.0, 0.015, 0.001, 0.1, 0.0, 0.1, 4.0, 1200)
NOISE = 2e-5


def recording(**effects: dict[str, float]) -> dict[str, FloatArray]:
    """A decay with little noise."""
    model, sensors = build(BASE_CASE, effects)
    clean = sensors.read(model, BASE_CASE.times)[1]
    x = clean["x"] + NOISE * np.random.default_rng(1).standard_normal(BASE_CASE.samples)
    return {"t": BASE_CASE.times, "x": x, "a": clean["a"]}


CUBIC = {"cubic-stiffness": {"k3": 4000.0}}
CONSTANT = {"constant-force": {"force": 1.5}}


def test_regressors_are_names_of_the_catalogue_and_the_base_explains_a_control() -> None:
    states = states_of(recording())
    assert isinstance(states, States)
    laws = regressors(states)
    assert set(laws) - set(BASE) <= set(FAMILY)
    base = np.column_stack([states.smoothed(laws[name]) for name in BASE])
    found = np.linalg.lstsq(base, states.a, rcond=None)[0]
    # smoothing over a tenth of a period takes a little off the second derivative
    assert found[0] == pytest.approx(-400.0, rel=0.01)
    assert found[1] == pytest.approx(-2.0 * 0.015 * 20.0, rel=0.1)
    assert found[2] == pytest.approx(-400.0 * 0.001, rel=0.1)


@pytest.mark.parametrize("effects", [CUBIC, CONSTANT])
def test_r2_names_a_strong_law_of_little_noise(effects: dict[str, dict[str, float]]) -> None:
    assert name_by_r2(recording(**effects)).names == tuple(effects)


@pytest.mark.parametrize("effects", [CUBIC, CONSTANT])
def test_sparse_regression_finds_a_strong_law_of_little_noise(effects: dict[str, dict[str, float]]) -> None:
    pytest.importorskip("pysindy")
    assert set(effects) <= set(name_by_sindy(recording(**effects)).names)


def test_sysid_recovers_a_control_and_predicts_it_to_the_noise() -> None:
    if not hasattr(pytest.importorskip("mujoco.sysid"), "optimize"):
        pytest.skip("mujoco[sysid] is not installed")
    period = 2.0 * np.pi / 20.0
    spans = [[i * period, (i + 1) * period] for i in range(1, 12, 2)]
    found = holdout_by_sysid(recording(), spans)
    assert found.applies
    assert found.parameters is not None
    assert found.parameters["stiffness"] == pytest.approx(400.0, rel=1e-3)
    assert found.parameters["damping"] == pytest.approx(0.6, rel=0.02)
    assert found.parameters["frictionloss"] == pytest.approx(0.4, rel=0.02)
    assert found.rmse["x"] < 10.0 * NOISE
    hidden = holdout_by_sysid(recording(**CUBIC), spans)
    assert hidden.rmse["x"] > 10.0 * found.rmse["x"]


@pytest.mark.parametrize("left_out", ["x", "u"])
def test_what_a_baseline_cannot_use_it_says(left_out: str) -> None:
    seen = recording()
    if left_out == "x":
        del seen["x"]
    else:
        seen["u"] = np.zeros(BASE_CASE.samples)
    said = refusal(seen)
    assert said == ("no position was recorded" if left_out == "x" else "a driven recording")
    for found in (name_by_r2(seen), holdout_by_sysid(seen, [[0.0, 1.0]])):
        assert not found.applies
        assert found.why == said


def _balance(cubic: float) -> Balance:
    """A mass on a spring with friction and a cubic law of such size, beside noise of a hundredth."""
    t = np.linspace(0.0, 20.0, 1200)
    x = np.sin(3.0 * t) + 0.4 * np.sin(5.1 * t)
    v = np.gradient(x, t)
    base = {"c": v, "f_k": np.sign(v), "m": np.gradient(v, t), "k": x}
    noise = 0.01 * np.random.default_rng(1).standard_normal(t.size)
    y = 0.3 * v + 0.5 * np.sign(v) + base["m"] + 9.0 * x + cubic * x**3 + noise
    laws = {"cubic-stiffness": x**3, "quadratic-drag": v * np.abs(v), "friction-drift": t * np.sign(v)}
    return Balance(y, base, laws, x, v, t, 120.0)


@pytest.mark.parametrize("namer", [by_r2, by_lasso, by_stlsq])
def test_a_law_is_named_and_noise_is_not(namer: Callable[[Balance], list[str]]) -> None:
    pytest.importorskip("pysindy")
    assert "cubic-stiffness" in namer(_balance(0.2))
    assert namer(_balance(0.0)) == []


def test_a_process_tells_noise_from_what_is_smooth() -> None:
    pytest.importorskip("sklearn")
    assert by_process(_balance(0.2))
    assert not by_process(_balance(0.0))


def test_plain_regression_has_the_friction_and_its_errors() -> None:
    found = by_regression(_balance(0.0))
    for name, true in (("c", 0.3), ("f_k", 0.5)):
        value, error = found[name]
        assert abs(value - true) < 4.0 * error


def test_a_margin_is_paired() -> None:
    said = [{("who", "what"): (1.0, 0.0)}, {("who", "what"): (0.0, 0.0)}, {}]
    (line,) = table(said).splitlines()[1:]
    assert line.split()[2:6] == ["2", "0.50", "0.00", "+0.50"]
