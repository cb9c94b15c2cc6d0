"""A sensor that hangs on the bench says nothing of friction, however its noise looks."""

import numpy as np
import pytest

import harness
from harness.core.errors import InputError

N = 400
T = np.arange(N) / 100.0


def bench(kind: str, random: np.random.Generator) -> np.ndarray:
    """A slider at rest as a sensor shows it, 1 mm rms."""
    white = 1e-3 * random.standard_normal(N)
    if kind == "coloured":
        for i in range(1, N):
            white[i] += 0.8 * white[i - 1]
    if kind == "wandering":
        white = white + np.cumsum(3e-4 * random.standard_normal(N))
    if kind == "moved once":
        white = white + np.where(T < 1.7, 0.0, 0.02)
    return 0.1 + white


@pytest.mark.parametrize("kind", ["white", "coloured", "wandering", "moved once"])
def test_noise_about_a_level_is_no_swing(kind: str) -> None:
    x = bench(kind, np.random.default_rng(0))
    with pytest.raises(InputError, match=r"bench: no free decay|half-cycle"):
        harness.diagnose(harness.Recording(T, {"x": x}, "bench"), engines=())


def test_a_swing_under_noise_as_large_is_a_motion() -> None:
    t = np.arange(3000) / 100.0
    x = np.exp(-0.05 * t) * np.cos(9.0 * t) + 0.5 * np.random.default_rng(1).standard_normal(t.size)
    assert harness.diagnose(harness.Recording(t, {"x": x}), engines=()).verdict == "adequate"
