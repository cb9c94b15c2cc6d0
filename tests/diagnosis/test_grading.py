"""One large omission among small ones: graded by share, evidence in words, distance to every other, and prediction."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.explain.mechanism import of_misfit
from harness.diagnosis.explain.sentences import keeping_time
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.grading.beginning import after_first_turn, from_the_beginning
from harness.diagnosis.grading.contest import Finalist, decided, in_step
from harness.diagnosis.grading.grade import Graded, grade, resplit
from harness.diagnosis.grading.misfit import misfit
from harness.diagnosis.outcome import Grade
from harness.diagnosis.parameters import free_of
from harness.diagnosis.pipeline import fit_base, search
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.residual_tests.structure import UNNAMED
from harness.diagnosis.rules import BEGINS_ALIKE, GAIN, SAME_CLOCK, SHARE_OF_MISFIT
from harness.diagnosis.tables.unnamed import beside_curves
from harness.estimate.noise import Noise
from harness.kernels.solve import Scales, simulate
from harness.model.model import Model, ModelTerm
from harness.model.registry import not_parted, term

SIGMA = 1.4e-4
T = np.linspace(0.0, 8.0, 601)
DRAG = ModelTerm(term("quadratic-drag"), (0.25,))


def machine(*terms: ModelTerm) -> Model:
    """12 cycles of 9.4 rad/s."""
    return Model(m=1.0, c=0.15, k=88.4, f_k=0.3, x0=1.0, terms=terms)


def problem_of(x: FloatArray, t: FloatArray = T) -> FreeDecay:
    noise = SIGMA * np.random.default_rng(5).standard_normal(t.size)
    return FreeDecay(t, {"x": x + noise}, {"x": Noise(SIGMA, True)})


def crowd(model: Model, t: FloatArray = T) -> FloatArray:
    """What small effects of no catalogue add to a motion, 1 to 2 thousandths of its release."""
    run = simulate(model, t)
    return run.x + 1e-3 * np.sin(5.1 * t) * run.x + 1e-3 * run.x**2 * np.cos(1.3 * t)


@pytest.fixture(scope="module")
def graded() -> Graded:
    problem = problem_of(crowd(machine(DRAG)))
    return grade(misfit(problem, *baseline(problem)))


def test_drag_is_the_main_effect_among_small_ones(graded: Graded) -> None:
    assert graded.grade is Grade.MAIN
    (first,) = graded.named
    assert first.name == "quadratic-drag"
    assert first.fit.model.terms[0].value("c2") == pytest.approx(0.25, rel=0.1)
    assert 0.6 < first.share < 1.0


def test_a_main_effect_stands_beside_any_smooth_curve(graded: Graded) -> None:
    assert [f.name for f in beside_curves(graded).named] == ["quadratic-drag"]


@pytest.mark.parametrize(("errors", "known"), [(2.0, 2.0 / 3.0), (0.0, 0.0), (-1.0, 0.0)])
def test_what_lies_within_the_scatter_of_noise_is_hardly_known(graded: Graded, errors: float, known: float) -> None:
    """Squares of N values of white noise scatter by sqrt(2/N) of their sum."""
    seen = graded.misfit
    noise, samples = seen.noise_left(graded.named[0].fit), float(np.sum(seen.problem.weight["x"]))
    base = replace(seen.base, chi2=seen.floor(noise) * (1.0 + errors * math.sqrt(2.0 / samples)))
    assert replace(seen, base=base).known(noise) == pytest.approx(known)


def test_a_share_of_what_is_hardly_known_makes_no_name_sure(graded: Graded) -> None:
    unsure = replace(graded, known=0.3).chance
    assert graded.known > 0.95
    assert graded.chance is not None
    assert unsure is not None
    odds = [p / (1.0 - p) for p in (unsure, graded.chance)]
    # of all features that of the share alone: 3.69 is its weight
    assert odds[0] < odds[1] * (0.3 / graded.known) ** 3.0


def test_a_dent_in_a_spring_is_a_curve_of_no_name() -> None:
    """A push at one place of the way, half as strong as the spring there; of the catalogue a ripple says most of it."""

    def law(t: float, state: FloatArray) -> list[float]:
        x, v = state
        return [v, -40.0 * x - 0.12 * v - 2.0 * math.exp(-(((x - 0.1) / 0.1) ** 2))]

    problem = problem_of(solve_ivp(law, (0.0, T[-1]), (0.3, 0.0), rtol=1e-8, atol=1e-11, t_eval=T).y[0])
    alone = grade(misfit(problem, *baseline(problem)))
    assert alone.grade is Grade.MAIN
    beside = beside_curves(alone)
    assert beside.grade not in (Grade.MAIN, Grade.ONE_OF)
    assert next(iter(beside.posterior)) == UNNAMED
    assert sum(beside.posterior.values()) == pytest.approx(1.0)


def test_what_the_speed_does_besides_takes_no_name_from_a_spring() -> None:
    """A weak force of the speed that no catalogue holds is one of the crowd, though a curve of both follows both."""

    def law(t: float, state: FloatArray) -> list[float]:
        x, v = state
        return [v, -40.0 * x - 0.12 * v - 10.0 * x**2 - 0.15 * math.sin(3.0 * v)]

    problem = problem_of(solve_ivp(law, (0.0, T[-1]), (0.3, 0.0), rtol=1e-8, atol=1e-11, t_eval=T).y[0])
    beside = beside_curves(grade(misfit(problem, *baseline(problem))))
    (named,) = beside.named
    assert (beside.grade, named.name) == (Grade.MAIN, "quadratic-stiffness")
    assert named.fit.model.terms[0].value("k2") == pytest.approx(10.0, rel=0.05)


def test_a_law_bent_beyond_its_name_is_no_rival(graded: Graded) -> None:
    """Friction that rises with speed follows a drag, a drag below nought follows friction that falls."""
    rising = ModelTerm.named("stribeck", f_s=0.1, v_s=4.0)
    assert not machine(rising).as_named(1.0, 9.0)
    assert machine(ModelTerm.named("stribeck", f_s=0.5, v_s=4.0)).as_named(1.0, 9.0)
    problem, base = graded.misfit.problem, graded.misfit.base
    bent = replace(base.model, f_k=0.5, terms=(rising,))
    found = fit(bent, problem, free_of(bent, ("c", "k", "f_k", "x0")), graded.misfit.scales)
    assert not found.as_named
    assert base.chi2 - found.chi2 > SHARE_OF_MISFIT.value * base.chi2
    assert all(f.fit.as_named for f in graded.finalists)
    for key, values in {"quadratic-drag": {"c2": -0.1}, "power-law-damping": {"c_p": -0.1, "exponent": 0.5}}.items():
        with pytest.raises(InputError, match="0 to inf"):
            ModelTerm.named(key, **values)


@pytest.mark.parametrize("key", ["end-stop", "end-stop:positive", "end-stop:negative"])
def test_a_stop_that_acts_over_more_than_half_of_the_way_is_the_springs_shape(key: str) -> None:
    for gap, reach, named in ((0.5, 1.0, True), (0.49, 1.0, False), (0.5, 0.9, True), (0.49, 0.0, True)):
        assert machine(ModelTerm.named(key, gap=gap, k_stop=3.0)).as_named(reach, 9.0) is named
        # what leaves noise alone has shown its corner
        assert machine(ModelTerm.named(key, gap=gap, k_stop=3.0)).as_named(reach, 9.0, explains=True)


def test_friction_smoothed_over_more_than_half_of_all_speeds_is_a_dampers_shape() -> None:
    smoothed = machine(ModelTerm.named("regularised-friction", v_r=0.5, lead=0.0))
    assert smoothed.as_named(1.0, 1.0)
    assert not smoothed.as_named(1.0, 0.99)


def test_a_ripple_that_does_not_repeat_over_the_travel_is_the_springs_shape() -> None:
    """A period and a half at least, from -1 to 1; how far a driven path goes is not asked."""
    for period, reach, named in ((4.0 / 3.0, 1.0, True), (1.34, 1.0, False), (1.34, 0.0, True)):
        ripple = machine(ModelTerm.named("force-ripple", amplitude=0.1, period=period, phase=0.0))
        assert ripple.as_named(reach, 9.0) is named


def test_what_a_decay_cannot_part_is_given_beside_it(graded: Graded) -> None:
    """A drag and friction that grows with the load follow one decay alike, whatever their evidence."""
    assert not_parted("quadratic-drag", "load-dependent-friction")
    assert not not_parted("quadratic-drag", "cubic-stiffness")
    seen = graded.misfit
    main = of_misfit(graded.named[0], graded, seen.base, seen.problem)
    beside = {a.name for a in main.alternatives}
    worthy = [f.name for f in graded.finalists if f.share > 0.6 and f.gain > GAIN.value and f.name != main.name]
    assert {name for name in worthy if not_parted(main.name, name)} <= beside


def moved(graded: Graded, behind: float, **changed: object) -> Graded:
    """The grade with a second name like the first but so far behind it in evidence, and nobody else."""
    first = next(f for f in graded.finalists if f.name == "quadratic-drag")
    other = next(f for f in graded.finalists if f is not first and not f.clock)
    second: Finalist = replace(first, fit=other.fit, gain=first.gain - behind, **changed)  # type: ignore[arg-type]
    return decided(replace(graded, finalists=(first, second)))


def test_a_name_is_told_apart_by_its_evidence(graded: Graded) -> None:
    assert moved(graded, 4.0 * graded.words).grade is Grade.MAIN
    near = moved(graded, 0.0)
    assert near.grade is Grade.ONE_OF
    assert len(near.named) == 2
    # what is as loose as it is large is no name
    assert [f.name for f in moved(graded, 0.0, leading=1.0).standing] == ["quadratic-drag"]


def test_a_clock_on_the_swing_alone_is_nothing_and_it_is_said_why(graded: Graded) -> None:
    alone = decided(replace(graded, finalists=(replace(graded.finalists[0], clock=True),)))
    assert (alone.grade, alone.named) == (None, ())
    assert SAME_CLOCK in alone.rules
    (said,) = keeping_time(alone)
    share = f"{100.0 * alone.finalists[0].share:.0f} %"
    assert said.startswith(f"{alone.finalists[0].name} fits {share} of the misfit but is not reported: phase-locked")
    assert in_step(graded) is None
    assert keeping_time(graded) == ()


def test_a_law_that_stands_for_friction_is_found_without_it() -> None:
    """Damping with a power .58 of the speed, begun from a base model that took it for dry friction, at power .8."""
    law = term("power-law-damping")
    t = np.linspace(0.0, 30.0, 451)
    truth = Model(m=1.0, c=0.05, k=25.7, f_k=0.0, x0=1.0, terms=(ModelTerm(law, (0.46, 0.58)),))
    problem = problem_of(simulate(truth, t).x, t)
    base, scales = baseline(problem)
    begun = replace(base.model, terms=(ModelTerm(law, (0.0, 0.8)),))
    stuck = fit(begun, problem, free_of(begun, ("c", "k", "f_k", "x0", "v0")), scales, thorough=False)
    assert stuck.chi2 > 100.0 * stuck.points
    # all else of a search's list is the base itself
    found = resplit([stuck, base], problem, scales)[0]
    assert found.chi2 < 1.2 * found.points
    assert found.model.terms[0].value("exponent") == pytest.approx(0.58, abs=0.01)


@pytest.mark.parametrize("hold", [0.0, 0.3])
def test_the_beginning_takes_part_where_a_law_says_of_it_what_it_says_of_the_rest(hold: float) -> None:
    """A stop near the release acts at the largest swings alone, which come first; so does a hand that holds."""
    stop = ModelTerm.named("end-stop", gap=0.8, k_stop=30.0)
    free = crowd(replace(machine(stop), t0=hold), T[int(np.searchsorted(T, hold)) :])
    held = np.full(T.size - free.size, free[0])
    problem = replace(problem_of(np.concatenate((held, free))), zero_free=True)
    found = search(fit_base(problem))
    seen = misfit(found.search.problem, found.search.base, found.scales)
    assert seen.left_out == pytest.approx(hold + np.pi / 9.4, abs=0.05)
    later = Graded(misfit=seen)
    whole = from_the_beginning(found.search, later, found.scales)
    assert (whole is None) is (hold > 0.0)
    assert whole is None or ([f.name for f in whole.named] == ["end-stop"] and BEGINS_ALIKE in whole.rules)
    assert from_the_beginning(found.search, replace(later, grade=Grade.MAIN), found.scales) is None


def test_what_follows_a_hand_is_explained() -> None:
    """A hand moves the slider for half a second and lets go; from the first turning point on nothing is missing."""
    t = T[T >= 0.5]
    free = simulate(replace(machine(), t0=0.5), t).x
    pulled = 1.0 - 0.08 * (1.0 - T[T < 0.5] / 0.5) ** 2 + 0.01 * np.sin(40.0 * T[T < 0.5])
    problem = problem_of(np.concatenate((pulled, free)))
    seen = grade(misfit(problem, *baseline(problem)))
    later = after_first_turn(seen)
    assert later is not None
    search, scales, left_out = later
    assert isinstance(scales, Scales)
    assert search.explained
    assert search.chosen.model.terms == ()
    assert left_out == pytest.approx(0.5 + np.pi / 9.4, abs=0.05)
    assert search.chosen.model.f_k == pytest.approx(0.3, rel=0.05)
