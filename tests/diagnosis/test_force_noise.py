"""The noise of a measured force: what it does to a motion, and residuals that allow for it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.draws import logs
from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.events import EventKind, Mode
from harness.core.recording import Recording
from harness.diagnosis.baseline.base_fit import driven_baseline
from harness.diagnosis.input_noise.noisy_base_fit import along
from harness.diagnosis.input_noise.propagation import as_it_shows, force_noise
from harness.diagnosis.pipeline import diagnose, prepare
from harness.diagnosis.problem import Observation
from harness.diagnosis.problems.driven import Driven
from harness.diagnosis.problems.force_noise import ForceNoise
from harness.diagnosis.problems.simulated import observe
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import DECISIVE
from harness.estimate.noise import Noise
from harness.kernels.solve import Drive, solve
from harness.model.model import Model, ModelTerm, Restoring

STEP = 0.01
T: FloatArray = np.arange(600.0) * STEP
DRIVE = 3.0 * np.sin(7.0 * T) + 4.0 * np.sin(3.1 * T + 0.4)
SPRING = Model(1.5, 2.0, 60.0, 1.2, x0=0.1, v0=0.2, mass_known=True)
AXIS = replace(SPRING, k=0.0, restoring=Restoring.NONE)
PENDULUM = replace(SPRING, restoring=Restoring.PENDULUM, x0=0.3)
SENSORS = {"x": Noise(1e-4, True), "v": Noise(1e-3, True), "a": Noise(0.05, True)}


def seen(model: Model, u: FloatArray = DRIVE) -> Observation:
    problem = Driven(T, dict.fromkeys("xva", T), SENSORS, drive=Drive(T, u), first=model, restoring=model.restoring)
    return observe(model, problem)


def of(model: Model, force: Noise, sensors: dict[str, Noise] | None = None) -> ForceNoise:
    found = force_noise(model, seen(model), T, force, sensors or SENSORS)
    assert found is not None
    return found


@pytest.mark.parametrize("model", [SPRING, AXIS, PENDULUM], ids=["spring", "axis", "pendulum"])
def test_what_noise_does_is_right_to_first_order_through_reversals_and_sticking(model: Model) -> None:
    plain = solve(model, T, drive=Drive(T, DRIVE))
    assert {int(k) for k in plain.events.kind} >= {int(EventKind.REVERSAL)}
    w = np.random.default_rng(3).standard_normal(T.size)
    noise = of(model, Noise(1.0, True))
    felt, missed = noise.felt(w)["x"], []
    for size in (1e-3, 1e-4, 1e-5):
        disturbed = solve(model, T, drive=Drive(T, DRIVE + size * w))
        same = (disturbed.mode == plain.mode) & (np.arange(T.size) > 0)
        off = (disturbed.x - plain.x) / size - felt
        missed.append(float(np.max(np.abs(off[same])) / np.max(np.abs(felt))))
    assert missed[2] < 1e-3
    assert missed[0] / missed[1] > 5.0


def test_the_cases_stick_and_pass_through() -> None:
    for model in (SPRING, AXIS):
        assert np.count_nonzero(seen(model).events.kind == EventKind.REVERSAL) >= 3
    assert np.any(seen(SPRING).mode == Mode.STICK)


def covariance(noise: ForceNoise, sensors: dict[str, Noise], at: slice) -> FloatArray:
    """Of x, v and a at some samples, one channel after another, dense."""
    n = T[: at.stop].size
    lags = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    force = noise.noise.sigma**2 * noise.noise.phi**lags
    by = np.zeros((n, 2, n))
    for i, m in enumerate(noise.moves[: n - 1]):
        by[i + 1] = m[:, :2] @ by[i]
        by[i + 1, :, i] += m[:, 2]
        by[i + 1, :, i + 1] += m[:, 3]
    speeds = by[:, 1]
    accelerations = noise.slips[:n, None] * (
        -noise.pull[:n, None] * by[:, 0] - noise.drag * speeds + noise.push * np.eye(n)
    )
    shown = np.concatenate([part[at] for part in (by[:, 0], speeds, accelerations)])
    total: FloatArray = shown @ force @ shown.T
    k = T[at].size
    colour = np.abs(np.subtract.outer(np.arange(k), np.arange(k)))
    for i, c in enumerate("xva"):
        total[i * k : (i + 1) * k, i * k : (i + 1) * k] += sensors[c].sigma ** 2 * sensors[c].phi ** colour
    return total


@given(
    phi=st.floats(0.0, 0.9), colour=st.floats(-0.5, 0.9), level=st.floats(0.003, 1.0), stride=st.integers(1, 7),
    model=st.sampled_from([SPRING, AXIS, PENDULUM]),
)  # fmt: skip
@settings(max_examples=12, deadline=None)
def test_innovations_are_white_and_of_unit_variance(
    phi: float, colour: float, level: float, stride: int, model: Model
) -> None:
    sensors = {c: replace(n, phi=colour) for c, n in SENSORS.items()}
    noise = replace(of(model, Noise(level, True, phi), sensors), jumps=np.zeros((T.size, 4)))
    at = slice(0, 120, stride)
    k = T[at].size
    unit = np.eye(3 * k)
    values = {c: unit[i * k : (i + 1) * k] for i, c in enumerate("xva")}
    whitened, variance = noise.whitened(T[at], sensors, dict.fromkeys("xva", np.ones(k)), values)
    by = np.concatenate([whitened[c] for c in "xva"])
    assert by @ covariance(noise, sensors, at) @ by.T == pytest.approx(np.eye(3 * k), abs=1e-6)
    for c, n in sensors.items():
        assert np.all(variance[c] > 0.999 * n.sigma**2 * (1.0 - n.phi**2))


def test_samples_that_do_not_count_are_passed_over() -> None:
    noise = replace(of(SPRING, Noise(0.1, True)), jumps=np.zeros((T.size, 4)))
    random = np.random.default_rng(1)
    values = {c: random.standard_normal(T.size) for c in "xva"}
    keep = random.random(T.size) < 0.5
    left_out = dict.fromkeys("xva", keep.astype(np.float64))
    found, _ = noise.whitened(T, SENSORS, left_out, values)
    fewer, _ = noise.whitened(
        T[keep], SENSORS, dict.fromkeys("xva", np.ones(int(keep.sum()))), {c: y[keep] for c, y in values.items()}
    )
    for c in "xva":
        assert np.all(found[c][~keep] == 0.0)
        assert found[c][keep] == pytest.approx(fewer[c], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("force", [Noise(0.1, False), Noise(1e-7, True)], ids=["none found", "too little"])
def test_a_force_whose_noise_does_not_show_leaves_residuals_as_they_are(force: Noise) -> None:
    assert force_noise(SPRING, seen(SPRING), T, force, SENSORS) is None


def test_an_acceleration_beside_a_jump_is_doubted_as_far_as_the_event_may_lie_on_its_other_side() -> None:
    noise = of(SPRING, Noise(0.3, True))
    ones, nothing = dict.fromkeys("a", np.ones(T.size)), {"a": np.zeros(T.size)}
    _, doubted = noise.whitened(T, SENSORS, ones, nothing)
    _, plain = replace(noise, jumps=np.zeros((T.size, 4))).whitened(T, SENSORS, ones, nothing)
    more = doubted["a"] / plain["a"]
    turns = seen(SPRING).events
    beside = np.min(np.abs(T[:, None] - turns.t[turns.a_before != turns.a_after]), axis=1) < STEP
    assert np.max(more[beside]) > 1.5
    assert np.max(more[~beside]) < 1.5
    # of two sides never more than a quarter of the jump's square
    assert np.max(doubted["a"] - plain["a"]) < 0.25 * np.max(noise.jumps[:, 0]) ** 2 + np.max(plain["a"])


def recorded(
    model: Model, share: float, channels: str = "xa", seed: int = 0, n: int = 900, step: float = 0.008
) -> Recording:
    """Driven by a known force that is recorded with white noise of a share of its rms."""
    t: FloatArray = np.arange(float(n)) * step
    u = 3.0 * np.sin(7.0 * t) + 4.0 * np.sin(3.1 * t + 0.4)
    motion = solve(model, t, drive=Drive(t, u), want_a=True)
    random = np.random.default_rng(seed)
    sigma = {"x": 1e-4, "a": 0.03}
    seen = {c: getattr(motion, c) + sigma[c] * random.standard_normal(t.size) for c in channels}
    return Recording(t, {**seen, "u": u + share * np.std(u) * random.standard_normal(t.size)})


def test_nothing_is_missing_where_only_the_force_is_noisy() -> None:
    problem, notes = prepare(recorded(AXIS, 3e-3), Asked(AXIS.restoring))
    assert isinstance(problem, Driven)
    assert problem.force_noise is not None
    assert "shows in the motion and is allowed for" in notes[-1]
    assert diagnose(problem).verdict == "adequate"


def test_numbers_hold_that_a_noisy_force_tells() -> None:
    off = []
    for seed in range(4):
        problem, _ = prepare(recorded(SPRING, 1e-2, "x", seed, 1000, 0.01), Asked())
        assert isinstance(problem, Driven)
        base, scales = driven_baseline(problem)
        _, base = along(base, problem, scales)
        errors = np.sqrt(np.diag(base.covariance()))
        for f, value, error in zip(base.free, base.values, errors, strict=True):
            if f.by in ("m", "c", "k", "f_k"):
                off.append((value - getattr(SPRING, str(f.by))) / error)
    assert np.max(np.abs(off)) < 3.5
    assert 0.6 < float(np.sqrt(np.mean(np.square(off)))) < 1.4


def test_what_is_missing_is_named_beside_a_noisy_force() -> None:
    drag = ModelTerm.named("quadratic-drag", c2=6.0)
    problem, _ = prepare(recorded(replace(SPRING, terms=(drag,)), 1e-2, n=500), Asked())
    assert [m.name for m in diagnose(problem).mechanisms] == ["quadratic-drag"]


def test_what_noise_does_beyond_first_order_is_told() -> None:
    told = []
    for share in (1e-3, 1e-1):
        problem, _ = prepare(recorded(SPRING, share, n=500), Asked())
        assert isinstance(problem, Driven)
        base, scales = driven_baseline(problem)
        problem, _ = along(base, problem, scales)
        assert problem.force_noise is not None
        told.append(problem.force_noise.beyond)
    assert told[0] < DECISIVE.value < told[1]


def test_a_noisy_force_moves_nothing_that_rests() -> None:
    # a servo's axis, at rest for two fifths of the time, whose force scatters by 3 % of its friction
    found = logs.still(9, 2)
    assert found.right, found.said


def test_a_motion_that_leaves_all_bounds_shows_no_level() -> None:
    problem = Driven(
        T, dict.fromkeys("xva", T), SENSORS, drive=Drive(T, DRIVE), first=SPRING, restoring=SPRING.restoring
    )
    shown = seen(SPRING)
    nowhere = replace(shown, y={c: np.full_like(y, np.nan) for c, y in shown.y.items()})
    with pytest.raises(SimulationError, match="leaves all bounds"):
        as_it_shows(of(SPRING, Noise(0.3, True)), problem, nowhere)
