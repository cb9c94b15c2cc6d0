"""How often the diagnosis is wrong, simulated: false alarms, chi-square and coverage on random recordings.

Short here; a few hundred with -m full. A rate is judged by what chance allows at the size at hand.
"""

import functools

import numpy as np
import pytest
from scipy.stats import binom

from harness.core.recording import Recording
from harness.diagnosis.asked import Asked
from harness.diagnosis.conclude import diagnose
from harness.diagnosis.outcome import Outcome
from harness.diagnosis.prepare import prepare
from harness.diagnosis.problem import Problem
from harness.estimate.noise import channel_noise
from harness.model.model import Restoring
from harness.proof.plant import Case, draw
from harness.proof.statistics import is_noise

_CHANCE = 1e-3
"""Probability with which a sound diagnosis may fail one of these tests."""
_NOISES = ("white", "coloured", "quantised")
SIZES = (12, pytest.param(500, marks=pytest.mark.full))


@functools.cache
def _controls(count: int) -> tuple[tuple[Case, Outcome], ...]:
    cases = [draw("control", np.random.default_rng([77, i]), noise=_NOISES[i % 3]) for i in range(count)]
    return tuple((case, diagnose(_problem(case))) for case in cases)


def _problem(case: Case) -> Problem:
    channels = {c: case.recorded[c] for c in case.channels}
    t = case.recorded["t"]
    return Problem(t, channels, {c: channel_noise(t, y) for c, y in channels.items()})


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
    case = draw("control", random, setting=setting)
    values = {c: y for c, y in case.recorded.items() if c != "t"}
    share = 10.0 ** random.uniform(-3.5, -2.0)
    values["u"] = values["u"] + share * np.std(values["u"]) * random.standard_normal(values["u"].size)
    restoring = Restoring.NONE if setting == "axis" else Restoring.SPRING
    return prepare(Recording(case.recorded["t"], values), Asked(restoring))


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, pytest.param(100, marks=pytest.mark.full)])
def test_random_controls_whose_force_is_noisy(count: int) -> None:
    verdicts = [diagnose(_with_noisy_force(i)[0]).verdict for i in range(count)]
    assert verdicts.count("missing_physics") <= binom.ppf(1.0 - _CHANCE, count, 0.02)


def _with_gaps(i: int) -> Problem:
    """A driven control of which three stretches of up to a thirtieth are missing."""
    random = np.random.default_rng([79, i])
    setting = ("axis", "driven")[i % 2]
    case = draw("control", random, setting=setting)
    t = case.recorded["t"]
    keep = np.ones(t.size, dtype=bool)
    for _ in range(3):
        begin = int(random.integers(1, t.size - 40))
        keep[begin : min(begin + int(random.integers(8, max(9, t.size // 30))), t.size - 1)] = False
    values = {c: y[keep] for c, y in case.recorded.items() if c != "t"}
    restoring = Restoring.NONE if setting == "axis" else Restoring.SPRING
    return prepare(Recording(t[keep], values), Asked(restoring))[0]


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, pytest.param(100, marks=pytest.mark.full)])
def test_random_controls_with_gaps(count: int) -> None:
    problems = [_with_gaps(i) for i in range(count)]
    assert all(p.restarts is not None for p in problems)
    alarms = sum(diagnose(p).verdict != "adequate" for p in problems)
    assert alarms <= binom.ppf(1.0 - _CHANCE, count, 0.02)
