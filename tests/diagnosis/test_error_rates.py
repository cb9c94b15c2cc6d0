"""How often the diagnosis is wrong, simulated: false alarms, chi-square, coverage; names of the independent plant."""

import functools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom, kstest

from benchmarks.controls import is_noise
from harness.core.recording import Recording
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import diagnose, fit_base, prepare
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.structure import structure
from harness.diagnosis.rules import STRUCTURE
from harness.diagnosis.starts import Windows
from harness.estimate.noise import channel_noise
from harness.model.model import Restoring
from harness.proof.plant.cases import Case, control, draw

_CHANCE = 1e-3
"""Probability with which a sound diagnosis may fail one of these tests."""
_NOISES = ("white", "coloured", "quantised")
DRAWS = 3
"""Draws of the base fit alone."""
THIN = 2
"""Of those draws one sample in so many is kept: what is stated holds at any rate."""
SIZES = (3, pytest.param(500, marks=pytest.mark.full))


@functools.cache
def _controls(count: int) -> tuple[tuple[Case, Outcome], ...]:
    cases = [control(np.random.default_rng([77, i]), noise=_NOISES[i % 3]) for i in range(count)]
    return tuple((case, diagnose(_problem(case))) for case in cases)


def _problem(case: Case) -> Problem:
    channels = {c: case.recorded[c] for c in case.channels}
    t = case.recorded["t"]
    return FreeDecay(t, channels, {c: channel_noise(t, y) for c, y in channels.items()})


def false_alarms_are_at_most_one_in_fifty(count: int) -> None:
    alarms = sum(outcome.verdict != "adequate" for _, outcome in _controls(count))
    assert alarms <= binom.ppf(1.0 - _CHANCE, count, 0.02)


def chi_square_of_the_base_fit_is_one_a_point(count: int) -> None:
    # of the noise that the plant put in, not of the noise that was estimated
    far = 0
    for case, outcome in _controls(count):
        noise = case.noise
        for channel, y in outcome.problem.channels.items():
            left = y - outcome.base.shown.y[channel]
            ratio = float(np.sqrt(np.mean(left**2))) / noise.total(channel)
            far += not is_noise(ratio, left.size, noise.correlation)
    assert far <= binom.ppf(1.0 - _CHANCE, 2 * count, 0.01)


def two_standard_errors_hold_the_slider(count: int) -> None:
    held, asked = 0, 0
    for case, outcome in _controls(count):
        true = {"omega_n": case.base.omega_n, "zeta": case.base.zeta, "x_k": case.base.x_k}
        for name, value in true.items():
            said = outcome.base_parameters[name]
            if said.value is None or said.stderr is None:
                continue
            asked += 1
            held += abs(said.value - value) <= 2.0 * said.stderr
    # three numbers of one fit are not independent: the spread is allowed for as if there were one a recording
    shortfall = binom.ppf(_CHANCE, count, 0.9545) / count
    assert asked >= 2.7 * count
    assert held / asked >= shortfall


@pytest.mark.slow
@pytest.mark.parametrize("count", SIZES)
def test_random_controls(count: int) -> None:
    # one test, since what takes long is the diagnoses that the three look at
    false_alarms_are_at_most_one_in_fifty(count)
    chi_square_of_the_base_fit_is_one_a_point(count)
    two_standard_errors_hold_the_slider(count)


def _with_noisy_force(i: int) -> tuple[Problem, tuple[str, ...]]:
    """A control driven by a force that is recorded with white noise of 0.03 to 1 % of its scatter."""
    random = np.random.default_rng([78, i])
    setting = ("driven", "axis")[i % 2]
    case = control(random, setting=setting)
    values = {c: y for c, y in case.recorded.items() if c != "t"}
    share = 10.0 ** random.uniform(-3.5, -2.0)
    values["u"] = values["u"] + share * np.std(values["u"]) * random.standard_normal(values["u"].size)
    restoring = Restoring.NONE if setting == "axis" else Restoring.SPRING
    thin = {c: y[::THIN] for c, y in values.items()}
    return prepare(Recording(case.recorded["t"][::THIN], thin), Asked(restoring))


def structure_left(problem: Problem) -> float:
    """Probability with which noise alone leaves as much structure in the base fit, before any name is tried."""
    based = fit_base(problem)
    return structure(based.fit, based.problem, based.scales.omega).p_value


def nothing_is_found_where_nothing_is(problems: Sequence[Problem]) -> None:
    """Cheap enough for many draws: a diagnosis of each takes ten times as long, and one alone cannot fail."""
    left = [structure_left(problem) for problem in problems]
    assert sum(p <= STRUCTURE.value for p in left) <= binom.ppf(1.0 - _CHANCE, len(left), STRUCTURE.value)
    # they may be larger than chance has them, since what the fit takes is allowed for with a margin; never smaller
    assert kstest(left, "uniform", alternative="greater").pvalue > _CHANCE


@pytest.mark.slow
def test_noise_of_a_force_leaves_no_structure() -> None:
    nothing_is_found_where_nothing_is([_with_noisy_force(i)[0] for i in range(DRAWS)])


def _with_gaps(i: int) -> Problem:
    """A driven control of which three stretches of up to a thirtieth are missing."""
    random = np.random.default_rng([79, i])
    setting = ("axis", "driven")[i % 2]
    case = control(random, setting=setting)
    t = case.recorded["t"]
    keep = np.ones(t.size, dtype=bool)
    for _ in range(3):
        begin = int(random.integers(1, t.size - 40))
        keep[begin : min(begin + int(random.integers(8, max(9, t.size // 30))), t.size - 1)] = False
    values = {c: y[keep] for c, y in case.recorded.items() if c != "t"}
    restoring = Restoring.NONE if setting == "axis" else Restoring.SPRING
    thin = {c: y[::THIN] for c, y in values.items()}
    return prepare(Recording(t[keep][::THIN], thin), Asked(restoring))[0]


@pytest.mark.slow
def test_gaps_leave_no_structure() -> None:
    problems = [_with_gaps(i) for i in range(DRAWS)]
    assert all(isinstance(p.starts, Windows) for p in problems)
    nothing_is_found_where_nothing_is(problems)


def test_structure_that_is_there_is_found() -> None:
    """The statistic above can fail: eight standard deviations of a vibration that no base model has."""
    problem = _with_gaps(0)
    shaken = {c: y + 8.0 * problem.noise[c].sigma * np.sin(9.0 * problem.t) for c, y in problem.channels.items()}
    assert structure_left(replace(problem, channels=shaken)) < 1e-6


SHORT = ("quadratic-drag",)
LONG = (
    "sensor-lag", "asymmetric-viscous", "cubic-stiffness", "sensor-gain", "stribeck", "presliding", "friction-drift",
    "end-stop", "impulse",
)  # fmt: skip


@functools.cache
def _case(kind: str, seed: int) -> Case:
    return draw(kind, np.random.default_rng(seed))


@functools.cache
def _outcome(kind: str, seed: int) -> Outcome:
    return diagnose(_problem(_case(kind, seed)))


def _named(outcome: Outcome) -> set[str]:
    return {m.name for m in outcome.mechanisms}


@pytest.mark.parametrize("kind", [*SHORT, *(pytest.param(kind, marks=pytest.mark.full) for kind in LONG)])
def test_the_hidden_effect_is_named(kind: str) -> None:
    outcome = _outcome(kind, 11)
    assert outcome.verdict == "missing_physics"
    near = _named(outcome) | {a.name for m in outcome.mechanisms for a in m.alternatives}
    assert kind in near
    assert outcome.refined.chi2 < outcome.base.chi2
    for channel, after in outcome.holdout.refined_rmse.items():
        assert after <= 1.05 * outcome.holdout.baseline_rmse[channel]


def test_units_do_not_matter() -> None:
    """A recording in other units of length names the same effect: every law scales."""
    problem = _problem(_case("quadratic-drag", 11))
    scaled = replace(
        problem,
        channels={c: 1000.0 * y for c, y in problem.channels.items()},
        noise={c: replace(n, sigma=1000.0 * n.sigma) for c, n in problem.noise.items()},
    )
    assert _named(diagnose(scaled)) == _named(_outcome("quadratic-drag", 11))
