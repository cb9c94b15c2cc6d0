"""Cubics as wide as the motion lets each of them be: where a slider stops a wide one rounds off what it does."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.core.arrays import FloatArray
from harness.diagnosis.smoothed_state.local_cubics import longest_interval, smoothed

_SIGMA = 3e-6


def _there_and_back(t: FloatArray) -> FloatArray:
    """10 mm/s one way and the other, a second each, with .2 s at rest between; no time is lost in stopping."""
    v = np.where(t % 1.2 < 1.0, 0.01, 0.0) * np.where(t // 1.2 % 2 < 1, 1.0, -1.0)
    return np.concatenate(([0.0], np.cumsum(v[:-1] * np.diff(t))))


def _noisy(x: FloatArray, seed: int) -> FloatArray:
    return np.asarray(x + _SIGMA * np.random.default_rng(seed).standard_normal(x.size), dtype=np.float64)


def test_a_stop_is_not_rounded_off() -> None:
    t: FloatArray = np.arange(4000.0) * 5e-3
    x = _there_and_back(t)
    longest, y = longest_interval(t), _noisy(x, 1)
    wide, fitting = (smoothed(t, y, longest, _SIGMA, 1.05, everywhere=each) for each in (False, True))
    stops = np.flatnonzero(np.abs(np.diff(x, 2)) > 1e-9) + 1
    beside = np.unique(np.clip(stops[:, None] + np.arange(-15, 16), 0, t.size - 1))
    assert np.min(wide.half) == np.max(wide.half) == np.max(fitting.half)
    assert np.max(np.abs(wide.value - x)) > 20.0 * _SIGMA
    # nine samples, the fewest, still see a corner as a cubic
    assert np.max(np.abs(fitting.value - x)) < 9.0 * _SIGMA
    rounded, kept = (np.sqrt(np.mean((one.value - x)[beside] ** 2)) for one in (wide, fitting))
    assert kept < 0.25 * rounded
    # in the middle of a run, and of a rest, it is as wide as ever
    assert np.mean(fitting.half == np.max(wide.half)) > 0.4


@given(seed=st.integers(0, 10_000), omega=st.floats(2.0, 8.0))
@settings(max_examples=20, deadline=None)
def test_a_motion_that_never_stops_is_smoothed_as_ever(seed: int, omega: float) -> None:
    t: FloatArray = np.arange(2000.0) * 2e-3
    y = _noisy(0.01 * np.sin(omega * t), seed)
    wide, fitting = (smoothed(t, y, longest_interval(t), _SIGMA, 1.05, everywhere=each) for each in (False, True))
    # one window in 100,000 leaves so much by chance, and draws its neighbours along
    assert np.mean(fitting.half < wide.half) < 0.05
    same = fitting.half == wide.half
    assert fitting.value[same] == pytest.approx(wide.value[same], abs=0.0)
    assert np.max(np.abs(np.diff(fitting.half))) <= 1
