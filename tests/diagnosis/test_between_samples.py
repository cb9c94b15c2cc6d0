"""A force between its samples: straight, smooth, or with a kink wherever a loop's slider turns."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import cumulative_trapezoid

from harness.core.arrays import FloatArray
from harness.diagnosis.prepare.intersample_curve import between_samples, curve, kinks_of


def test_smooth_force_is_followed_smoothly_and_noise_straight() -> None:
    t = np.arange(400) / 50.0
    fine = np.linspace(0.0, t[-1], 3000)
    smooth = between_samples(t, np.sin(6.0 * t))
    missed = np.max(np.abs(np.interp(fine, smooth.t, smooth.u) - np.sin(6.0 * fine)))
    assert missed < 0.2 * np.max(np.abs(np.interp(fine, t, np.sin(6.0 * t)) - np.sin(6.0 * fine)))
    assert between_samples(t, np.random.default_rng(0).standard_normal(t.size)).t.size == t.size


def test_momentum_of_a_smooth_force_is_kept_to_the_fourth_order() -> None:
    missed = []
    for n in (50, 100, 200):
        t = np.linspace(0.0, 4.0, n + 1)
        assert kinks_of(t, np.sin(6.0 * t)).t.size == 0
        drive = curve(t, np.sin(6.0 * t))
        momentum = cumulative_trapezoid(drive.u, drive.t, initial=0.0)
        missed.append(float(np.abs(momentum - (1.0 - np.cos(6.0 * drive.t)) / 6.0).max()))
    assert missed[0] / missed[1] > 14.0
    assert missed[1] / missed[2] > 14.0


def _after_turns(t: FloatArray, turns: FloatArray) -> FloatArray:
    """A slow force whose slope jumps at turns (s) and fades back, as a loop's does."""
    force = np.sin(1.3 * t) + 0.2 * t**2
    for i, turn in enumerate(turns):
        since = np.maximum(t - turn, 0.0)
        force += (-1.0) ** i * 3.0 * since * np.exp(-since / 0.08)
    return force


@given(shift=st.floats(0.0, 1.0, exclude_max=True), gap=st.floats(0.45, 0.9))
@settings(max_examples=40, deadline=None)
def test_kinks_between_samples_are_found_and_the_momentum_is_kept(shift: float, gap: float) -> None:
    step = 0.02
    t: FloatArray = np.arange(400.0) * step
    turns = np.arange(1.0 + shift * step, 7.0, gap)
    drive = between_samples(t, _after_turns(t, turns))
    fine = np.linspace(t[0], t[-1], 400_001)
    truth = _after_turns(fine, turns)
    kinks = kinks_of(t, _after_turns(t, turns))
    assert kinks.t.size == turns.size
    assert kinks.t == pytest.approx(turns, abs=0.05 * step)
    # a straight line over a kink in its middle misses 3 step^2 / 8, of one sign after the other
    lost = np.abs(np.cumsum(np.interp(fine, drive.t, drive.u) - truth)).max() * fine[1]
    assert lost < 0.02 * turns.size * 3.0 * step**2 / 8.0
