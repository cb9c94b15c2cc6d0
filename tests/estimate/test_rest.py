"""A noisy force where its slider rests: as well known as all samples of the rest together say, and no less."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.core.arrays import FloatArray
from harness.estimate.noise import channel_noise
from harness.estimate.rest import quiet_at_rest

N, STEP, NOISE = 900, 0.02, 0.03
REST = slice(300, 600)
T: FloatArray = np.arange(float(N)) * STEP


def moved() -> FloatArray:
    """A position (N,), m, by an encoder of 1e-3 m, that goes, rests, and goes on."""
    x = np.where(T < 6.0, np.sin(T * math.pi / 12.0), np.where(T < 12.0, 1.0, np.cos((T - 12.0) * math.pi / 6.0)))
    return np.round(x / 1e-3) * 1e-3


def quiet(force: FloatArray, seed: int) -> tuple[FloatArray, FloatArray]:
    """What is taken for a force, less that force, and the recorded one less it, both (N,)."""
    t, x = T, moved()
    u = force + NOISE * np.random.default_rng(seed).standard_normal(N)
    found = quiet_at_rest(t, x, u, channel_noise(t, x), channel_noise(t, u, rests=True), 1.0)
    return found - force, u - force


@given(seed=st.integers(0, 10_000), level=st.floats(-2.0, 2.0), slope=st.floats(-0.3, 0.3))
def test_at_rest_a_line_is_known_to_what_its_samples_tell(seed: int, level: float, slope: float) -> None:
    left, _ = quiet(np.sin(T) * (T < 6.0) + (level + slope * (T - 9.0)) * ((T >= 6.0) & (T < 12.0)), seed)
    # two numbers of 300 samples: an error of .082 noises on average, four times that at most
    inner = left[REST][20:-20]
    assert math.sqrt(float(np.mean(inner**2))) < 4.0 * NOISE * math.sqrt(2.0 / 300.0)


@given(seed=st.integers(0, 10_000), when=st.integers(350, 550))
def test_a_jump_at_rest_stays_one(seed: int, when: int) -> None:
    force = np.where(np.arange(N) < when, -1.0, 1.0)
    left, _ = quiet(force, seed)
    assert np.max(np.abs(left[when - 40 : when + 40])) < 5.0 * NOISE


@pytest.mark.parametrize("seed", range(3))
def test_a_force_that_moves_something_is_left_as_it_is(seed: int) -> None:
    left, recorded = quiet(np.sin(np.arange(N) * 0.05), seed)
    away = np.r_[0:200, 640:840]
    assert np.array_equal(left[away], recorded[away])
