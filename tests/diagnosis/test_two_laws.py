"""One law, two, and one in another form: what is named together, and what needs more."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import harness
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.explain.sentences import sentence_of
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.parameters import base_of, free_of
from harness.diagnosis.pipeline import diagnose, explain, fit_base, judge, prepare, search
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import OTHER_FORM, SECOND_TERM, UNSEEN
from harness.diagnosis.search.search import Search
from harness.diagnosis.stages import Found, Judged
from harness.diagnosis.tables.unnamed import beside_one_curve
from harness.diagnosis.verdict import weighed
from harness.estimate.noise import Noise
from harness.kernels.solve import Scales, solve
from harness.model.model import Model, ModelTerm, Restoring
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


AT = np.arange(0.0, 8.0, 0.01)
LAWS = (ModelTerm.named("stribeck", f_s=0.25, v_s=0.04), ModelTerm.named("quadratic-drag", c2=0.2))
RESISTED = Model(1.0, 0.1, 40.0, 0.1, x0=0.3, terms=LAWS)


def as_a_pair(x: FloatArray) -> tuple[Search, Scales]:
    """A decay of 1 Hz from .3 m, noise .1 mm, of which a Stribeck curve with a drag is said to leave noise."""
    noisy = {"x": x + 1e-4 * np.random.default_rng(4).standard_normal(AT.size)}
    problem = FreeDecay(AT, noisy, {"x": Noise(1e-4, True)})
    base, scales = baseline(problem)
    pair = fit(RESISTED, problem, free_of(RESISTED, base_of(base.free)), scales)
    return Search(problem, base, pair, (), (), Left.NOISE), scales


def test_two_laws_of_the_speed_are_no_names_for_a_curve_of_it() -> None:
    def law(t: float, state: FloatArray) -> list[float]:
        x, v = state
        return [v, -40.0 * x - 0.1 * v - 0.08 * math.tanh(v / 1e-3) - 0.06 * math.sin(4.0 * v)]

    waves, scales = as_a_pair(solve_ivp(law, (0.0, AT[-1]), (0.3, 0.0), rtol=1e-9, atol=1e-12, t_eval=AT).y[0])
    found = beside_one_curve(waves, scales)
    assert (found.left, found.doubted, found.doubted_by) == (Left.STRUCTURE, waves.chosen, "speed")


def test_two_laws_of_the_speed_are_named_where_no_smooth_curve_says_as_much() -> None:
    true, scales = as_a_pair(solve(RESISTED, AT).x)
    assert beside_one_curve(true, scales) is true


DRAG = ModelTerm.named("quadratic-drag", c2=0.2)
OMEGA = 60.0


def by_hand(
    terms: int, base: float, turns: int, left: Left = Left.NOISE, named: bool = True, bench: bool = True
) -> Search:
    """A search by hand: ``terms`` laws of two numbers each meet 1000 points, the base leaves chi-square ``base``."""
    t = np.arange(1000) * 1e-3

    def fit(chi2: float, count: int) -> Any:
        model = SimpleNamespace(terms=(DRAG,) * count)
        free = (SimpleNamespace(by="c"),) * (6 + 2 * count)
        return SimpleNamespace(
            model=model, chi2=chi2, free=free, shown=SimpleNamespace(v=t), explains_as_named=named,
            values=np.ones(len(free)), covariance=lambda: np.zeros((len(free), len(free))),
        )  # fmt: skip

    problem: Any = SimpleNamespace(
        t=t, duration=1.0, drive=None, turns=lambda v: np.linspace(1, 998, turns).astype(np.int64), on_bench=bench
    )
    return Search(problem, fit(base, 0), fit(1000.0, terms), (), (), left)


def test_few_words_of_a_small_misfit_do_not_carry_a_pair() -> None:
    """9 words, chi-square 1.57 a point: 9 ln 1.57 - 4 ln 9 = -4.7; at 60, the most that count, 10.7."""
    assert weighed(by_hand(2, 1570.0, 8), OMEGA).left is Left.STRUCTURE
    assert weighed(by_hand(2, 1570.0, 99), OMEGA).left is Left.NOISE


@pytest.mark.parametrize("terms", [0, 1])
def test_a_lone_law_and_none_are_judged_by_samples_alone(terms: int) -> None:
    assert weighed(by_hand(terms, 1100.0, 8), OMEGA).left is Left.NOISE


def test_a_large_misfit_carries_a_pair_in_few_cycles() -> None:
    """12 words, chi-square 50 a point: 12 ln 50 - 4 ln 12 = 37."""
    assert weighed(by_hand(2, 50000.0, 11), OMEGA).left is Left.NOISE


@pytest.mark.parametrize(
    ("bench", "turns", "left"),
    [(True, 8, Left.NOISE), (False, 8, Left.STRUCTURE), (False, 11, Left.NOISE), (False, 99, Left.NOISE)],
)
def test_where_nobody_knows_the_zero_the_base_takes_its_words_first(bench: bool, turns: int, left: Left) -> None:
    """9 words less six, chi-square 50 a point: 3 ln 50 - 4 ln 3 = 7.3; of 12 words 6 ln 50 - 4 ln 6 = 16."""
    found = weighed(by_hand(2, 50000.0, turns, bench=bench), OMEGA)
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
    found = by_hand(len(terms), 50000.0, 99)
    found.chosen.model.terms = terms  # type: ignore[misc]
    assert weighed(found, OMEGA).left is left


def dragged(seconds: float) -> Recording:
    """Quadratic drag on a spring of 1 Hz, let go from .1 m; x at 200 Hz, noise .6 mm, the encoder's zero .03 m off."""
    model = Model(1.0, 0.02, 40.0, 0.01, x0=0.1, terms=(ModelTerm.named("quadratic-drag", c2=1.5),))
    t = np.arange(0.0, seconds, 0.005)
    noise = np.random.default_rng(20261124).normal(0.0, 6e-4, t.size)
    return Recording(t=t, channels={"x": 0.03 + solve(model, t).x + noise}, file="drag.csv")


def test_few_cycles_with_an_unknown_zero_make_the_law_most_likely_and_name_the_recording_that_would_decide() -> None:
    asked = Asked(restoring=Restoring.SPRING, zero_free=True)
    short, long = (diagnose(prepare(dragged(seconds), asked)[0]) for seconds in (5.0, 14.0))
    assert (long.verdict, [m.name for m in long.mechanisms]) == ("missing_physics", ["quadratic-drag"])
    assert long.mechanisms[0].probability is not None
    # the rest belongs to a Stribeck curve of any shape
    assert long.mechanisms[0].probability > 0.8
    assert short.mechanisms[0].name == "quadratic-drag"
    assert short.refined.model.terms[0].term.name == "quadratic-drag"
    assert "to its noise" in sentence_of(short)
    assert any("cycles are too few to exclude every other term; a decay of 8 would do" in one for one in short.warnings)
    assert short.next_experiment
    # a lone name is no list, and each name has its probability, which with that of none adds up to one
    assert (short.verdict == "one_of") is (len(short.mechanisms) > 1)
    assert sum(h.probability for h in short.posterior) == pytest.approx(1.0, abs=0.05)
    # nothing was refused: it is another effect, the less likely the more the law explains
    other = {h.names: h.probability for h in short.posterior}[()]
    assert other / (1.0 - other) == pytest.approx(OTHER_FORM.value / math.sqrt(short.base.chi2 - short.refined.chi2))
    assert {h.names: h.probability for h in short.posterior}[("quadratic-drag",)] == short.mechanisms[0].probability


@pytest.mark.parametrize("zero_free", [False, True])
def test_that_nothing_is_missing_is_no_surer_than_what_cannot_be_seen_allows(zero_free: bool) -> None:
    model = Model(1.0, 0.3, 40.0, 0.05, x0=0.1)
    t = np.arange(0.0, 8.0, 0.01)
    noisy = solve(model, t).x + np.random.default_rng(7).normal(0.0, 2e-4, t.size)
    asked = Asked(restoring=Restoring.SPRING, zero_free=zero_free)
    found = diagnose(prepare(Recording(t=t, channels={"x": noisy}, file="plain.csv"), asked)[0])
    none = found.posterior[0]
    assert (found.verdict, none.names) == ("adequate", ())
    assert 0.5 < none.probability <= 1.0 / (1.0 + UNSEEN.value) + 1e-9
    assert f"No missing physics (P {none.probability:.2f}): " in sentence_of(found)


T = np.arange(0.0, 6.0, 0.02)
WIDTH = 0.1


def decay() -> harness.Recording:
    """x of a slider of 1 kg let go at 1 m, by Runge-Kutta at a fixed step; its friction has no jump."""
    fine, y = 20, np.array([1.0, 0.0])
    h = float(T[1]) / fine

    def rate(y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -100.0 * y[0] - y[1] - 3.0 * y[1] / math.hypot(y[1], WIDTH)])

    x = [1.0]
    for _ in T[1:]:
        for _ in range(fine):
            a = rate(y)
            b = rate(y + 0.5 * h * a)
            d = rate(y + 0.5 * h * b)
            y = y + h / 6.0 * (a + 2.0 * b + 2.0 * d + rate(y + h * d))
        x.append(float(y[0]))
    noise = np.random.default_rng(3).normal(0.0, 2e-5, T.size)
    return harness.Recording(t=T, channels={"x": np.array(x) + noise}, file="form.csv")


def test_friction_smoothed_otherwise_is_regularised_friction_with_its_width() -> None:
    result = harness.diagnose(decay(), restoring="spring", zero="spring", engines=())
    assert [m.name for m in result.mechanisms] == ["regularised-friction"]
    assert result.refined.chi2_per_point == pytest.approx(1.0, abs=0.25)
    found = result.mechanisms[0].parameters["v_r"]
    assert found.value == pytest.approx(WIDTH, rel=0.02)
    assert result.refined.parameters["x_k"].value == pytest.approx(0.03, rel=0.01)
    assert result.mechanisms[0].probability == pytest.approx(1.0, abs=0.01)
