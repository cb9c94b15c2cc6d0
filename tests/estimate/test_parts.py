"""Parts of the estimators against closed forms and against the same thing done by a library."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.core.scenario import FREE_DECAY
from harness.core.slider import EXPERIMENT
from harness.estimate.channel import fit_channel
from harness.estimate.jumps import as_acceleration
from harness.estimate.noise import _compiled_residuals, channel_noise
from harness.estimate.projection import compiled_inverse
from harness.estimate.reversals import Kind
from harness.estimate.table1 import Setup, table
from harness.estimate.turning import _near
from harness.exact.decay import free_decay

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
