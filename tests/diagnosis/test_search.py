"""What a law takes beside others, laws that keep time, a search with a budget, and one in means of samples."""

import math

import numpy as np
import pytest

import harness
from harness.core.arrays import FloatArray
from harness.core.budget import Budget, allowed, counted, spend
from harness.core.budget import given as within
from harness.core.cores import each
from harness.core.errors import SimulationError
from harness.diagnosis.grading.clocks import in_step, on_the_swing, unresolved
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import diagnose
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.search import long_recordings as long
from harness.estimate.noise import channel_noise
from harness.fit.series import standing_out
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm

SWING, SPAN = 5.0, 60.0


@pytest.mark.parametrize(
    ("omega_2", "zeta_2", "follows"),
    [
        (5.05, 0.001, True),  # on the swing
        (7.0, 0.5, True),  # its band reaches it
        (40.0, 1.0, True),  # damped as strongly as it swings: a delay
        (0.05, 0.01, True),  # slower than the recording shows
        (7.0, 0.02, False),
        (40.0, 0.3, False),
    ],
)
def test_a_resonator_that_the_swing_reaches_follows_anything(omega_2: float, zeta_2: float, follows: bool) -> None:
    mode = ModelTerm.named("attached-mode", omega_2=omega_2, mass_ratio=0.001, zeta_2=zeta_2)
    assert on_the_swing(mode, SWING, SPAN) is follows
    assert unresolved((mode,), SWING, SPAN) is follows


@pytest.mark.parametrize(("times", "follows"), [(1.0, True), (7.0, True), (31.0, True), (7.5, False), (0.5, False)])
def test_a_push_to_and_fro_keeps_time_and_place_together(times: float, follows: bool) -> None:
    period = 6.0
    hum = ModelTerm.named("harmonic-force", A=1.0, Omega=times * 2.0 * math.pi / period, phase=0.0)
    assert in_step(hum, period, 10.0 * period) is follows


@pytest.mark.parametrize("cycles", [1.75, 2.5, 4.4, 7.0, 12.0, 80.0])
def test_a_ripple_of_few_cycles_is_looked_for(cycles: float) -> None:
    x: FloatArray = 0.3 * np.sin(np.arange(6000.0) / 300.0)
    force = 0.2 * np.cos(2.0 * math.pi * x * cycles / 0.6 + 0.4) + 0.05 * np.random.default_rng(2).standard_normal(
        x.size
    )
    assert min(abs(0.6 / period - cycles) for period in standing_out(x, force, 1.5, 400.0)[:9]) < 0.5


def test_what_pieces_beside_one_another_may_do_does_not_hang_on_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    def work(size: int) -> int:
        done = 0
        try:
            for _ in range(size):
                allowed(1)
                spend(10)
                done += 10
        except SimulationError:
            pass
        return done

    found = {}
    for threads in ("1", "2"):
        monkeypatch.setenv("HARNESS_THREADS", threads)
        budget = Budget(1000.0)
        with within(budget), counted():
            found[threads] = (each(work, [1, 2, 90, 3, 90, 4, 5, 6]), each(work, [90, 1]), budget.spent, budget.ended)
    assert found["1"] == found["2"]
    assert found["1"][0] == [10, 20, 500, 30, 500, 40, 50, 60]
    assert found["1"][1] == [0, 0]
    assert found["1"][3]


def test_nothing_is_counted_where_no_search_is() -> None:
    budget = Budget(0.0)
    with within(budget):
        harness.simulate(Model(1.0, 0.3, 150.0, 0.1, x0=0.05), np.linspace(0.0, 1.0, 50))
    assert (budget.spent, budget.ended) == (0, False)


def test_a_search_that_its_budget_ended_gives_the_best_so_far_and_says_so() -> None:
    t = np.arange(0.0, 5.0, 1.0 / 80.0)
    drag = ModelTerm.named("quadratic-drag", c2=2.0)
    x = harness.simulate(Model(1.0, 0.3, 150.0, 0.1, x0=0.05, terms=(drag,), mass_known=False), t).x
    recording = harness.Recording(t, {"x": x + 2e-5 * np.random.default_rng(5).standard_normal(t.size)}, "made")
    found = harness.diagnose(recording, zero="spring", engines=(), budget=0.05)
    assert found.bounded
    assert "--budget" in found.warnings[0]
    assert found.settings["budget_s"] == 0.05


STEP, SAMPLES = 0.004, 3_000
CUBIC = ModelTerm.named("cubic-stiffness", k3=3.0)


def decay(terms: tuple[ModelTerm, ...]) -> Problem:
    t: FloatArray = STEP * np.arange(float(SAMPLES))
    run = solve(Model(1.0, 0.12, 40.0, 0.06, x0=1.0, terms=terms), t)
    draw = np.random.default_rng(4)
    channels: dict[str, FloatArray] = {
        "x": run.x + 2e-3 * draw.standard_normal(t.size),
        "a": run.a + 0.2 * draw.standard_normal(t.size),
    }
    return FreeDecay(t, channels, {c: channel_noise(t, y) for c, y in channels.items()})


def told(problem: Problem, monkeypatch: pytest.MonkeyPatch, samples: int) -> Outcome:
    monkeypatch.setattr(long, "LONG", samples)
    return diagnose(problem)


@pytest.mark.parametrize(
    "terms", [pytest.param((), id="nothing", marks=pytest.mark.full), pytest.param((CUBIC,), id="cubic-stiffness")]
)
def test_means_of_samples_tell_what_all_of_them_tell(
    terms: tuple[ModelTerm, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = decay(terms)
    whole, short = (told(problem, monkeypatch, samples) for samples in (SAMPLES, SAMPLES // 4))
    assert [m.name for m in short.mechanisms] == [m.name for m in whole.mechanisms] == [e.term.name for e in terms]
    assert short.verdict == whole.verdict
    assert short.problem.t.size == whole.problem.t.size == SAMPLES
    for name, quantity in whole.refined_parameters.items():
        assert quantity.stderr is not None
        assert short.refined_parameters[name].value == pytest.approx(quantity.value, abs=0.2 * quantity.stderr + 1e-12)
    for mine, theirs in zip(short.mechanisms, whole.mechanisms, strict=True):
        assert mine.delta_bic == pytest.approx(theirs.delta_bic, rel=0.05)
    for channel, level in {"x": 2e-3, "a": 0.2}.items():
        assert short.problem.noise[channel].sigma == pytest.approx(level, rel=0.03)
