"""A recording that begins before the release, a hand that lets go slowly, and turning points."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

import harness
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import baseline, dominant_frequency
from harness.diagnosis.baseline.residual_noise import coloured_whole
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.problem import Problem
from harness.diagnosis.problems.free_decay import first_turn, turning_points
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.structure import structure
from harness.diagnosis.rules import STRUCTURE
from harness.diagnosis.search.release_transient import after_hand
from harness.estimate.noise import Noise
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
    assert said.startswith("skipped the first 0.0")


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
    grows, decays = (harness.motion(Recording(t, {"x": y})) for y in (x, x[::-1]))
    assert (grows.kind, decays.kind) == ("driven", "free-decay")
    assert grows.wanted


OMEGA, ZETA = 10.0, 0.02
T = np.linspace(0.0, 6.0, 3001)
TICK = float(T[1] - T[0])
DAMPED = OMEGA * math.sqrt(1.0 - ZETA**2)


def decay(t0: float = 0.0) -> Model:
    return Model(m=1.0, c=2.0 * ZETA * OMEGA, k=OMEGA**2, f_k=0.0, x0=1.0, t0=t0)


def channels(name: str) -> dict[str, np.ndarray]:
    run = simulate(decay(), T)
    return {name: getattr(run, name) + 1e-4 * np.random.default_rng(1).standard_normal(T.size)}


@pytest.mark.parametrize("name", ["x", "v"])
def test_a_damped_swing_turns_every_half_period(name: str) -> None:
    turns = T[turning_points(T, channels(name))]
    expected = math.pi / DAMPED * np.arange(1, turns.size + 1)
    # the last of the 19 lies 30 ms before the end: nothing shows yet that it turns back
    assert turns.size == int((6.0 - 0.05) * DAMPED / math.pi)
    assert np.max(np.abs(turns - expected)) < 0.03  # a top is flat: noise moves it


@pytest.mark.parametrize("name", ["x", "v", "a"])
def test_the_motion_is_free_from_the_first_turning_point(name: str) -> None:
    found = channels(name)
    assert T[first_turn(T, found, turning_points(T, found))] == pytest.approx(math.pi / DAMPED, abs=0.03)


def test_a_hand_that_moves_the_slider_first_is_before_it() -> None:
    """It pulls from 0.9 to 1 and lets go at 0.5 s: the first turning point of the swing is half a period later."""
    free = simulate(decay(0.5), T[T >= 0.5]).x
    pulled = 1.0 - 0.1 * (1.0 - T[T < 0.5] / 0.5) ** 2
    found = {"x": np.concatenate((pulled, free))}
    assert T[first_turn(T, found, turning_points(T, found))] == pytest.approx(0.5 + math.pi / DAMPED, abs=2 * TICK)


def test_what_rests_has_no_turning_point() -> None:
    still = {"x": 1e-4 * np.random.default_rng(2).standard_normal(T.size)}
    assert turning_points(T, still).size < 3
    assert turning_points(T, {"x": np.zeros(T.size)}).size == 0


def test_a_swing_is_found_beside_a_long_rest_off_its_mean() -> None:
    """Dry friction stops it after four cycles a fifth of the way; the rest then lies off zero for as long again."""
    model = Model(m=1.0, c=0.5, k=OMEGA**2, f_k=6.0, x0=1.0)
    t = np.linspace(0.0, 8.0, 2001)
    assert dominant_frequency(t, simulate(model, t).x + 0.3) == pytest.approx(OMEGA, rel=0.1)


def coloured(phi: float) -> np.ndarray:
    return Noise(1.0, True, phi).drawn(4000, np.random.default_rng(3))


def test_a_steady_residual_of_first_order_colour_is_noise() -> None:
    said = Noise(0.5, True)
    found = coloured_whole(coloured(0.6), np.ones(4000), said, 28)
    assert found.phi == pytest.approx(0.6, abs=0.05)
    assert found.sigma == pytest.approx(1.0, rel=0.05)


def test_a_burst_is_no_noise() -> None:
    """A hand's jerk in the first fiftieth of a residual: five times as strong as what follows."""
    said, burst = Noise(0.5, True), coloured(0.6)
    burst[:80] *= 5.0
    assert coloured_whole(burst, np.ones(4000), said, 28) is said


@pytest.mark.parametrize("width", [12, 28, 40])
@pytest.mark.parametrize("phi", [0.3, 0.6, 0.8])
def test_noise_of_a_colour_is_seen_as_such_by_windows_too(phi: float, width: int) -> None:
    said = Noise(0.5, True)
    for seed in range(40):
        drawn = Noise(1.0, True, phi).drawn(600, np.random.default_rng(seed))
        assert coloured_whole(drawn, np.ones(600), said, width).phi > 0.0


@pytest.mark.parametrize("width", [20, 28, 40])
def test_a_slow_misfit_under_a_fast_noise_is_no_colour(width: int) -> None:
    """Its neighbours are as alike as those of a colour, but a window of a quarter of a swing sees the noise alone."""
    said, t = Noise(1.0, True), np.arange(1200.0)
    for seed in range(20):
        random = np.random.default_rng(seed)
        slow = np.cos(2.0 * np.pi * t / 112.0 + random.uniform(0.0, 6.0)) * (1.0 + 0.3 * np.cos(t / 200.0))
        residual = random.standard_normal(t.size) + 2.0 * slow
        close = float(residual[1:] @ residual[:-1] / (residual @ residual))
        assert 0.5 < close < 0.8
        assert coloured_whole(residual, np.ones(t.size), said, width) is said
