"""The diagnosis against the independent plant: names what was hidden, names nothing where nothing was."""

import functools
from dataclasses import replace

import numpy as np
import pytest

from harness.diagnosis.outcome import Outcome
from harness.diagnosis.pipeline import diagnose
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.estimate.noise import channel_noise
from harness.proof.plant.cases import Case, draw

SHORT = ("quadratic-drag",)
LONG = (
    "sensor-lag", "asymmetric-viscous", "cubic-stiffness", "sensor-gain", "stribeck", "presliding", "friction-drift",
    "end-stop", "impulse",
)  # fmt: skip


def _problem(case: Case) -> Problem:
    channels = {c: case.recorded[c] for c in case.channels}
    t = case.recorded["t"]
    return FreeDecay(t, channels, {c: channel_noise(t, y) for c, y in channels.items()})


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
