"""A recording that begins before the release, and a hand that takes its time to let go."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.problem import Problem
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.structure import structure
from harness.diagnosis.rules import STRUCTURE
from harness.diagnosis.search.release_transient import after_hand
from harness.kernels.solve import Drive, simulate, solve
from harness.model.model import Model, ModelTerm, Restoring

SIGMA = {"x": 1e-3, "a": 0.1}
STEP = 1e-3


def by_hand(
    x0: float = 1.0, hold: float = 0.5, ramp: float = 0.0, pull: float = 0.0, restoring: Restoring = Restoring.SPRING,
    channels: str = "xa", omega: float = 10.0, *terms: ModelTerm,
) -> Recording:  # fmt: skip
    """Pulled to x0 within ``pull`` s, held for ``hold`` s, let go over ``ramp`` s: the hand's force falls linearly."""
    model = Model(1.0, 0.04 * omega, omega**2, 0.02 * omega**2, x0=x0, restoring=restoring, terms=terms)
    t = np.arange(0.0, 5.0, STEP)
    held = omega**2 * (math.sin(x0) if restoring is Restoring.PENDULUM else x0)
    if ramp > 0.0:
        force = held * np.clip(1.0 - t / ramp, 0.0, None)
        free = solve(model, t, (), Drive(t, force), want_a=True)
    else:
        free = solve(model, t, want_a=True)
    before = np.arange(round((pull + hold) / STEP)) * STEP
    s = np.minimum(before / pull, 1.0) if pull > 0.0 else np.ones(before.size)
    drawn = {
        "x": x0 * (10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5),
        "a": x0 * (60.0 * s - 180.0 * s**2 + 120.0 * s**3) / max(pull, 1e-9) ** 2 * (s < 1.0),
    }
    random = np.random.default_rng(4)
    whole = {"x": np.concatenate((drawn["x"], free.x)), "a": np.concatenate((drawn["a"], free.a))}
    noisy = {c: whole[c] + SIGMA[c] * random.standard_normal(whole[c].size) for c in channels}
    return Recording(STEP * np.arange(float(whole["x"].size)), noisy, "by hand")


@pytest.mark.parametrize(
    "case",
    [
        {"channels": "a"},
        {"ramp": 0.01},
        {"ramp": 0.05, "channels": "x"},
        {"ramp": 0.03, "channels": "a"},
        {"ramp": 0.03, "omega": 30.0},
        {"ramp": 0.03, "omega": 4.0},
        {"ramp": 0.03, "pull": 1.0},
        {"ramp": 0.02, "pull": 1.0, "hold": 0.0},
        {"ramp": 0.02, "pull": 1.0, "hold": 0.0, "channels": "a"},
        {"x0": 2.5, "hold": 0.7, "ramp": 0.03, "restoring": Restoring.PENDULUM},
        {"x0": 2.5, "pull": 1.0, "hold": 0.0, "ramp": 0.03, "restoring": Restoring.PENDULUM},
    ],
    ids=str,
)
def test_viscous_and_coulomb_friction_explain_what_follows_the_hand(case: dict[str, object]) -> None:
    recording = by_hand(**case)  # type: ignore[arg-type]
    problem, notes = prepare(recording, Asked(case.get("restoring", Restoring.SPRING)))  # type: ignore[arg-type]
    found, scales = baseline(problem)
    assert structure(found, problem, scales.omega).p_value > STRUCTURE.value
    model = found.model
    assert found.chi2 / found.points == pytest.approx(1.0, abs=0.12)
    assert math.sqrt(model.k) == pytest.approx(case.get("omega", 10.0), rel=1e-3)
    assert model.c / (2.0 * math.sqrt(model.k)) == pytest.approx(0.02, rel=0.02)
    assert model.f_k / model.k == pytest.approx(0.02, rel=0.02)
    assert "before the release" in notes[0]
    # no more is lost than half a swing
    release = float(case.get("pull", 0.0)) + float(case.get("hold", 0.5))  # type: ignore[arg-type]
    assert release - 0.02 < problem.t[0] < release + float(case.get("ramp", 0.0)) + math.pi / 10.0 + 0.05  # type: ignore[arg-type]


@pytest.mark.parametrize("x0", [1.0, 2.5, 3.0])
def test_a_pendulum_let_go_at_the_first_sample_loses_none(x0: float) -> None:
    """Its first half-swing is longer than the others, and no hold."""
    problem, notes = prepare(by_hand(x0, 0.0, restoring=Restoring.PENDULUM), Asked(Restoring.PENDULUM))
    assert notes == ()
    assert problem.t[0] == 0.0


def test_a_release_in_an_instant_is_found_to_the_sample() -> None:
    problem, notes = prepare(by_hand(hold=0.8), Asked())
    assert problem.t[0] == pytest.approx(0.8, abs=4.0 * STEP)
    assert len(notes) == 1


def test_a_recording_that_begins_while_the_hand_lets_go_needs_no_physics_for_it() -> None:
    recording = by_hand(hold=0.0, ramp=0.03, channels="x").cut(slice(0, 2500))
    outcome = diagnose(prepare(recording, Asked())[0])
    assert outcome.verdict == "adequate"


@pytest.mark.parametrize(("a_swing", "samples", "seed"), [(11.0, 140.0, 6)])
def test_a_hold_of_a_few_samples_is_neither_friction_nor_knocks(a_swing: float, samples: float, seed: int) -> None:
    # held for a quarter of a swing: shown by three samples of the one, of the other left to what follows
    t = 2.0 * math.pi / 6.24 / a_swing * np.arange(samples)
    held = Model(1.0, 0.0476, 6.24**2, 0.0063, x0=0.76, t0=0.27, restoring=Restoring.PENDULUM)
    x = simulate(held, t).x + 0.0024 * np.random.default_rng(seed).standard_normal(t.size)
    problem, notes = prepare(Recording(t, {"x": x}, "held"), Asked(Restoring.PENDULUM))
    outcome = diagnose(problem)
    assert outcome.verdict == "adequate"
    assert len((*notes, *outcome.warnings)) == 1


@pytest.mark.parametrize("every", [40])
def test_a_hand_that_one_or_two_samples_show_is_no_knock(every: int) -> None:
    often = by_hand(hold=0.0, ramp=0.06, channels="x", omega=4.0)
    few = Recording(often.t[::every], {"x": often.channels["x"][::every]}, "few")
    outcome = diagnose(prepare(few, Asked())[0])
    assert (outcome.verdict, outcome.mechanisms) == ("adequate", ())
    (said,) = outcome.warnings
    assert said.startswith("the first 0.0")


def test_physics_left_out_is_named_with_a_hand_too() -> None:
    cubic = ModelTerm.named("cubic-stiffness", k3=20.0)
    motion = simulate(Model(1.0, 0.4, 100.0, 2.0, x0=1.0, terms=(cubic,)), np.arange(0.0, 3.0, STEP))
    before = np.ones(400)
    x = np.concatenate((before, motion.x)) + 1e-3 * np.random.default_rng(2).standard_normal(3400)
    problem, _ = prepare(Recording(STEP * np.arange(3400.0), {"x": x}, "by hand"), Asked())
    outcome = diagnose(problem)
    assert [m.name for m in outcome.mechanisms] == ["cubic-stiffness"]


@pytest.fixture
def gearbox(recordings: Path) -> Problem:
    """A back-driven gearbox: it swings for a second and rests for three, which any model meets."""
    log = json.loads((recordings / "xl330-pendulum" / "2026-01-15_10h28m17.json").read_text(encoding="utf-8"))
    free = [(e["timestamp"], e["position"]) for e in log["entries"] if not e["torque_enable"]]
    t, x = np.array(free).T
    return prepare(Recording(t - t[0], {"x": x}), Asked(Restoring.PENDULUM))[0]


def test_a_rest_that_agrees_with_anything_is_no_free_decay(gearbox: Problem) -> None:
    _, scales = baseline(gearbox)
    assert after_hand(gearbox, scales) is None


def test_a_swing_that_grows_is_said_to_be_pushed() -> None:
    t = np.arange(0.0, 4.0, 4e-3)
    noise = 2e-5 * np.random.default_rng(0).standard_normal(t.size)
    x = 5e-3 * np.exp(0.35 * t) * np.cos(12.0 * t) + noise
    assert prepare(Recording(t, {"x": x}), Asked())[1][0].startswith(
        "the swing grows, which friction never makes it do"
    )
    assert prepare(Recording(t, {"x": x[::-1]}), Asked())[1] == ()
