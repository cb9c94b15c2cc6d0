"""What a fitted force leaves: noise where nothing is missing, graded where something is, each word counted once."""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.diagnosis.grading.contest import decided
from harness.diagnosis.inverse_dynamics.left_over import left_over
from harness.diagnosis.inverse_dynamics.search import ForceSearch, force_baseline, search_driven
from harness.diagnosis.inverse_dynamics.strokes import force_words, period_of
from harness.diagnosis.outcome import Grade, Outcome
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.inverse import InverseDynamics
from harness.diagnosis.problems.measured import BLOCK, Measured
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.structure import Left
from harness.diagnosis.rules import PERIODS_COUNTED
from harness.diagnosis.starts import Windows
from harness.fit.series import Memory, memory
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring

AXIS = Model(2.0, 3.0, 0.0, 1.5, restoring=Restoring.NONE)
SPRUNG = Model(2.0, 3.0, 80.0, 1.5)
WAVES = ((6.0, 3.1, 0.3), (4.0, 7.3, 1.1), (3.0, 14.0, 2.0))
TURNED = ModelTerm.named("asymmetric-viscous", c_diff=1.2)


def waves(t: FloatArray) -> FloatArray:
    return np.asarray(np.sum([a * np.sin(w * t + p) for a, w, p in WAVES], axis=0), dtype=np.float64)


def recorded(
    model: Model, n: int, sigma: float, of_force: float = 0.0, step: float = 0.0, unseen: float = 0.0
) -> Recording:
    """A model under waves of force, and an unseen one correlated over 0.16 s; noise of x (m) and of u (N)."""
    draw, t = np.random.default_rng(1), np.arange(n) / 250.0
    hidden = np.zeros(n)
    for i in range(1, n if unseen else 1):
        hidden[i] = 0.975 * hidden[i - 1] + 0.22 * unseen * draw.standard_normal()
    x = solve(model, t, drive=Drive(t, waves(t) + hidden)).x + sigma * draw.standard_normal(n)
    x = step * np.round(x / step) if step else x
    return Recording(t, {"x": x, "u": waves(t) + of_force * draw.standard_normal(n)})


def by_force(recording: Recording, restoring: Restoring = Restoring.NONE) -> InverseDynamics:
    """Its force fitted, whether or not the motion could be followed."""
    problem, _ = prepare(recording, Asked(restoring, horizon=1.0))
    if isinstance(problem, Driven):
        assert isinstance(problem.starts, Windows)
        return InverseDynamics.of(problem, problem.starts)
    assert isinstance(problem, InverseDynamics)
    return problem


SOUND: dict[str, tuple[Model, dict[str, float]]] = {
    "fine": (AXIS, {"sigma": 2e-6}),
    "coarse": (AXIS, {"sigma": 1e-4}),
    "spring": (SPRUNG, {"sigma": 2e-5}),
    "noisy force": (AXIS, {"sigma": 1e-5, "of_force": 0.02}),
    "encoder": (AXIS, {"sigma": 1e-9, "step": 2e-5}),
}


@pytest.mark.parametrize(("truth", "noise"), SOUND.values(), ids=SOUND)
def test_a_sound_model_leaves_no_more_than_noise(truth: Model, noise: Mapping[str, float]) -> None:
    problem = by_force(recorded(truth, 3000, **noise), truth.restoring)
    base, scales = force_baseline(problem)
    over = left_over(base, problem, scales, 0)
    assert over.left is Left.NOISE
    assert over.noise == pytest.approx(base.chi2 / base.residual.size, rel=0.5)


def test_beside_a_stand_friction_is_not_known() -> None:
    """A slider that is pushed to and fro with rests: what smoothing reaches into one says nothing of friction."""
    t = np.arange(3000) / 50.0
    legs, stiff = np.clip(np.mod(t, 6.0) / 2.5, 0.0, 1.0), 400.0
    eased = legs**3 * (10.0 - 15.0 * legs + 6.0 * legs**2)
    way = np.where(np.floor(t / 6.0) % 2 == 0, eased, 1.0 - eased)
    run = solve(Model(20.0, 3.0, stiff, 15.0), t, drive=Drive(t, stiff * way))
    read = run.x + 1e-6 * np.random.default_rng(1).standard_normal(t.size)
    problem = by_force(Recording(t, {"x": read, "u": stiff * (way - run.x)}))
    base, _ = force_baseline(problem)
    assert math.sqrt(base.chi2 / base.residual.size) < 15.0 / 30.0
    assert base.model.m == pytest.approx(20.0, rel=0.02)


def test_equal_readings_of_an_encoder_are_one_word() -> None:
    t = np.arange(2000) / 250.0
    read = 2e-3 * np.round(50.0 * np.sin(3.0 * t))
    problem, _ = prepare(Recording(t, {"x": read, "u": np.cos(3.0 * t)}), Asked(Restoring.NONE))
    weight = problem.weight["x"]
    first = np.flatnonzero(np.concatenate(([True], np.diff(read) != 0.0)))
    runs = [slice(i, j) for i, j in zip(first, [*first[1:], t.size], strict=True)]
    several = [run for run in runs if run.stop - run.start > 2]
    assert 0.1 < sum(run.stop - run.start for run in several) / t.size < 0.9
    assert all(np.all(weight[run] == 1.0) for run in runs if run not in several)
    for run in several:
        # of what passes by at most as much as the run, of a turn and at either end as one
        passes = run.start > 0 and run.stop < t.size and read[run.start - 1] != read[run.stop]
        worth = float(np.sum(weight[run] ** 2))
        assert 1.0 - 1e-9 <= worth <= (run.stop - run.start if passes else 1.0) + 1e-9
        # in its middle
        assert math.isclose(float(np.mean(np.flatnonzero(weight[run]))), 0.5 * (run.stop - run.start - 1))


@cache
def said(terms: tuple[ModelTerm, ...], unseen: float) -> Outcome:
    return diagnose(by_force(recorded(replace(AXIS, terms=terms), 3000, 1e-6, unseen=unseen)))


def test_adequate_only_where_nothing_but_noise_is_left() -> None:
    outcome = said((), 0.0)
    assert (outcome.verdict, outcome.mechanisms, outcome.remainder) == ("adequate", (), None)
    assert "over-simulated" in {rule.name for rule in outcome.rules}


def test_a_force_that_nobody_measured_is_no_law_and_not_adequate() -> None:
    outcome = said((), 0.5)
    assert outcome.verdict == "unexplained"
    assert all(m.grade is Grade.MINOR for m in outcome.mechanisms)
    assert outcome.remainder is not None
    assert outcome.remainder.over_noise > 2.0
    assert_chi2_says_what_is_left(outcome)
    # where nothing tells the noise chi-square is not said
    untold = replace(outcome, remainder=replace(outcome.remainder, over_noise=math.inf))
    assert untold.chi2_per_point(untold.refined) is None


def assert_chi2_says_what_is_left(outcome: Outcome) -> None:
    """In units of the noise: not 1 by construction where the level is taken from what is left."""
    assert outcome.remainder is not None
    base, refined = outcome.chi2_per_point(outcome.base), outcome.chi2_per_point(outcome.refined)
    assert base is not None
    assert refined is not None
    assert refined == pytest.approx(outcome.remainder.over_noise**2)
    assert (refined - 1.0) / (base - 1.0) == pytest.approx(outcome.remainder.share, rel=1e-6)


@pytest.fixture(scope="module")
def apart() -> ForceSearch:
    """One law among what nobody measured, as if its force had said enough for one name."""
    done = search_driven(by_force(recorded(replace(AXIS, terms=(TURNED,)), 3000, 1e-6, unseen=0.08)))
    assert done.graded is not None
    return replace(done, graded=replace(done.graded, counted=replace(done.graded.counted, words=40.0)))


def test_what_a_fitted_force_knows_of_a_name_is_what_a_motion_knows(apart: ForceSearch) -> None:
    """Alone among what nobody measured it keeps beside any other what it takes, and its numbers are tight."""
    found = apart.graded
    assert found is not None
    first = next(f for f in found.finalists if f.name == "asymmetric-viscous")
    assert 0.8 * first.share < first.company < 1.02 * first.share
    assert 0.0 < first.loosest < 0.1
    assert found.cycles == 20.0
    assert found.posterior[first.name] > 0.9
    assert (decided(found).grade, decided(found).named[0].name) == (Grade.MAIN, first.name)
    other = next(f for f in found.finalists if f.share < 0.05 and not f.clock)
    assert other.company < 0.05
    assert found.posterior.get(other.name, 0.0) < 0.01


def forced(t: FloatArray, u: FloatArray, v: FloatArray) -> tuple[Memory, Measured]:
    """A residual of white noise beside a force."""
    blocks = t.size // BLOCK
    measured = Measured(t, np.cumsum(v) * (t[1] - t[0]), v, np.gradient(v, t), u, np.ones(blocks, dtype=np.bool_))
    return memory(np.random.default_rng(1).standard_normal(blocks)), measured


@pytest.mark.parametrize("repeats", [4, 9])
def test_periods_after_the_third_say_nothing_new(repeats: int) -> None:
    t = np.arange(repeats * 2000) / 1000.0
    u = np.sin(np.pi * t) + 0.4 * np.sin(2.0 * np.pi * t + 1.0)
    left, measured = forced(t, u, np.cos(np.pi * t))
    assert period_of(measured) == pytest.approx(2.0, abs=0.011)
    words = force_words(left, measured)
    whole, first = words.pieces.count, np.unique(words.pieces.of[measured.blocks(t) < PERIODS_COUNTED.value * 2.0])
    assert whole > first.size
    assert words.words == min(first.size, 60)


def test_long_strokes_are_cut_and_no_piece_spans_a_reversal() -> None:
    t = np.arange(12_000) / 1000.0
    left, measured = forced(t, waves(t), np.cos(3.0 * t))
    pieces, direction = force_words(left, measured).pieces, np.sign(measured.blocks(measured.v))
    for piece in range(pieces.count):
        inside = pieces.of == piece
        assert np.unique(direction[inside]).size == 1
        assert np.count_nonzero(inside) >= 2.0 * left.time or np.ptp(np.flatnonzero(inside)) > 0
    assert pieces.count > np.count_nonzero(np.diff(direction))
