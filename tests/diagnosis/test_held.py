"""What holds a driven slider, where its zero is, and whether anything swings."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import harness
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.pipeline import prepare, prepare_together
from harness.diagnosis.prepare.held import held_driven
from harness.diagnosis.problems.driven import Forced
from harness.diagnosis.request import Asked, AskedCovariate
from harness.diagnosis.rules import LARGE_ANGLE, ZERO_REACH
from harness.kernels.solve import Drive, Solution, simulate, solve
from harness.model.model import Model, Restoring

T: FloatArray = np.arange(4000.0) / 200.0
U: FloatArray = 3.0 * np.sin(2.9 * T) + 2.0 * np.sin(4.7 * T + 1.0)
SPRING = Model(m=1.0, c=1.2, k=20.0, f_k=0.4)
ARM = Model(m=1.0, c=0.6, k=9.0, f_k=0.2, restoring=Restoring.PENDULUM)


def moved(model: Model = SPRING) -> Solution:
    return solve(model, T, drive=Drive(T, 2.0 * U if model is ARM else U))


def chosen(
    x: FloatArray, run: Solution, asked: Asked | None = None, angular: bool = False, push: float | FloatArray = 0.0
) -> Asked:
    u = (2.0 * U if angular else U) + push
    noise = 0.01 * np.random.default_rng(3).standard_normal(T.size)
    return held_driven(asked or Asked(), (x, run.v, run.a), u + noise, angular)[0]


def test_what_rests_at_nought_is_measured_from_its_rest() -> None:
    run = moved()
    assert chosen(run.x, run) == Asked(Restoring.SPRING, zero_free=False)


@given(st.floats(0.3, 0.8 * ZERO_REACH.value), st.sampled_from([-1.0, 1.0]))
def test_a_zero_within_reach_is_free(share: float, side: float) -> None:
    run = moved()
    zero = side * share * 0.5 * float(np.ptp(run.x))
    assert chosen(run.x + zero, run) == Asked(Restoring.SPRING, zero_free=True)


def test_what_is_beyond_reach_is_a_push() -> None:
    run = moved()
    push = 3.0 * ZERO_REACH.value * SPRING.k * 0.5 * float(np.ptp(run.x))
    assert chosen(run.x, run, push=push) == Asked(Restoring.SPRING, zero_free=False)


def test_a_slider_that_nothing_pulls_back_is_held_by_nothing() -> None:
    run = moved(Model(m=1.0, c=1.2, k=0.0, f_k=0.4, restoring=Restoring.NONE))
    assert chosen(run.x, run).restoring is Restoring.NONE
    # beside a cogging of a tenth of the force too
    assert chosen(run.x, run, push=0.3 * np.cos(40.0 * run.x)).restoring is Restoring.NONE


@pytest.mark.parametrize("zero", [0.0, -2.5])
def test_a_large_swing_is_a_pendulum_wherever_it_is_measured_from(zero: float) -> None:
    run = moved(ARM)
    assert float(np.ptp(run.x)) > 1.5
    assert chosen(run.x + zero, run, angular=True) == Asked(Restoring.PENDULUM, zero_free=True)
    recorded = Recording(T, {"x": run.x + zero + 1e-5 * np.random.default_rng(4).standard_normal(T.size), "u": 2.0 * U})
    problem, notes = prepare(Recording(T, recorded.channels, angular=True), Asked())
    assert isinstance(problem, Forced)
    assert problem.restoring is Restoring.PENDULUM
    assert any(note.startswith("fitted a pendulum with a zero offset") for note in notes)
    assert problem.first.offset == pytest.approx(zero, abs=0.02)
    assert problem.first.k == pytest.approx(ARM.k, rel=0.02)


def test_a_small_swing_is_a_pendulum_where_its_motion_says_so() -> None:
    """An encoder's scatter hides from a force of smoothed accelerations what the motion itself shows."""
    run = solve(ARM, T, drive=Drive(T, 0.2 * U))
    assert float(np.ptp(run.x)) < 2.0 * LARGE_ANGLE.value
    seen = run.x + 2e-4 * np.random.default_rng(4).standard_normal(T.size)
    for angular, held in ((True, Restoring.PENDULUM), (False, Restoring.SPRING)):
        problem, notes = prepare(Recording(T, {"x": seen, "u": 0.2 * U}, angular=angular), Asked())
        assert isinstance(problem, Forced)
        assert problem.restoring is held
        assert any("pendulum" in note for note in notes) is angular


@pytest.mark.parametrize(
    "asked",
    [
        Asked(zero_free=False),
        Asked(Restoring.NONE),
        Asked(Restoring.PENDULUM),
        Asked(guarded=True),
        Asked(covariates=(AskedCovariate("P"),)),
    ],
)
def test_what_was_asked_rules(asked: Asked) -> None:
    run = moved()
    assert chosen(run.x + 0.3, run, asked) == asked


NINE_CYCLES = np.linspace(0.0, 4.0, 900)


def decay(zero: float = 0.0, x0: float = 0.1) -> Recording:
    """About nine cycles, read from so far beside the rest."""
    noise = 1e-5 * np.random.default_rng(7).standard_normal(NINE_CYCLES.size)
    return Recording(
        NINE_CYCLES, {"x": simulate(Model(m=1.0, c=0.2, k=200.0, f_k=0.1, x0=x0), NINE_CYCLES).x + zero + noise}
    )


@pytest.mark.parametrize(
    ("zero", "told", "free", "bench"),
    [
        (0.0, None, False, False),
        (0.0, False, False, True),
        (0.0, True, True, False),
        (0.01, None, True, False),
        (0.01, False, False, True),
    ],
)
def test_a_zero_is_of_a_bench_only_where_it_is_told(zero: float, told: bool | None, free: bool, bench: bool) -> None:
    problem, _ = prepare(decay(zero), Asked(Restoring.SPRING, told))
    assert (problem.zero_free, problem.on_bench) == (free, bench)


@pytest.mark.parametrize(("told", "bench"), [(None, False), (False, True)])
def test_recordings_together_and_each_of_them_know_what_was_told(told: bool | None, bench: bool) -> None:
    # the second swings further, so that the zero is chosen at it and taken over by the first
    both, _ = prepare_together([decay(), decay(x0=0.15)], Asked(Restoring.SPRING, told))
    assert not both.zero_free
    assert [both.on_bench, *(one.on_bench for one in both.alone)] == [bench] * 3


SAMPLES = 400
FOUR_S = np.arange(SAMPLES) / 100.0


def bench(kind: str, random: np.random.Generator) -> np.ndarray:
    """A slider at rest as a sensor shows it, 1 mm rms."""
    white = 1e-3 * random.standard_normal(SAMPLES)
    if kind == "coloured":
        for i in range(1, SAMPLES):
            white[i] += 0.8 * white[i - 1]
    if kind == "wandering":
        white = white + np.cumsum(3e-4 * random.standard_normal(SAMPLES))
    if kind == "moved once":
        white = white + np.where(FOUR_S < 1.7, 0.0, 0.02)
    return 0.1 + white


@pytest.mark.parametrize("kind", ["white", "coloured", "wandering", "moved once"])
def test_noise_about_a_level_is_no_swing(kind: str) -> None:
    x = bench(kind, np.random.default_rng(0))
    with pytest.raises(InputError, match=r"at-rest|not-mechanical"):
        harness.diagnose(harness.Recording(FOUR_S, {"x": x}, "bench"), engines=())


def test_a_swing_under_noise_as_large_is_a_motion() -> None:
    t = np.arange(3000) / 100.0
    x = np.exp(-0.05 * t) * np.cos(9.0 * t) + 0.5 * np.random.default_rng(1).standard_normal(t.size)
    assert harness.diagnose(harness.Recording(t, {"x": x}), engines=()).verdict == "adequate"
