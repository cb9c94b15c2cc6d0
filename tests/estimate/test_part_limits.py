"""Known answers of the estimators' parts where they meet a limit: units, colours of noise, too few of something."""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.estimate import displacement as by_turning_points
from harness.estimate.channel import ChannelFit, _refuse_driven, fit_channel
from harness.estimate.displacement import TurningPoints, _near, displacement
from harness.estimate.every import _warnings
from harness.estimate.halfcycles import Windows
from harness.estimate.noise import Noise
from harness.estimate.paper import _ratios
from harness.estimate.reversals import Kind, NoDecay, _crossings, _train
from harness.exact.decay import Decay, free_decay

T = np.linspace(0.0, 3.2, 640)
DECAY = Decay(9.0, 0.01, 0.02)


def measured(kind: Kind, seed: int, sigma: float) -> FloatArray:
    run = free_decay(DECAY, T)
    y = {Kind.DISPLACEMENT: run.x, Kind.VELOCITY: run.v, Kind.ACCELERATION: run.a}[kind]
    return np.asarray(y + sigma * np.ptp(y) * np.random.default_rng(seed).standard_normal(T.size))


def test_a_motion_that_lasts_is_driven_where_its_half_cycles_are_no_sines() -> None:
    y = np.sin(10.0 * T)
    edges = np.arange(0.0, T[-1], math.pi / 10.0)
    y[edges[-2] < T] *= 40.0  # what lies beyond the last window is not looked at
    windows = Windows.of(T, edges[:-1], 0.0)
    usual = float(np.var(y[windows.lo[0] : windows.hi[-1]]))
    left: Any = SimpleNamespace(windows=windows, variance=1.5e-4 * usual)
    with pytest.raises(NoDecay, match="driven"):
        _refuse_driven(left, y, 0.0)
    # the last window counts: its larger swing is part of the motion that the misfit is held against
    y[windows.lo[-1] : windows.hi[-1]] *= 3.0
    usual = float(np.var(y[windows.lo[0] : windows.hi[-1]]))
    for quiet, floor in ((0.99e-4, 0.0), (1.5e-4, 1e-5 * usual)):
        _refuse_driven(SimpleNamespace(windows=windows, variance=quiet * usual), y, floor)  # type: ignore[arg-type]


def test_the_centre_of_a_half_cycle_is_the_displacements_alone() -> None:
    for kind in Kind:
        basis = fit_channel(T, measured(kind, 0, 1e-3), kind).separate.basis(1, 0.5)
        assert basis[2] == (1.0 if kind is Kind.DISPLACEMENT else 0.0)


def fit_of_displacement() -> ChannelFit:
    # it comes to rest within the recording, so that the last turning point has samples on both sides
    run = free_decay(Decay(9.0, 0.01, 0.08), T)
    return fit_channel(T, run.x + 1e-3 * np.random.default_rng(5).standard_normal(T.size), Kind.DISPLACEMENT)


def test_a_turning_point_is_looked_for_within_half_the_reach() -> None:
    fit = fit_of_displacement()
    reach, far = 0.2 * math.pi / fit.omega, float(fit.separate.stops(1)[0])
    parabola = replace(fit, y=(fit.t - far) ** 2)
    assert _near(parabola, far - 0.3 * reach)[0] == pytest.approx(far, abs=1e-9)
    assert _near(parabola, far - 0.9 * reach)[0] == pytest.approx(far - 0.4 * reach, abs=1e-9)
    assert _near(parabola, far + 0.9 * reach)[0] == pytest.approx(far + 0.4 * reach, abs=1e-9)


def points(seen: FloatArray, scale: float = 1.0) -> TurningPoints:
    count = seen.shape[0]
    sides: FloatArray = np.where(np.arange(count) % 2 == 0, 1.0, -1.0)
    size = 0.8 ** np.arange(count + 1)
    ends = scale * np.stack([sides * size[:-1], -sides * size[1:]], axis=1)
    covariance = np.tile(scale**2 * np.diag([1e-4, 4e-4]), (count, 1, 1))
    return TurningPoints(np.stack([np.arange(count), 1.0 + np.arange(count)], axis=1), ends, covariance, seen > 0.0)


def test_turning_points_merge_alike_in_any_unit() -> None:
    """Both sides weigh by their variances: 1/(1/1e-4 + 1/4e-4) = 0.8e-4 m^2, in mm a million times that."""
    for scale in (1.0, 1e3):
        _, value, variance = points(np.ones((5, 2)), scale).merged()
        assert np.allclose(np.abs(value) / scale, 0.8 ** np.arange(6.0))
        assert variance[1:-1] / scale**2 == pytest.approx(0.8e-4)
        assert (variance[0], variance[-1]) == pytest.approx((1e-4 * scale**2, 4e-4 * scale**2))


@pytest.mark.parametrize("seen", [3, 4])
def test_three_turning_points_are_too_few(seen: int, monkeypatch: pytest.MonkeyPatch) -> None:
    fit = fit_of_displacement()
    some = np.zeros((len(fit.separate), 2))
    some.flat[:seen] = 1.0
    monkeypatch.setattr(by_turning_points, "turning_points", lambda _: points(some))
    assert (displacement(fit).x_k.value is None) == (seen < 4)


def test_a_train_of_crossings_without_a_usual_gap_goes_by_the_period() -> None:
    assert _train(np.array([0.0, 0.35, 0.70, 1.05]), 2.0) == slice(0, 0)
    assert _train(np.array([0.0, 1.0, 2.0, 3.0]), 2.0) == slice(0, 4)
    assert _train(np.array([0.0, 3.8, 7.6]), 4.0) == slice(0, 0)


def test_ratios_of_rounding_are_none_in_any_unit() -> None:
    for scale in (1e-3, 1.0, 1e3):
        found = _ratios(scale * np.array([1.0, 1.0]), scale * np.array([2.0, 1e-10]), scale)
        assert found[0] == pytest.approx(0.5)
        assert math.isnan(found[1])


def test_the_misfit_is_told_in_units_of_the_coloured_noise() -> None:
    fit: Any = SimpleNamespace(dropped=False, variance=9.0 * 4.0, inflation=9.0, noise=Noise(1.0, True))
    assert any("leave 2.0 times the noise" in said for said in _warnings(T, {"x": fit}))
    quiet: Any = SimpleNamespace(dropped=False, variance=9.0, inflation=9.0, noise=Noise(1.0, True))
    assert _warnings(T, {"x": quiet}) == []


def test_a_crossing_is_where_the_sign_changes_however_small_or_bent() -> None:
    """Steeper beyond 0.374 s than before, in mm and in km."""
    t = np.arange(0.0, 1.0, 0.01)
    bent = (t - 0.374) ** 3 * np.where(t < 0.374, 1.0, 50.0)
    for size in (1e-3, 1.0, 1e3):
        assert _crossings(t, size * bent, 0.2**3 * size) == pytest.approx([0.374], abs=0.01)
