"""Parts of the estimators against closed forms, a library, and the limits of units and colours."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import linregress

from harness.core.arrays import FloatArray
from harness.core.scenario import FREE_DECAY
from harness.core.slider import EXPERIMENT
from harness.estimate.acceleration import as_acceleration
from harness.estimate.channel import ChannelFit, _tied_start, fit_channel
from harness.estimate.displacement import _locally, _near, half_cycle_frequency
from harness.estimate.halfcycles import compiled_inverse
from harness.estimate.noise import Noise, _compiled_residuals, channel_noise
from harness.estimate.reversals import Kind, NoDecay
from harness.estimate.saturation import saturated
from harness.estimate.table1 import Setup, table
from harness.estimate.tied import OMEGA, P0, SIGMA, T0, D
from harness.exact.decay import Decay, free_decay

T = np.arange(0.0, 2.6, 1e-3)
DECAY = free_decay(FREE_DECAY, T)


@pytest.mark.parametrize("size", [2, 3])
@pytest.mark.parametrize("seed", range(5))
def test_a_small_inverse_is_the_librarys(size: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    # columns of very different size, as amplitudes and centres have
    rows = rng.standard_normal((9, 3)) * [1.0, 30.0, 1e-3]
    gram, found = rows.T @ rows, np.full((3, 3), np.nan)
    compiled_inverse(gram, size, found)
    known = np.zeros((3, 3))
    known[:size, :size] = np.linalg.inv(gram[:size, :size])
    assert found == pytest.approx(known, rel=1e-8, abs=1e-12)


@pytest.mark.parametrize(("width", "degree"), [(8, 6), (20, 5)])
def test_residuals_of_windows_are_those_of_a_polynomial_fit(width: int, degree: int) -> None:
    rng = np.random.default_rng(3)
    t = np.cumsum(rng.uniform(0.5, 1.5, 5 * width))
    y, found = rng.standard_normal(t.size), np.zeros(t.size)
    _compiled_residuals(t, y, width, degree, found)
    for lo in range(0, t.size, width):
        part = slice(lo, lo + width)
        line = np.polynomial.Polynomial.fit(t[part], y[part], degree)
        assert found[part] == pytest.approx(y[part] - line(t[part]), abs=1e-9)


@pytest.mark.parametrize("period", [None, 0.63])
@pytest.mark.parametrize("sigma", [1e-3, 1e-2])
def test_white_noise_has_the_level_that_was_put_in(period: float | None, sigma: float) -> None:
    t: FloatArray = np.arange(20_000.0) * 1e-3
    y = np.cos(10.0 * t) + sigma * np.random.default_rng(1).standard_normal(t.size)
    noise = channel_noise(t, y, period)
    assert noise.found
    assert noise.sigma == pytest.approx(sigma, rel=0.05)
    assert abs(noise.phi) < 0.05
    assert noise.step == 0.0


def test_coloured_noise_has_its_colour() -> None:
    t: FloatArray = np.arange(20_000.0) * 1e-3
    rng = np.random.default_rng(2)
    e = np.zeros(t.size)
    for i, fresh in enumerate(rng.standard_normal(t.size)):
        e[i] = 0.6 * e[i - 1] + 0.8 * fresh
    noise = channel_noise(t, np.cos(5.0 * t) + 1e-2 * e, 1.26)
    assert noise.phi == pytest.approx(0.6, abs=0.05)
    assert noise.sigma == pytest.approx(1e-2, rel=0.05)


def test_a_speed_fit_as_acceleration_is_its_derivative() -> None:
    fit = fit_channel(T, DECAY.v, Kind.VELOCITY).separate
    turned = as_acceleration(fit)
    assert turned.kind is Kind.ACCELERATION
    assert as_acceleration(turned) is turned
    h = 1e-6
    for k in range(len(fit)):
        middle = 0.5 * float(fit.edges[k] + fit.edges[k + 1])
        slope = (fit.value(k, middle + h) - fit.value(k, middle - h)) / (2.0 * h)
        assert turned.value(k, middle) == pytest.approx(slope, rel=1e-6)
    # and so is how it depends on the rates: c is refitted by slope when they move
    for j, step in enumerate((1e-5, 1e-5)):
        rates = [fit.sigma, fit.omega]
        rates[j] += step
        moved = replace(fit, sigma=rates[0], omega=rates[1], c=fit.c + step * fit.slope[:, :, j])
        change = (as_acceleration(moved).c - turned.c) / step
        assert turned.slope[:, :2, j] == pytest.approx(change[:, :2], rel=1e-3, abs=1e-3 * float(np.abs(change).max()))


def test_a_turning_point_is_found_though_the_curvature_jumps_there() -> None:
    fit = fit_channel(T, DECAY.x, Kind.DISPLACEMENT)
    true = 0.7312
    reach = 0.2 * math.pi / fit.omega
    s = (T - true) / reach
    bent = 3.0 - 0.4 * s**2 * (s < 0.0) - 0.25 * s**2 * (s >= 0.0) + 0.02 * s**3
    time, value, spread = _near(replace(fit, y=bent), true)
    assert time == pytest.approx(true, abs=1e-9)
    assert value == pytest.approx(3.0, abs=1e-9)
    assert 0.0 < spread < 1.0
    # asked for a little beside it, it is still nearer than that
    beside, _, _ = _near(replace(fit, y=bent), true + 0.1 * reach)
    assert abs(beside - true) < 0.05 * reach
    late, value, spread = _near(fit, float(T[-1]) + 1.0)
    assert (late, math.isnan(value), math.isinf(spread)) == (float(T[-1]) + 1.0, True, True)


def test_the_printed_table_holds_the_numbers_that_were_found() -> None:
    setup, rng = Setup(), np.random.default_rng(4)
    near = [(EXPERIMENT.x_k * a, EXPERIMENT.zeta * b) for a, b in rng.uniform(0.9, 1.1, (len(setup.starts), 2))]
    found = {"acceleration": near, "displacement": near[::-1]}, [0.1]
    lines = {line[:26].strip(): line[26:].split() for line in table(EXPERIMENT, setup, found).splitlines()[3:]}
    for name, pairs in found[0].items():
        for column, (label, scale, exact) in enumerate(
            (("x_k mm", 1e3, EXPERIMENT.x_k), ("zeta", 1.0, EXPERIMENT.zeta))
        ):
            values = np.array([pair[column] for pair in pairs]) * scale
            *single, mean, truth, spread, error = (float(word) for word in lines[f"{name} {label}"])
            assert single == pytest.approx(values, abs=6e-5)
            assert mean == pytest.approx(values.mean(), abs=6e-5)
            assert truth == pytest.approx(scale * exact, abs=6e-5)
            assert spread == pytest.approx(100.0 * values.std(ddof=1) / values.mean(), abs=6e-3)
            assert error == pytest.approx(100.0 * (values.mean() / (scale * exact) - 1.0), abs=6e-3)


LONGER = np.linspace(0.0, 3.2, 640)
SLOWER = Decay(9.0, 0.01, 0.02)


def measured(kind: Kind, seed: int, sigma: float) -> FloatArray:
    run = free_decay(SLOWER, LONGER)
    y = {Kind.DISPLACEMENT: run.x, Kind.VELOCITY: run.v, Kind.ACCELERATION: run.a}[kind]
    return np.asarray(y + sigma * np.ptp(y) * np.random.default_rng(seed).standard_normal(LONGER.size))


@pytest.mark.parametrize("kind", Kind)
@pytest.mark.parametrize("unit", [1e-8, 1e6])
def test_the_unit_of_a_channel_changes_nothing_but_the_unit(kind: Kind, unit: float) -> None:
    for seed in range(4):
        y = measured(kind, seed, 0.02 if seed % 2 else 1e-4)
        here, there = fit_channel(LONGER, y, kind), fit_channel(LONGER, unit * y, kind)
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
    y = np.cos(11.0 * LONGER) + 0.6 * np.sin(88.0 * LONGER + 0.3)
    with pytest.raises(NoDecay) as refused:
        fit_channel(LONGER, unit * y, Kind.ACCELERATION)
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
    run = free_decay(Decay(9.0, 0.01, 0.08), LONGER)
    return fit_channel(LONGER, run.x + 1e-3 * np.random.default_rng(5).standard_normal(LONGER.size), Kind.DISPLACEMENT)


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


def test_what_cannot_be_inverted_is_nothing() -> None:
    found = np.full((3, 3), np.nan)
    compiled_inverse(np.ones((3, 3)), 3, found)
    assert np.all(found == 0.0)
    compiled_inverse(np.ones((3, 3)), 2, found)
    assert np.all(found == 0.0)


@pytest.mark.parametrize("kind", list(Kind))
def test_the_tied_fit_begins_near_where_it_ends(kind: Kind) -> None:
    y = {Kind.DISPLACEMENT: DECAY.x, Kind.VELOCITY: DECAY.v, Kind.ACCELERATION: DECAY.a}[kind]
    fit = fit_channel(T, y + 1e-5 * np.ptp(y) * np.random.default_rng(0).standard_normal(T.size), kind)
    assert fit.holds
    begun, ended = _tied_start(fit.separate), fit.tied.theta
    omega = FREE_DECAY.slider.omega_n
    assert begun[OMEGA] == pytest.approx(ended[OMEGA], rel=2e-3)
    assert begun[SIGMA] == pytest.approx(FREE_DECAY.slider.zeta * omega, rel=0.05)
    assert begun[T0] == pytest.approx(ended[T0], abs=0.02 / omega)
    assert begun[P0] == pytest.approx(ended[P0], rel=0.02)
    assert begun[D] == pytest.approx(ended[D], rel=0.1)
