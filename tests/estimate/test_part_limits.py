"""Known answers of the estimators' parts where they meet a limit: units, colours of noise, too few of something."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import linregress

from harness.core.arrays import FloatArray
from harness.estimate.channel import ChannelFit, fit_channel
from harness.estimate.displacement import half_cycle_frequency
from harness.estimate.noise import Noise
from harness.estimate.reversals import Kind, NoDecay
from harness.estimate.saturation import saturated
from harness.estimate.table1 import Setup
from harness.estimate.turning import _locally
from harness.exact.decay import Decay, free_decay

T = np.linspace(0.0, 3.2, 640)
DECAY = Decay(9.0, 0.01, 0.02)


def measured(kind: Kind, seed: int, sigma: float) -> FloatArray:
    run = free_decay(DECAY, T)
    y = {Kind.DISPLACEMENT: run.x, Kind.VELOCITY: run.v, Kind.ACCELERATION: run.a}[kind]
    return np.asarray(y + sigma * np.ptp(y) * np.random.default_rng(seed).standard_normal(T.size))


@pytest.mark.parametrize("kind", Kind)
@pytest.mark.parametrize("unit", [1e-8, 1e6])
def test_the_unit_of_a_channel_changes_nothing_but_the_unit(kind: Kind, unit: float) -> None:
    for seed in range(4):
        y = measured(kind, seed, 0.02 if seed % 2 else 1e-4)
        here, there = fit_channel(T, y, kind), fit_channel(T, unit * y, kind)
        assert (here.tied.count, len(here.separate), here.holds) == (
            there.tied.count,
            len(there.separate),
            there.holds,
        )
        rates: FloatArray = np.array([here.sigma, here.omega])
        assert np.allclose(rates, [there.sigma, there.omega], rtol=1e-6)
        assert np.allclose(here.separate.c * unit, there.separate.c, rtol=1e-5, atol=1e-7 * unit)


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_what_is_no_oscillation_between_reversals_is_refused_in_any_unit(unit: float) -> None:
    y = np.cos(11.0 * T) + 0.6 * np.sin(88.0 * T + 0.3)
    with pytest.raises(NoDecay) as refused:
        fit_channel(T, unit * y, Kind.ACCELERATION)
    assert "between reversals is no damped oscillation" in str(refused.value)


def test_no_noise_and_noise_without_steps_are_added_as_they_are() -> None:
    y, rng = np.linspace(0.0, 1.0, 9), np.random.default_rng
    noise = Noise(0.1, True)
    assert np.array_equal(noise.over(y, rng(1)), y + noise.drawn(9, rng(1)))
    assert np.array_equal(Noise(0.1, False).over(y, rng(1)), y)
    stepped = replace(noise, step=0.25).over(y, rng(1))
    assert np.array_equal(stepped, 0.25 * np.round(stepped / 0.25))
    # a step of .25 scatters by .072 itself: where that is all the noise there is, nothing is drawn
    bare = Noise(0.05, True, step=0.25).over(y, rng(1))
    assert np.array_equal(bare, 0.25 * np.round(y / 0.25))


def test_a_gap_farther_off_than_a_run_is_long_does_not_hide_that_it_was_cut_off() -> None:
    t = np.arange(1000.0)
    y = np.minimum(1.0 - np.abs(t - 500.0) / 500.0, 0.969)  # it runs into the limit at full speed
    assert np.count_nonzero(y == 0.969) == 31
    for off, told in ((35, True), (5, False)):
        kept = np.abs(np.abs(t - 500.0) - (16.0 + off)) > 4.0
        assert saturated(t[kept], y[kept], Noise(1e-6, True)).any() == told


def fit_of_displacement() -> ChannelFit:
    # it comes to rest within the recording, so that the last turning point has samples on both sides
    run = free_decay(Decay(9.0, 0.01, 0.08), T)
    return fit_channel(T, run.x + 1e-3 * np.random.default_rng(5).standard_normal(T.size), Kind.DISPLACEMENT)


def test_turning_points_one_by_one_err_with_the_colour_of_the_noise() -> None:
    fit = replace(fit_of_displacement(), inflation=1.0)
    white, red = _locally(fit).covariance, _locally(replace(fit, inflation=6.0)).covariance
    found = np.diagonal(white, axis1=1, axis2=2)
    assert np.all(found > 0.0)
    assert np.allclose(red, 6.0 * white, rtol=1e-12)
    quiet = replace(fit, noise=replace(fit.noise, sigma=0.1 * fit.noise.sigma))
    # the first and the last are of the half-cycle's own form where the recording begins and ends there
    assert np.allclose(_locally(quiet).covariance[1:, 0, 0], 0.01 * white[1:, 0, 0], rtol=1e-12)
    assert _locally(quiet).covariance[-1, 1, 1] == pytest.approx(0.01 * white[-1, 1, 1], rel=1e-12)


def test_omega_d_is_that_of_a_line_through_the_times() -> None:
    fit = replace(fit_of_displacement(), holds=False)
    assert half_cycle_frequency(fit, np.array([math.nan, 1.0, math.nan])) == (fit.omega, math.inf)
    assert half_cycle_frequency(fit, np.array([math.nan, 1.0, 1.5, math.nan]))[0] == pytest.approx(2.0 * math.pi)
    times: FloatArray = np.array([0.0, 1.0, 2.3])
    line = linregress(np.arange(3.0), times)
    omega, error = half_cycle_frequency(fit, times)
    assert omega == pytest.approx(math.pi / line.slope)
    assert error == pytest.approx(math.pi / line.slope**2 * line.stderr)


def test_the_table_is_of_five_releases_about_5_2_mm_at_1_khz() -> None:
    setup = Setup()
    assert setup.rate == 1000.0
    assert np.mean(setup.starts) == pytest.approx(5.2e-3)
    assert np.allclose(np.diff(sorted(setup.starts)), 1e-4)
