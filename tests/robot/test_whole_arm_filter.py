"""The filter against closed forms, noise that is learnt against noise that was made, and the scale of evidence."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lfilter
from scipy.stats import chi2
from two_joint_arm import ARM

from harness.core.arrays import FloatArray
from harness.core.robot import JointLog
from harness.robot.arm import load_arm
from harness.robot.smooth import Band
from harness.robot.whole_arm.design import Noise, Stretches, evidence
from harness.robot.whole_arm.differentiate import differentiate

BAND = Band(15.0, 10_001, 1000.0)
T = np.arange(BAND.size) / BAND.rate


@pytest.mark.parametrize("hertz", [0.1, 0.7, 2.3])
def test_a_slow_sine_on_a_drift_and_its_derivatives_pass_unchanged(hertz: float) -> None:
    out = BAND.taken(45.0)
    turn, t = 2 * math.pi * hertz, np.arange(out.size) / out.rate
    found = BAND.filtered(np.sin(turn * T) + 0.4 * T, out, 2)
    exact = (np.sin(turn * t) + 0.4 * t, turn * np.cos(turn * t) + 0.4, -(turn**2) * np.sin(turn * t))
    for order in range(3):
        assert np.max(np.abs(found[order] - exact[order])[out.trimmed]) < 2e-3 * turn**order


def test_the_gain_is_a_half_at_the_lowpass_and_that_of_two_butterworths_elsewhere() -> None:
    found = BAND.filtered(np.sin(2 * math.pi * 15.0 * T + 0.3), BAND)[0]
    assert found[BAND.trimmed] == pytest.approx(0.5 * np.sin(2 * math.pi * 15.0 * T + 0.3)[BAND.trimmed], abs=2e-3)
    assert BAND.gain(np.array([30.0]))[0] == pytest.approx(1.0 / 257.0)


def test_a_series_moved_ahead_is_what_it_was_later() -> None:
    late = 0.0123
    moved = BAND.filtered(np.sin(2 * math.pi * 1.3 * (T - late)) + 0.2 * (T - late), BAND, late=late)[0]
    exact = np.sin(2 * math.pi * 1.3 * T) + 0.2 * T
    assert moved[BAND.trimmed] == pytest.approx(exact[BAND.trimmed], abs=1e-3)


def test_means_over_samples_of_a_jump_are_filtered_as_the_jump() -> None:
    coarse = BAND.taken(140.0)
    out = coarse.taken(45.0)
    jump = 5.0123
    sharp = BAND.filtered(np.clip((T - jump) * BAND.rate * 2.0, -1.0, 1.0), out)[0]
    t = np.arange(coarse.size) / coarse.rate
    values = np.clip((t - jump) * coarse.rate * 2.0, -1.0, 1.0)
    means, plain = (coarse.filtered(values, out, means=which)[0] for which in (True, False))
    # what folds back from beyond half the rate is (f / rate)^2 of a jump of two
    error = np.max(np.abs(sharp - means)[out.trimmed])
    assert error < 2.0 * (15.0 / coarse.rate) ** 2
    assert error < 0.5 * np.max(np.abs(sharp - plain)[out.trimmed])


def test_the_models_torque_is_that_which_the_filter_makes_of_the_recorded_one(tmp_path: Path) -> None:
    """Two joints that shake at 8 Hz on a slow way: products of their speeds lie far above the filter's 10 Hz."""
    (tmp_path / "arm.xml").write_text(ARM)
    model, t = load_arm(tmp_path / "arm.xml"), np.arange(0.0, 12.0, 0.002)
    turn, size, phase = np.array([[1.9, 50.0], [2.7, 47.0]]), np.array([[0.6, 0.01], [0.5, 0.015]]), (0.2, 1.1)
    angle = turn * t[:, None, None] + np.array(phase)
    waves = [size * one for one in (np.sin(angle), turn * np.cos(angle), -(turn**2) * np.sin(angle))]
    q, v, a = (np.sum(one, axis=2) for one in waves)
    torque = model.inverse(q, v, a)
    position, effort = (dict(zip(model.joints, one.T, strict=True)) for one in (q, torque))
    filtered = differentiate(JointLog(t, position, effort=effort), model, lowpass=10.0)
    rigid, of_motion = filtered.rigid(model), model.inverse(filtered.q, filtered.v, filtered.a)
    off, before = (np.std(one - filtered.torque, axis=0) for one in (rigid, of_motion))
    assert np.all(off < 0.005 * np.std(filtered.torque, axis=0))
    assert np.all(off < 0.3 * before)


def coloured(size: int, seed: int) -> FloatArray:
    fresh = np.random.default_rng(seed).standard_normal(size)
    return np.asarray(lfilter([1.0], [1.0, -1.2, 0.5], fresh), dtype=np.float64)


def test_noise_with_gaps_is_whitened_to_unit_size() -> None:
    kept = np.ones(6000, dtype=np.bool_)
    kept[np.arange(6000) % 300 < 40] = False
    # denser at higher frequencies, so that nothing is raised
    fresh = np.random.default_rng(2).standard_normal(6000)
    stretches, series = Stretches.of(kept), np.asarray(lfilter([1.0], [1.0, 0.5], fresh))
    white = Noise.learnt(series, stretches, 0).whitening(stretches).of(series)
    assert white.size == np.sum(kept)
    assert np.std(white) == pytest.approx(1.0, abs=0.03)
    assert abs(np.mean(white[1:] * white[:-1])) < 0.05


@given(st.integers(0, 50))
def test_noise_is_never_taken_for_less_than_half_of_what_it_is_at_lower_frequencies(seed: int) -> None:
    series = coloured(800, seed)
    noise = Noise.learnt(series, Stretches.of(np.ones(800, dtype=np.bool_)), 0)
    turn = np.exp(-1j * np.linspace(0.0, math.pi, 200))
    density = (noise.sigma[-1] / np.abs(np.polyval(noise.predictors[-1][::-1], turn))) ** 2
    assert np.all(density > 0.3 * np.maximum.accumulate(density))


@given(st.floats(1.0, 900.0), st.integers(1, 8))
def test_evidence_is_the_gain_of_one_column_that_is_as_unlikely(gain: float, columns: int) -> None:
    assert evidence(gain, 1) == pytest.approx(gain, rel=1e-4)
    assert evidence(gain, columns) <= gain * (1 + 1e-4)
    if gain < 500.0:
        assert chi2.logsf(evidence(gain, columns), 1) == pytest.approx(chi2.logsf(gain, columns), rel=1e-3, abs=1e-6)
    assert evidence(gain, columns, 30.0) <= evidence(gain, columns)
