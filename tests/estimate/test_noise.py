"""The noise of a channel is found for what it is."""

import numpy as np
import pytest
from scipy.signal import lfilter

from harness.core.arrays import FloatArray
from harness.estimate.noise import FLOOR, channel_noise, quantisation_step
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


def test_coarse_quantisation_is_at_least_a_uniform_error() -> None:
    x = np.round(free_decay(DECAY, T).x / 0.05) * 0.05
    assert channel_noise(T, x, PERIOD).sigma >= 0.05 / np.sqrt(12.0)
