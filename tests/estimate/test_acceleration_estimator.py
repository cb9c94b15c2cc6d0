"""Method acceleration: exact without noise, at the Cramer-Rao bound with it."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.arrays import FloatArray
from harness.estimate.acceleration import Jumps, combine
from harness.estimate.every import estimate_all
from harness.exact.decay import Decay, free_decay


def half_cycles(decay: Decay) -> int:
    """Half-cycles until it sticks, at most 400 (Liang, eq. 6)."""
    q = math.exp(-math.pi * decay.zeta / math.sqrt(1.0 - decay.zeta**2))
    size, count = abs(decay.x0), 0
    while size > decay.x_k and count < 400:
        size = q * size - (1.0 + q) * decay.x_k
        count += 1
    return count


def half_time(decay: Decay) -> float:
    return math.pi / (decay.omega_n * math.sqrt(1.0 - decay.zeta**2))


def _acceleration(t: FloatArray, p: FloatArray) -> FloatArray:
    """a of a decay whose release is at p[4], dealt to half-cycles by p itself, written afresh from eqs. 3, 5 and 6."""
    omega_n, zeta, x_k, start, begin = p
    omega, beta = omega_n * math.sqrt(1.0 - zeta**2), zeta / math.sqrt(1.0 - zeta**2)
    k = np.floor((t - begin) * omega / math.pi).astype(int)
    turning = [start]
    for _ in range(int(k.max()) + 1):
        turning.append(
            -math.exp(-beta * math.pi) * turning[-1] + (1 + math.exp(-beta * math.pi)) * x_k * np.sign(turning[-1])
        )
    size = np.array(turning)[k]
    s = t - begin - k * math.pi / omega
    swing = size - np.sign(size) * x_k
    form = np.cos(omega * s) - beta * np.sin(omega * s)
    return np.asarray(-(omega_n**2) * swing * np.exp(-zeta * omega_n * s) * form, dtype=np.float64)


def cramer_rao(decay: Decay, t: FloatArray, sigma: float) -> FloatArray:
    """Least standard errors of (omega_n, zeta, x_k) from a at t with white noise sigma; X_0 and t_0 unknown too.

    Central differences of the closed form; samples at a reversal itself (within 1e-6 of a half-cycle) are left out.
    """
    p = np.array([decay.omega_n, decay.zeta, decay.x_k, decay.x0, 0.0])
    step = np.array([1e-7 * decay.omega_n, 1e-7, 1e-7 * abs(decay.x0), 1e-7 * abs(decay.x0), 1e-7 * half_time(decay)])
    place = t / half_time(decay)
    inside = (place < half_cycles(decay)) & (np.abs(place - np.round(place)) > 1e-4 * (1.0 + place))
    slope = np.stack(
        [(_acceleration(t[inside], p + e) - _acceleration(t[inside], p - e)) / (2.0 * e.max()) for e in np.diag(step)],
        axis=1,
    )
    scale = np.linalg.norm(slope, axis=0)
    covariance = np.linalg.inv((slope / scale).T @ (slope / scale)) / np.outer(scale, scale) * sigma**2
    return np.asarray(np.sqrt(np.diag(covariance)[:3]), dtype=np.float64)


@dataclass(frozen=True)
class Draw:
    """One random recording: the decay, its samples of a, their noise, and the bound of (omega_n, zeta, x_k)."""

    decay: Decay
    t: FloatArray
    a: FloatArray
    sigma: float
    bound: FloatArray


def draw(rng: np.random.Generator) -> Draw:
    """Four half-cycles or more, 40 to 400 samples a period, x_k at least three standard errors of the bound."""
    while True:
        omega_n, zeta = math.exp(rng.uniform(math.log(2.0), math.log(60.0))), rng.uniform(0.0, 0.15)
        decay = Decay(omega_n, zeta, math.exp(rng.uniform(math.log(1e-3), math.log(0.12))), rng.choice([-1.0, 1.0]))
        count = half_cycles(decay)
        if count < 4:
            continue
        shown = min(count, int(rng.integers(4, 41))) * rng.choice([1.0, rng.uniform(1.0, 2.0)])
        interval = 2.0 * half_time(decay) / math.exp(rng.uniform(math.log(40.0), math.log(400.0)))
        t = np.arange(0.0, shown * half_time(decay), interval)
        unit = cramer_rao(decay, t, 1.0)
        sigma = decay.x_k / 3.0 / unit[2] * 10.0 ** rng.uniform(-3.0, 0.0)
        a = free_decay(decay, t).a + sigma * rng.standard_normal(t.size)
        return Draw(decay, t, a, sigma, unit * sigma)


@given(
    omega_n=st.floats(0.5, 200.0),
    zeta=st.floats(0.0, 0.2),
    x_k=st.floats(0.0, 0.1),
    start=st.sampled_from([1.0, -1.0, 2.5]),
    per_period=st.floats(40.0, 700.0),
    channel=st.sampled_from(["a", "v"]),
)
def test_exact_without_noise(
    omega_n: float, zeta: float, x_k: float, start: float, per_period: float, channel: str
) -> None:
    decay = Decay(omega_n, zeta, x_k * abs(start), start)
    count = half_cycles(decay)
    if count < 3:
        return
    t = np.arange(0.0, min(count + 2, 14) * half_time(decay), 2.0 * half_time(decay) / per_period)
    motion = free_decay(decay, t)
    found = estimate_all(t, a=motion.a) if channel == "a" else estimate_all(t, v=motion.v)
    estimate = found["acceleration"]
    assert estimate.x_k.value == pytest.approx(decay.x_k, rel=1e-6, abs=1e-8 * abs(start))
    assert estimate.zeta.value == pytest.approx(zeta, rel=1e-6, abs=1e-8)
    assert estimate.omega_n.value == pytest.approx(omega_n, rel=1e-6)
    assert estimate.reversals == len(estimate.per_reversal)


def test_figures_of_each_reversal_are_those_of_the_exact_decay() -> None:
    decay = Decay(10.0, 0.05, 0.03, 1.0)
    t = np.arange(0.0, 3.0, 0.0131)
    motion = free_decay(decay, t)
    rows = estimate_all(t, a=motion.a)["acceleration"].per_reversal
    events = motion.events
    assert len(rows) == 7
    for i, row in enumerate(rows):
        assert row.t == pytest.approx(events.t[i], abs=1e-9)
        assert row.x == pytest.approx(events.x[i], abs=1e-9)
        assert row.a_before == pytest.approx(events.a_before[i], abs=1e-7)
        assert row.a_after == pytest.approx(events.a_after[i], abs=1e-7)
        assert row.x_k == pytest.approx(0.03, abs=1e-9)


def _errors(count: int, seed: int) -> tuple[FloatArray, FloatArray]:
    """Errors over the bound, and errors over the stated standard errors, of (omega_n, zeta, x_k)."""
    rng = np.random.default_rng(seed)
    over_bound, over_stated = [], []
    for _ in range(count):
        case = draw(rng)
        estimate = estimate_all(case.t, a=case.a)["acceleration"]
        truth = (case.decay.omega_n, case.decay.zeta, case.decay.x_k)
        error, stated = [], []
        for figure, true in zip((estimate.omega_n, estimate.zeta, estimate.x_k), truth, strict=True):
            assert figure.value is not None, figure.why
            assert figure.stderr is not None
            error.append(figure.value - true)
            stated.append(figure.stderr)
        over_bound.append(np.array(error) / case.bound)
        over_stated.append(np.array(error) / np.array(stated))
    return np.array(over_bound), np.array(over_stated)


@pytest.mark.parametrize(("count", "seed"), [(120, 11), pytest.param(500, 5, marks=pytest.mark.full)])
def test_within_one_and_a_half_of_the_cramer_rao_bound(count: int, seed: int) -> None:
    over_bound, over_stated = _errors(count, seed)
    rms = np.sqrt(np.mean(over_bound**2, axis=0))
    assert np.all(rms < 1.5), rms
    # no cheating by luck: an efficient estimator cannot be far below the bound either
    assert np.all(rms > 0.7), rms
    covered = np.mean(np.abs(over_stated) < 2.0, axis=0)
    assert np.all((covered > 0.90) & (covered < 0.995)), covered


def test_jumps_are_combined_by_their_full_covariance() -> None:
    rng = np.random.default_rng(3)
    n = 29
    diagonal, beside = rng.uniform(1.0, 2.0, n), rng.uniform(-0.5, 0.5, n - 1)
    covariance = np.diag(diagonal) + np.diag(beside, 1) + np.diag(beside, -1)
    size, zero = rng.normal(6.0, 1.0, n), np.zeros(n)
    found = combine(Jumps(zero, zero, zero, size, diagonal, beside, rng.normal(size=(n, 2)), zero), 0.25)
    inverse = np.linalg.inv(covariance)
    assert found.size == pytest.approx(float(np.sum(inverse @ size) / np.sum(inverse)), rel=1e-12)
    assert found.variance == pytest.approx(0.25 / float(np.sum(inverse)), rel=1e-12)
    left = size - found.size
    assert found.scatter == pytest.approx(float(left @ inverse @ left) / (n - 1) / 0.25, rel=1e-10)


def _first_order(n: int, phi: float, rng: np.random.Generator) -> FloatArray:
    out = rng.standard_normal(n)
    for i in range(1, n):
        out[i] = phi * out[i - 1] + math.sqrt(1.0 - phi * phi) * out[i]
    return out


def test_standard_errors_hold_in_coloured_noise() -> None:
    decay = Decay(10.0, 0.05, 0.03, 1.0)
    t = np.arange(0.0, 2.7, 2e-3)
    clean = free_decay(decay, t).a
    rng = np.random.default_rng(8)
    ratio = []
    for _ in range(60):
        estimate = estimate_all(t, a=clean + 0.5 * _first_order(t.size, 0.8, rng))["acceleration"]
        assert estimate.x_k.value is not None
        assert estimate.x_k.stderr is not None
        ratio.append((estimate.x_k.value - 0.03) / estimate.x_k.stderr)
    assert 0.6 < np.std(ratio) < 1.4
