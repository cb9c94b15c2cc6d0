"""Structure is told from noise and found where it was put; what is held out is predicted."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lfilter

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.recording import Recording
from harness.diagnosis.explain import holdout as periods
from harness.diagnosis.explain.locate import locate
from harness.diagnosis.grading.prediction import Predicted, surely_less
from harness.diagnosis.inverse_dynamics import validate as windows
from harness.diagnosis.motion import Motion, motion_of
from harness.diagnosis.pipeline import diagnose, explain, fit_base, judge, prepare, search
from harness.diagnosis.prepare.driven import forced_problem
from harness.diagnosis.problems.free_decay import FreeDecay
from harness.diagnosis.request import Asked
from harness.diagnosis.residual_tests.lack_of_fit import lack_of_fit
from harness.diagnosis.rules import LAW_KNOWN
from harness.estimate.noise import channel_noise
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring
from harness.proof.plant.cases import draw


def swing(n: int, per_period: int) -> tuple[FloatArray, Motion]:
    t = np.arange(n, dtype=np.float64)
    omega = 2.0 * np.pi / per_period
    envelope = np.exp(-t / n)
    x, v = envelope * np.cos(omega * t), -omega * envelope * np.sin(omega * t)
    return t, Motion(x, v, np.zeros(n, dtype=np.bool_), omega)


def fitted(
    t: FloatArray, motion: Motion, r: dict[str, FloatArray]
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Residuals after five numbers were fitted to them, in units of a level taken from themselves."""
    j = np.column_stack(
        [motion.x, motion.v / motion.omega, t / t.size * motion.x, t / t.size * motion.v / motion.omega]
    )
    j = np.column_stack([j, np.sign(motion.v)])
    whole, partials = (
        np.concatenate(list(r.values())),
        np.concatenate([j if i == 0 else -0.7 * j for i in range(len(r))]),
    )
    left = whole - partials @ np.linalg.lstsq(partials, whole, rcond=None)[0]
    parts = dict(zip(r, np.split(left, len(r)), strict=True))
    return {c: y / (1.4826 * float(np.median(np.abs(y)))) for c, y in parts.items()}, dict.fromkeys(r, j) | (
        {"a": -0.7 * j} if "a" in r and len(r) > 1 else {}
    )


def false_alarms(n: int, per_period: int, channels: str, draws: int, misplaced: bool) -> int:
    rng = np.random.default_rng(7)
    t, motion = swing(n, per_period)
    turns = np.arange(per_period // 2, n, per_period // 2)
    count = 0
    for _ in range(draws):
        r = {c: rng.standard_normal(n) for c in channels}
        if misplaced:
            for c in channels:
                r[c][turns] += 10.0 * np.sign(motion.x[turns]) * (rng.uniform(size=turns.size) < 0.3)
        left, partials = fitted(t, motion, r)
        count += lack_of_fit(left, t, motion.omega, jacobian=partials, motion=motion).p_value < 0.01
    return count


CASES = [(300, 30, "x"), (800, 40, "xa"), (2000, 100, "xa")]


@pytest.mark.parametrize(("n", "per_period", "channels"), CASES)
@pytest.mark.parametrize("misplaced", [False, True])
def test_noise_is_called_noise_at_the_promised_rate(n: int, per_period: int, channels: str, misplaced: bool) -> None:
    # 250 draws at 1 %: more than 9 would happen once in a few thousand times
    assert false_alarms(n, per_period, channels, 250, misplaced) <= 9


SMOOTH: list[Callable[[FloatArray, Motion], FloatArray]] = [
    lambda t, m: 0.2 * np.cos(2.0 * m.omega * t),
    lambda t, m: 0.3 * np.sin(0.3 * m.omega * t),
    lambda t, m: 0.3 * np.sin(9.3 * m.omega * t),
    lambda t, m: np.where(np.abs(t - 2000.0) < 20.0, 1.5, 0.0),
]


@pytest.mark.parametrize("misfit", SMOOTH)
def test_a_misfit_far_below_the_noise_is_seen(misfit: Callable[[FloatArray, Motion], FloatArray]) -> None:
    t, motion = swing(4000, 100)
    left, partials = fitted(t, motion, {"x": np.random.default_rng(3).standard_normal(t.size) + misfit(t, motion)})
    found = lack_of_fit(left, t, motion.omega, jacobian=partials, motion=motion)
    assert found.p_value < 1e-3
    assert "times what noise gives there" in found.sentence


PARTS: list[tuple[str, Callable[[FloatArray, Motion], FloatArray]]] = [
    ("half", lambda t, m: np.where(t < t.size / 2, 2.0, -2.0)),
    ("direction", lambda t, m: np.sign(m.v)),
    ("side", lambda t, m: np.sign(m.x)),
]


@pytest.mark.parametrize(("part", "changes"), PARTS, ids=[p[0] for p in PARTS])
def test_a_parameter_that_changes_from_part_to_part_is_seen(
    part: str, changes: Callable[[FloatArray, Motion], FloatArray]
) -> None:
    t, motion = swing(4000, 100)
    misfit = 0.2 * changes(t, motion) * motion.x
    left, partials = fitted(t, motion, {"x": np.random.default_rng(3).standard_normal(t.size) + misfit})
    found = lack_of_fit(left, t, motion.omega, jacobian=partials, motion=motion)
    assert dict(found.tests)[f"parameters that differ from {part} to {part}"] < 1e-6


def test_a_hundredth_of_an_explained_effect_counts_as_explained() -> None:
    t, motion = swing(4000, 100)
    misfit = 0.2 * np.sign(motion.x) * motion.x
    left, partials = fitted(t, motion, {"x": np.random.default_rng(3).standard_normal(t.size) + misfit})

    def seen(gain: float) -> float:
        spare = LAW_KNOWN.value * gain
        found = lack_of_fit(left, t, motion.omega, jacobian=partials, motion=motion, spare=spare)
        return dict(found.tests)["parameters that differ from side to side"]

    assert seen(0.0) < 1e-6
    assert seen((150.0**2) * float(np.sum(misfit**2))) > 0.01


def test_numbers_far_below_the_claimed_noise_are_no_structure() -> None:
    t, motion = swing(4000, 100)
    assert lack_of_fit({"x": 1e-3 * motion.x}, t, motion.omega).p_value > 0.5
    assert lack_of_fit({"x": np.zeros(t.size)}, t, motion.omega).p_value == 1.0


def test_a_quantised_sensor_at_rest_says_one_thing_once() -> None:
    t, motion = swing(4000, 100)
    r = np.random.default_rng(5).standard_normal(t.size)
    r[2500:] = 1.2
    assert lack_of_fit({"x": r}, t, motion.omega).p_value > 0.01


@pytest.mark.parametrize("phi", [0.0, 0.6, 0.9, 0.97])
def test_no_place_is_found_in_noise_of_any_colour(phi: float) -> None:
    rng = np.random.default_rng(11)
    t, motion = swing(1200, 60)
    found = 0
    for _ in range(200):
        r = lfilter([np.sqrt(1.0 - phi * phi)], [1.0, -phi], rng.standard_normal(t.size))
        found += bool(locate({"x": r}, t, motion))
    assert found <= 8


PLACES: list[tuple[str, str, Callable[[FloatArray, Motion], FloatArray]]] = [
    ("low-speed", "|v| < ", lambda t, m: np.where(np.abs(m.v) < 0.1 * m.omega, 4.0 * np.sin(7.0 * t * m.omega), 0.0)),
    ("one-side", "x > ", lambda t, m: np.where(m.x > 0.5, 4.0 * np.sin(7.0 * t * m.omega), 0.0)),
    ("one-direction", "v > 0", lambda t, m: np.where(m.v > 0.0, 3.0 * np.sin(7.3 * t * m.omega), 0.0)),
    ("late", "t > 3998 s", lambda t, m: np.where(t > 4000.0, 2.0 * np.sin(7.3 * t * m.omega), 0.0)),
    ("high-speed", "|v| > ", lambda t, m: np.where(np.abs(m.v) > 0.7 * m.omega, 4.0 * np.sin(7.3 * t * m.omega), 0.0)),
]


@pytest.mark.parametrize(("regime", "condition", "misfit"), PLACES, ids=[p[0] for p in PLACES])
def test_a_misfit_is_found_where_it_was_put(
    regime: str, condition: str, misfit: Callable[[FloatArray, Motion], FloatArray]
) -> None:
    t, motion = swing(5000, 250)
    wrong = misfit(t, motion)
    first, *_ = locate({"x": np.random.default_rng(2).standard_normal(t.size) + wrong}, t, motion)
    assert first.regime == regime
    assert first.condition.startswith(condition)
    inside = np.zeros(t.size, dtype=np.bool_)
    for low, high in first.spans:
        inside |= (t >= low) & (t <= high)
    where = wrong != 0.0
    assert np.count_nonzero(inside & where) / np.count_nonzero(inside | where) > 0.6
    assert first.share is not None
    assert first.share > 0.6


def test_a_control_is_predicted_as_well_with_the_best_ranked_term_forced_in() -> None:
    case = draw("control", np.random.default_rng(3))
    t, channels = case.recorded["t"], {c: case.recorded[c] for c in case.channels}
    outcome = diagnose(FreeDecay(t, channels, {c: channel_noise(t, y) for c, y in channels.items()}))
    assert outcome.verdict == "adequate"
    forced = outcome.holdout.forced
    assert forced is not None
    assert forced.name
    assert set(forced.refined_rmse) == set(channels)
    for channel, after in forced.refined_rmse.items():
        assert 0.95 < after / forced.baseline_rmse[channel] <= 1.05


def fails(*_: object, **__: object) -> None:
    raise SimulationError("it diverged")


def test_a_fitted_force_without_its_held_out_windows(monkeypatch: pytest.MonkeyPatch) -> None:
    """A force that nobody measured acts too, so that the recorded one is what is fitted."""
    t, draw = np.arange(3000) / 1000.0, np.random.default_rng(7)
    unseen = np.zeros(t.size)
    for i in range(1, t.size):
        unseen[i] = 0.975 * unseen[i - 1] + 0.1 * draw.standard_normal()
    u = 6.0 * np.sin(3.1 * t) + 4.0 * np.sin(7.3 * t + 1.1) + 3.0 * np.sin(14.0 * t + 2.0)
    truth = Model(2.0, 3.0, 0.0, 1.5, restoring=Restoring.NONE)
    x = solve(truth, t, drive=Drive(t, u + unseen)).x + 1e-7 * draw.standard_normal(t.size)
    # followed, no law explains it
    problem, _ = forced_problem(Recording(t, {"x": x, "u": u}), Asked(Restoring.NONE))
    judged = judge(search(fit_base(problem)))
    whole = explain(judged)
    assert whole.holdout.spans
    # the force that nobody measured is more than noise, and no law
    assert whole.verdict == "unexplained"
    monkeypatch.setattr(windows, "fit", fails)
    outcome = explain(judged)
    assert (outcome.holdout.spans, outcome.holdout.baseline_rmse, outcome.holdout.refined_rmse) == ((), {}, {})
    assert "the base model, fitted to the rest, cannot be followed" in " ".join(outcome.warnings)
    assert (outcome.verdict, outcome.base_parameters) == (whole.verdict, whole.base_parameters)


def decay() -> Recording:
    truth = Model(1.0, 0.3, 100.0, 0.4, x0=0.1, terms=(ModelTerm.named("quadratic-drag", c2=2.0),))
    t = np.arange(0.0, 4.0, 0.01)
    return Recording(t, {"x": solve(truth, t).x + 1e-5 * np.random.default_rng(2).standard_normal(t.size)})


def test_a_decay_without_its_held_out_periods_and_what_a_lone_term_is_worth(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(periods, "fit", fails)
    outcome = diagnose(prepare(decay(), Asked(zero_free=False))[0])
    assert [m.name for m in outcome.mechanisms] == ["quadratic-drag"]
    assert (outcome.holdout.spans, outcome.holdout.refined_rmse) == ((), {})
    assert "there is no prediction of what is held out: the base model" in " ".join(outcome.warnings)
    # taken out of the refined model, a lone term leaves the base
    assert math.isclose(outcome.mechanisms[0].delta_bic, outcome.base.bic - outcome.refined.bic, rel_tol=1e-12)


def _by_span(squares: list[float]) -> Predicted:
    spans = tuple((float(i), float(i + 1)) for i in range(len(squares)))
    return Predicted({"x": np.array(squares)}, np.ones(len(squares)), {"x": 1.0}, spans)


@pytest.mark.parametrize(
    ("after", "sure"),
    [
        # a tenth of each block, though the first misses a hundred times the last
        ([10.0, 3.0, 0.9, 0.3, 0.11], True),
        # all but the largest nearly vanish, which falls to a fifth
        ([20.0, 0.6, 0.1, 0.05, 0.02], True),
        # the largest alone falls; the others rise
        ([10.0, 45.0, 14.0, 4.5, 1.5], False),
        # as much as before, give or take
        ([90.0, 33.0, 9.0, 3.3, 0.9], False),
        ([100.0, 30.0, 10.0, 3.0, 1.0], False),
    ],
)
def test_a_fall_is_sure_by_its_share_of_each_block(after: list[float], sure: bool) -> None:
    """The jackknife's error of a ratio: how unequal the blocks are is no scatter."""
    before = _by_span([100.0, 30.0, 10.0, 3.0, 1.0])
    assert surely_less(_by_span(after), before, 2.0) is sure
    assert not surely_less(before, _by_span(after), 2.0)


def test_the_motion_is_told_by_any_channel() -> None:
    t, omega = np.linspace(0.0, 6.0, 1500), 9.0
    x = np.cos(omega * t)
    v, a = -omega * np.sin(omega * t), -(omega**2) * np.cos(omega * t)
    inner = slice(200, -200)
    for channels in ({"x": x}, {"x": x, "v": v}, {"v": v}, {"a": a}):
        found = motion_of(t, channels, omega)
        assert np.max(np.abs(found.x - x)[inner]) < 0.05
        assert np.max(np.abs(found.v - v)[inner]) < 0.05 * omega
        assert not found.stuck.any()
    coarse = motion_of(t[::60], {"x": x[::60]}, omega)
    assert np.max(np.abs(coarse.v)) > 0.7 * omega
    rests = motion_of(t, {"x": np.where(t < 3.0, x, x[750]), "v": np.where(t < 3.0, v, 0.0)}, omega)
    assert rests.stuck[t > 3.01].all()
    assert not rests.stuck[t < 2.9].any()
