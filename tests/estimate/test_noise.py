"""Noise of a channel, of samples that repeat, and of a motion that is nearly undamped."""

import numpy as np
import pytest
from scipy.signal import lfilter

from harness.core.arrays import FloatArray
from harness.estimate.every import METHODS, estimate_all
from harness.estimate.noise import FLOOR, channel_noise, fine_noise, quantisation_step, white_at_most, with_colour
from harness.estimate.repeated import repeated
from harness.exact.decay import Decay, free_decay

DECAY = Decay(10.0, 0.05, 0.03, 1.0)
T = np.arange(0.0, 5.0, 1e-3)
PERIOD = 2.0 * np.pi / 10.0


def _coloured(phi: float, sigma: float, seed: int = 2) -> FloatArray:
    white = np.random.default_rng(seed).standard_normal(T.size) * sigma * np.sqrt(1.0 - phi * phi)
    return np.asarray(lfilter([1.0], [1.0, -phi], white), dtype=np.float64)


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.8])
@pytest.mark.parametrize("channel", ["x", "a"])
def test_level_and_colour(phi: float, channel: str) -> None:
    clean = getattr(free_decay(DECAY, T), channel)
    sigma = 1e-3 * np.ptp(clean)
    noise = channel_noise(T, clean + _coloured(phi, sigma), PERIOD)
    assert noise.found
    assert noise.sigma == pytest.approx(sigma, rel=0.15)
    assert noise.phi == pytest.approx(phi, abs=0.12)


@pytest.mark.parametrize("per_period", [40, 100, 1000])
@pytest.mark.parametrize("channel", ["x", "v", "a"])
def test_none_found_in_a_clean_trace_whatever_its_curvature(per_period: int, channel: str) -> None:
    t = np.arange(0.0, 2.4, PERIOD / per_period)
    y = getattr(free_decay(DECAY, t), channel)
    noise = channel_noise(t, y, PERIOD)
    assert not noise.found
    assert noise.said == "none found"
    assert noise.sigma == pytest.approx(FLOOR * np.std(y))


def test_a_silent_rest_does_not_hide_quantisation() -> None:
    step = 0.0015
    x = np.round(free_decay(DECAY, T).x / step) * step
    noise = channel_noise(T, x, PERIOD)
    assert quantisation_step(x) == pytest.approx(step, rel=1e-9)
    assert noise.sigma >= step / np.sqrt(12.0)
    assert noise.sigma == pytest.approx(step / np.sqrt(12.0), rel=0.2)


@pytest.mark.parametrize(("spread", "count"), [(0.0, 3), (0.0, 5), (1.0, 5), (5.0, 20)])
def test_the_spread_is_told_from_the_error_and_two_errors_mean_95_percent(spread: float, count: int) -> None:
    rng = np.random.default_rng(count)
    draws, inside, outliers, found = 400, 0, 0, []
    for _ in range(draws):
        errors = rng.uniform(0.5, 1.5, count)
        values = 7.0 + rng.normal(0.0, spread, count) + errors * rng.standard_normal(count)
        seen = repeated(values.tolist(), errors.tolist())
        inside += abs(seen.value - 7.0) < 2.0 * seen.stderr
        outliers += bool(seen.outliers)
        found.append(seen.between**2)
    assert inside / draws > 0.85  # few recordings tell the spread itself poorly
    assert outliers / draws < 0.08
    if spread > 0.0:
        assert np.mean(found) ** 0.5 == pytest.approx(spread, rel=0.25)


@pytest.mark.parametrize("at", [0, 2, 4])
def test_one_that_is_off_stands_out_and_the_others_do_not(at: int) -> None:
    values = [1.00, 1.01, 0.99, 1.005, 0.995]
    values[at] += 0.2
    assert repeated(values, [0.01] * 5).outliers == (at,)


OMEGA = 9.0


def swing(t: FloatArray, zeta: float, x_k: float) -> tuple[FloatArray, FloatArray]:
    """x and a of a release from 1 m, each half-cycle in closed form; x_k in m, far from sticking."""
    decay, omega = zeta * OMEGA, OMEGA * np.sqrt(1.0 - zeta**2)
    half = np.pi / omega
    q = np.exp(-decay * half)
    which = np.floor(t / half).astype(int)
    size = np.empty(which.max() + 1)
    size[0] = 1.0 - x_k
    for k in range(1, size.size):
        size[k] = q * size[k - 1] - 2.0 * x_k
    s, sign = t - which * half, np.where(which % 2 == 0, 1.0, -1.0)
    form = sign * size[which] * np.exp(-decay * s)
    x = sign * x_k + form * (np.cos(omega * s) + decay / omega * np.sin(omega * s))
    return x, -(OMEGA**2) * form * (np.cos(omega * s) - decay / omega * np.sin(omega * s))


@pytest.mark.parametrize("offset", [0.0, -0.7, 12.0])
@pytest.mark.parametrize("noise", [0.0, 1e-7, 1e-3])
@pytest.mark.parametrize(("zeta", "x_k"), [(0.0, 0.0), (1e-7, 0.0), (0.0, 1e-6), (3e-5, 2e-5), (4e-4, 0.0)])
def test_no_number_is_beyond_five_errors(zeta: float, x_k: float, noise: float, offset: float) -> None:
    t = np.linspace(0.0, 14.3, 1800)
    rng = np.random.default_rng(5)
    x, a = (y + noise * np.ptp(y) / 2.0 * rng.standard_normal(t.size) for y in swing(t, zeta, x_k))
    for size in (1e-9, 1.0, 1e9):
        found = estimate_all(t, size * (x + offset), a=size * a)
        for method in METHODS:
            if method == "acceleration-paper":
                continue  # as published: its errors know nothing of its bias
            one, true = found[method], {"omega_n": OMEGA, "zeta": zeta, "x_k": size * x_k}
            if (method == "log-decrement" and x_k > 0.0) or (method == "constant-decrement" and zeta > 0.0):
                continue  # each assumes the other away
            for name, value in true.items():
                number = getattr(one, name)
                if number.value is not None and number.stderr is not None:
                    assert abs(number.value - value) <= 5.0 * number.stderr, (method, name, size)
                    assert number.stderr > 0.0


def test_a_decay_that_cannot_be_seen_is_none() -> None:
    """An undamped swing off its zero: turning points alone part damping from friction no more than a constant does."""
    t = np.linspace(0.0, 14.3, 1800)
    found = estimate_all(t, swing(t, 0.0, 0.0)[0] - 0.7)["displacement"]
    assert (found.zeta.value, found.x_k.value) == (0.0, 0.0)
    assert "no decay" in found.notes[0]


def test_a_white_noise_is_bounded_where_a_spectrum_is_quiet() -> None:
    t = np.arange(4000.0)
    fast = np.sum([np.sin(2.0 * np.pi * f * t + 9.0 * f) for f in np.linspace(0.01, 0.3, 40)], axis=0)
    noise = 0.02 * np.random.default_rng(3).standard_normal(t.size)
    assert white_at_most(noise) == pytest.approx(0.02, rel=0.1)
    assert white_at_most(fast + noise) == pytest.approx(0.02, rel=0.1)
    assert white_at_most(fast) < 1e-3


@pytest.mark.parametrize("phi", [0.0, 0.45, 0.6])
def test_colour_shows_without_a_period(phi: float) -> None:
    slow, noise = np.sin(1.3 * T) + 0.4 * np.abs(T - 2.0), _coloured(phi, 1e-3)
    found = with_colour(T, slow + noise, channel_noise(T, slow + noise))
    assert found.phi == pytest.approx(phi, abs=0.1)
    # below the frequencies that a motion has this is what counts: white noise of the fast part is up to ten times less
    assert found.of_means(20).sigma == pytest.approx(channel_noise(T, noise, PERIOD).of_means(20).sigma, rel=0.25)


def test_a_motion_is_no_colour() -> None:
    fast = np.sin(150.0 * T) + 1e-5 * _coloured(0.0, 1.0)
    white = channel_noise(T, fast)
    assert with_colour(T, fast, white) == white


@pytest.mark.parametrize("counts", [2e3, 2e4, 2e5])
def test_an_encoder_has_the_noise_of_its_counts(counts: float) -> None:
    # of which 2e5 over the way are below a hundred thousandth of its rms
    smooth = np.sin(2.0 * np.pi * 0.7 * T) + 0.4 * np.sin(2.0 * np.pi * 1.9 * T + 0.3)
    count = np.ptp(smooth) / counts
    noise = fine_noise(T, np.floor(smooth / count + 0.5) * count)
    assert noise.found
    # the less of two medians over 500 windows
    assert noise.sigma == pytest.approx(count / np.sqrt(12.0), rel=0.2)


@pytest.mark.parametrize("rate", [0.7, 7.0, 30.0])
def test_a_clean_signal_has_no_fine_noise(rate: float) -> None:
    noise = fine_noise(T, np.sin(2.0 * np.pi * rate * T))
    assert not noise.found
    assert noise.sigma == pytest.approx(FLOOR * np.sqrt(0.5), rel=0.01)
