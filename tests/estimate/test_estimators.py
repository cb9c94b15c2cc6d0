"""The other estimators, refusals, and what a recording can throw at them."""

import math

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.estimate.every import METHODS, estimate_all
from harness.estimate.result import Estimation
from harness.exact.decay import Decay, free_decay

PAPER = Decay(10.0, 0.05, 0.03, 1.0)
T = np.arange(0.0, 3.5, 1e-3)
CLEAN = free_decay(PAPER, T)
CLEAN_HALF = math.pi / (10.0 * math.sqrt(1.0 - 0.05**2))
RNG_SEED = 4


def _close(found: Estimation, method: str, x_k: float, zeta: float, sigmas: float = 4.0) -> None:
    estimate = found[method]
    for figure, truth in ((estimate.x_k, x_k), (estimate.zeta, zeta)):
        assert figure.value is not None, figure.why
        assert figure.stderr is not None
        assert abs(figure.value - truth) < sigmas * figure.stderr + 1e-8, (method, figure, truth)


def _late(start: float, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """x and a of the paper's case released at ``start`` s, held before."""
    times, back = np.unique(np.maximum(t - start, 0.0), return_inverse=True)
    motion = free_decay(PAPER, times)
    return motion.x[back], np.where(t < start, 0.0, motion.a[back])


def _noise(n: int, size: float, seed: int = RNG_SEED) -> FloatArray:
    return size * np.random.default_rng(seed).standard_normal(n)


@pytest.mark.parametrize("method", ["acceleration", "acceleration-local", "displacement"])
def test_exact_on_the_papers_case(method: str) -> None:
    estimate = estimate_all(T, CLEAN.x, CLEAN.v, CLEAN.a)[method]
    assert estimate.x_k.value == pytest.approx(0.03, rel=1e-6)
    assert estimate.zeta.value == pytest.approx(0.05, rel=1e-6)
    assert estimate.omega_n.value == pytest.approx(10.0, rel=1e-6)


def test_turning_points_of_the_papers_case() -> None:
    rows = estimate_all(T, x=CLEAN.x)["displacement"].per_reversal
    known = [-0.7988338562165538, 0.6269438451936182, -0.48006934964594244, 0.35456980889888967]
    assert [row.x for row in rows[:4]] == pytest.approx(known, abs=1e-10)
    assert [row.zeta for row in rows[:4]] == pytest.approx([0.05] * 4, abs=1e-9)


def test_isolated_cases() -> None:
    viscous = free_decay(Decay(10.0, 0.03, 0.0, 1.0), T)
    estimate = estimate_all(T, x=viscous.x)["log-decrement"]
    assert estimate.zeta.value == pytest.approx(0.03, abs=1e-10)
    assert estimate.omega_n.value == pytest.approx(10.0, abs=1e-8)
    assert estimate.x_k.value is None
    assert estimate_all(T, a=viscous.a)["log-decrement"].zeta.value == pytest.approx(0.03, abs=1e-9)
    coulomb = free_decay(Decay(10.0, 0.0, 0.03, 1.0), T)
    for found in (estimate_all(T, x=coulomb.x), estimate_all(T, a=coulomb.a)):
        estimate = found["constant-decrement"]
        assert estimate.x_k.value == pytest.approx(0.03, abs=1e-9)
        assert estimate.zeta.value is None
        assert "no viscous" in str(estimate.zeta.why)


@pytest.mark.parametrize("seed", range(12, 40, 3))
def test_a_hand_that_trembles_before_the_release_turns_nothing_round(seed: int) -> None:
    """Nor does a sensor after the stop: of 200 holds 32 had been given turning points, and 13 no decay."""
    rng = np.random.default_rng(seed)
    t, held = 0.03 * np.arange(500.0), 0.03 * float(rng.integers(15, 60))
    x, _ = _late(held, t / 1.6)
    slow = 0.0
    for i, one in enumerate(rng.standard_normal(t.size)):
        slow = 0.6 * slow + one
        x[i] += 0.003 * slow
    rows = estimate_all(t, x=x)["displacement"].per_reversal
    # half-cycles of the paper's case from its release on
    after = (rows[0].t - 1.6 * held) / (1.6 * CLEAN_HALF)
    assert 0.5 < after < 4.5
    assert after == pytest.approx(round(after), abs=0.1)


@pytest.mark.parametrize("lag", [0.0, 0.0216, -0.01])
def test_sensor_phase_is_found_and_does_not_touch_the_rest(lag: float) -> None:
    x, _ = _late(0.5 + lag, T)
    _, a = _late(0.5, T)
    found = estimate_all(T, x=x + _noise(T.size, 1e-3), a=a + _noise(T.size, 0.3, 9))
    assert found.sensor_phase.value is not None
    assert found.sensor_phase.stderr is not None
    omega_d = 10.0 * np.sqrt(1.0 - 0.05**2)
    assert abs(found.sensor_phase.value - omega_d * lag) < 4.0 * found.sensor_phase.stderr
    assert found.sensor_phase.stderr < 2e-3
    for method in ("acceleration", "displacement"):
        _close(found, method, 0.03, 0.05)


SITUATIONS = {
    "held before, rest after": (np.arange(0.0, 8.0, 2e-3), 2.0),
    "begins in motion": (np.arange(0.0, 3.0, 2e-3), -0.2),
    "irregular": (np.sort(np.random.default_rng(1).uniform(0.0, 3.5, 2500)), 0.3),
    "gaps": (np.delete(np.arange(0.0, 3.5, 1e-3), np.r_[500:590, 1500:1560]), 0.1),
}


@pytest.mark.parametrize("name", list(SITUATIONS))
def test_situations(name: str) -> None:
    t, start = SITUATIONS[name]
    x, a = _late(start, t)
    _close(estimate_all(t, x=x, a=a), "acceleration", 0.03, 0.05)
    noisy = estimate_all(t, x=x + _noise(t.size, 1e-3), a=a + _noise(t.size, 0.5, 6))
    for method in ("acceleration", "displacement"):
        _close(noisy, method, 0.03, 0.05)


def test_quantised_displacement() -> None:
    step = 0.0015
    found = estimate_all(T, x=np.round(CLEAN.x / step) * step)
    _close(found, "displacement", 0.03, 0.05)
    assert found.noise["x"].step == pytest.approx(step, rel=1e-6)


def test_turning_points_are_the_same_from_the_acceleration() -> None:
    viscous = free_decay(Decay(10.0, 0.03, 0.0, 1.0), T)
    by_x, by_a = (estimate_all(T, **{c: getattr(viscous, c)})["log-decrement"].per_reversal for c in ("x", "a"))
    at = {round(row.t, 6): row.x for row in by_x}
    assert len(by_a) > 5
    assert [row.x for row in by_a] == pytest.approx([at[round(row.t, 6)] for row in by_a], abs=1e-9)


def test_an_offset_leaves_the_figures_of_each_reversal() -> None:
    rows = estimate_all(T, x=CLEAN.x + 0.2)["displacement"].per_reversal
    assert [row.x_k for row in rows[:4]] == pytest.approx([0.03] * 4, abs=1e-9)


def test_the_error_of_one_jump_is_of_the_size_of_its_errors() -> None:
    rows = estimate_all(T, a=CLEAN.a + _noise(T.size, 0.5))["acceleration"].per_reversal
    off = [(row.x_k - 0.03) / row.stderr for row in rows if row.x_k is not None and row.stderr is not None]
    assert len(off) > 5
    assert 0.5 < math.sqrt(np.mean(np.square(off))) < 2.0


def test_offset_and_bias_are_found() -> None:
    _close(estimate_all(T, x=CLEAN.x + 0.2 + _noise(T.size, 1e-3)), "displacement", 0.03, 0.05)
    _close(estimate_all(T, a=CLEAN.a + 3.0 + _noise(T.size, 0.5)), "acceleration", 0.03, 0.05)


def test_a_first_period_spoiled_by_hand_is_left_out() -> None:
    a = CLEAN.a * np.clip(T / 0.1, 0.0, 1.0) + _noise(T.size, 0.5)
    found = estimate_all(T, a=a)
    _close(found, "acceleration", 0.03, 0.05)
    assert any("first period was skipped" in said for said in found.warnings)
    _close(estimate_all(T, a=a, drop_first=True), "acceleration", 0.03, 0.05)


def test_other_physics_is_said() -> None:
    wobble = 1.0 + 0.4 * np.cos(7.0 * T)
    found = estimate_all(T, a=CLEAN.a * wobble + _noise(T.size, 0.2))
    assert any("unexplained" in said for said in found.warnings)


def test_methods_and_reasons_when_channels_are_missing() -> None:
    x_only = estimate_all(T, x=CLEAN.x)
    assert set(x_only.methods) == set(METHODS)
    assert "only the displacement was given" in str(x_only["acceleration"].x_k.why)
    assert x_only.sensor_phase.value is None
    v_only = estimate_all(T, v=CLEAN.v)
    assert v_only["acceleration"].x_k.value == pytest.approx(0.03, rel=1e-6)
    assert "samples of the acceleration" in str(v_only["acceleration-local"].x_k.why)


SINE = np.sin(10.0 * T)
REFUSED = {
    "two half-cycles": (free_decay(Decay(10.0, 0.05, 0.3, 1.0), T).x, "no free decay"),
    "overdamped": (free_decay(Decay(10.0, 1.2, 0.03, 1.0), T).x, "no free decay"),
    "noise": (_noise(T.size, 1.0), "no oscillation stands above the noise"),
    "constant": (np.ones(T.size), "constant"),
    "ramp": (T.copy(), "no free decay"),
    "growing": (SINE * np.exp(0.3 * T), "grows"),
    "to and fro": (np.clip(3.0 * np.sin(6.0 * T), -1.0, 1.0), "driven"),
}


@pytest.mark.parametrize("name", list(REFUSED))
def test_no_free_decay_is_refused_with_the_reason(name: str) -> None:
    x, reason = REFUSED[name]
    found = estimate_all(T, x=x)
    for method in METHODS:
        assert found[method].x_k.value is None
    assert reason in str(found["displacement"].x_k.why)


def test_a_force_is_no_free_decay() -> None:
    found = estimate_all(T, x=CLEAN.x, u=np.sin(T))
    assert all("no free decay" in str(found[method].zeta.why) for method in METHODS)


BAD = [
    (T, {}, "none of x, v, a"),
    (T[:5], {"x": T[:5]}, "5 samples"),
    (T, {"x": T[:-1]}, "shape"),
    (T[::-1].copy(), {"x": T}, "does not come after"),
    (T, {"a": np.where(T > 1.0, np.nan, 0.0)}, "nan"),
]


@pytest.mark.parametrize(("t", "channels", "message"), BAD)
def test_bad_input(t: FloatArray, channels: dict[str, FloatArray], message: str) -> None:
    with pytest.raises(InputError, match=message):
        estimate_all(t, channels.get("x"), a=channels.get("a"))


def _oddity(rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Something a recorder may write: walks, steps, chirps, sines, spikes, decays, scaled, shifted, noisy, rounded."""
    n = int(rng.integers(16, 1500))
    t = np.asarray(np.arange(n) * 10.0 ** rng.uniform(-5.0, 0.0), dtype=np.float64)
    s = t / t[-1]
    shapes = (
        np.cumsum(rng.standard_normal(n)),
        np.sign(np.sin(s * rng.uniform(1.0, 200.0))),
        np.sin(s * rng.uniform(1.0, 200.0)) * np.exp(-s * rng.uniform(-2.0, 5.0)),
        np.where(s > 0.5, 1.0, 0.0),
        np.where(np.arange(n) == n // 2, 1.0, 0.0),
        np.sin(5.0 * s + 50.0 * s * s),
        free_decay(Decay(rng.uniform(5.0, 200.0) / t[-1], rng.uniform(0.0, 1.5), rng.uniform(0.0, 0.2)), t).x,
    )
    y = shapes[rng.integers(len(shapes))] * 10.0 ** rng.uniform(-9.0, 9.0) + rng.choice([0.0, 1e3])
    if rng.random() < 0.4:
        y = y + rng.standard_normal(n) * np.ptp(y) * 10.0 ** rng.uniform(-6.0, 0.0)
    if rng.random() < 0.3:
        step = np.ptp(y) * 10.0 ** rng.uniform(-4.0, -0.5) + 1e-300
        y = np.round(y / step) * step
    return t, np.asarray(y, dtype=np.float64)


def test_anything_gets_figures_or_reasons() -> None:
    rng = np.random.default_rng(12)
    for _ in range(100):
        t, y = _oddity(rng)
        x, a = ((y, None), (None, y), (y, -y))[rng.integers(3)]
        found = estimate_all(t, x=x, a=a)
        assert set(found.methods) == set(METHODS)
