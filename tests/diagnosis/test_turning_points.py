"""Turning points of a recorded decay, and what counts as its beginning."""

import math

import numpy as np
import pytest

from harness.diagnosis.baseline.base_fit import dominant_frequency
from harness.diagnosis.baseline.residual_noise import coloured_whole
from harness.diagnosis.problems.free_decay import first_turn, turning_points
from harness.estimate.noise import Noise
from harness.kernels.solve import simulate
from harness.model.model import Model

OMEGA, ZETA = 10.0, 0.02
T = np.linspace(0.0, 6.0, 3001)
STEP = float(T[1] - T[0])
DAMPED = OMEGA * math.sqrt(1.0 - ZETA**2)


def decay(t0: float = 0.0) -> Model:
    return Model(m=1.0, c=2.0 * ZETA * OMEGA, k=OMEGA**2, f_k=0.0, x0=1.0, t0=t0)


def channels(name: str) -> dict[str, np.ndarray]:
    run = simulate(decay(), T)
    return {name: getattr(run, name) + 1e-4 * np.random.default_rng(1).standard_normal(T.size)}


@pytest.mark.parametrize("name", ["x", "v"])
def test_a_damped_swing_turns_every_half_period(name: str) -> None:
    turns = T[turning_points(T, channels(name))]
    expected = math.pi / DAMPED * np.arange(1, turns.size + 1)
    # the last of the 19 lies 30 ms before the end: nothing shows yet that it turns back
    assert turns.size == int((6.0 - 0.05) * DAMPED / math.pi)
    assert np.max(np.abs(turns - expected)) < 0.03  # a top is flat: noise moves it


@pytest.mark.parametrize("name", ["x", "v", "a"])
def test_the_motion_is_free_from_the_first_turning_point(name: str) -> None:
    found = channels(name)
    assert T[first_turn(T, found, turning_points(T, found))] == pytest.approx(math.pi / DAMPED, abs=0.03)


def test_a_hand_that_moves_the_slider_first_is_before_it() -> None:
    """It pulls from 0.9 to 1 and lets go at 0.5 s: the first turning point of the swing is half a period later."""
    free = simulate(decay(0.5), T[T >= 0.5]).x
    pulled = 1.0 - 0.1 * (1.0 - T[T < 0.5] / 0.5) ** 2
    found = {"x": np.concatenate((pulled, free))}
    assert T[first_turn(T, found, turning_points(T, found))] == pytest.approx(0.5 + math.pi / DAMPED, abs=2 * STEP)


def test_what_rests_has_no_turning_point() -> None:
    still = {"x": 1e-4 * np.random.default_rng(2).standard_normal(T.size)}
    assert turning_points(T, still).size < 3
    assert turning_points(T, {"x": np.zeros(T.size)}).size == 0


def test_a_swing_is_found_beside_a_long_rest_off_its_mean() -> None:
    """Dry friction stops it after four cycles a fifth of the way; the rest then lies off zero for as long again."""
    model = Model(m=1.0, c=0.5, k=OMEGA**2, f_k=6.0, x0=1.0)
    t = np.linspace(0.0, 8.0, 2001)
    assert dominant_frequency(t, simulate(model, t).x + 0.3) == pytest.approx(OMEGA, rel=0.1)


def coloured(phi: float) -> np.ndarray:
    return Noise(1.0, True, phi).drawn(4000, np.random.default_rng(3))


def test_a_steady_residual_of_first_order_colour_is_noise() -> None:
    said = Noise(0.5, True)
    found = coloured_whole(coloured(0.6), np.ones(4000), said, 28)
    assert found.phi == pytest.approx(0.6, abs=0.05)
    assert found.sigma == pytest.approx(1.0, rel=0.05)


def test_a_burst_is_no_noise() -> None:
    """A hand's jerk in the first fiftieth of a residual: five times as strong as what follows."""
    said, burst = Noise(0.5, True), coloured(0.6)
    burst[:80] *= 5.0
    assert coloured_whole(burst, np.ones(4000), said, 28) is said


@pytest.mark.parametrize("width", [12, 28, 40])
@pytest.mark.parametrize("phi", [0.3, 0.6, 0.8])
def test_noise_of_a_colour_is_seen_as_such_by_windows_too(phi: float, width: int) -> None:
    said = Noise(0.5, True)
    for seed in range(40):
        drawn = Noise(1.0, True, phi).drawn(600, np.random.default_rng(seed))
        assert coloured_whole(drawn, np.ones(600), said, width).phi > 0.0


@pytest.mark.parametrize("width", [20, 28, 40])
def test_a_slow_misfit_under_a_fast_noise_is_no_colour(width: int) -> None:
    """Its neighbours are as alike as those of a colour, but a window of a quarter of a swing sees the noise alone."""
    said, t = Noise(1.0, True), np.arange(1200.0)
    for seed in range(20):
        random = np.random.default_rng(seed)
        slow = np.cos(2.0 * np.pi * t / 112.0 + random.uniform(0.0, 6.0)) * (1.0 + 0.3 * np.cos(t / 200.0))
        residual = random.standard_normal(t.size) + 2.0 * slow
        close = float(residual[1:] @ residual[:-1] / (residual @ residual))
        assert 0.5 < close < 0.8
        assert coloured_whole(residual, np.ones(t.size), said, width) is said
