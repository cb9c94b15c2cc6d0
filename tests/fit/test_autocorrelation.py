"""Integrated autocorrelation time against its closed form, and a series that is too short to tell."""

import numpy as np
import pytest
from scipy.signal import lfilter

from harness.core.arrays import FloatArray
from harness.estimate.noise import Noise
from harness.fit.series import lagged, memory


def coloured(phi: float, size: int, seed: int = 2) -> FloatArray:
    fresh = np.random.default_rng(seed).standard_normal(size)
    return np.asarray(lfilter([1.0], [1.0, -phi], fresh), dtype=np.float64)


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.8, 0.95])
def test_memory_of_first_order_noise_is_its_closed_form(phi: float) -> None:
    exact = (1.0 + phi) / (1.0 - phi)
    found = memory(coloured(phi, 100_000))
    assert found.time == pytest.approx(exact, rel=0.1)
    assert found.independent == pytest.approx(100_000 / exact, rel=0.1)
    assert not found.too_short


def test_a_series_of_few_memories_says_that_it_is_too_short() -> None:
    assert memory(coloured(0.99, 2000)).too_short
    assert memory(np.sin(np.linspace(0.0, 3.0, 1000))).too_short
    assert memory(np.zeros(100)).time == 1.0


@pytest.mark.parametrize("phi", [-0.4, 0.0, 0.7])
def test_whitened_noise_is_white_and_of_unit_size(phi: float) -> None:
    noise = Noise(0.3, True, phi)
    white = noise.whitened(noise.drawn(50_000, np.random.default_rng(1)))
    assert np.std(white) == pytest.approx(1.0, rel=0.02)
    assert float(white[1:] @ white[:-1]) / white.size == pytest.approx(0.0, abs=0.02)
    columns = np.column_stack([white, 2.0 * white])
    assert noise.whitened(columns)[:, 1] == pytest.approx(2.0 * noise.whitened(white))


def test_lags_are_sums_of_products_without_the_end_meeting_the_beginning() -> None:
    series = coloured(0.5, 40)
    direct = [float(series[: 40 - lag] @ series[lag:]) for lag in range(40)]
    assert lagged(series, 40) == pytest.approx(direct, abs=1e-12)
    assert lagged(series, 60)[40:] == pytest.approx(0.0, abs=1e-12)
