"""A sensor at the end of its range: what it cut off is left out, and a motion that turns, rests or is held is not."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.app.shared.estimates import estimate
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.pipeline import diagnose, fit_base, prepare
from harness.diagnosis.request import Asked
from harness.estimate.noise import Noise, channel_noise
from harness.estimate.saturation import saturated, within_range
from harness.kernels.solve import Drive, simulate, solve
from harness.model.model import Model, Restoring

SLIDER = Model(1.0, 0.3, 144.0, 0.25, x0=0.05)
SIGMA = 2e-5


def decay(limit: float = np.inf, seconds: float = 8.0) -> Recording:
    t = np.arange(0.0, seconds, 2e-3)
    x = simulate(SLIDER, t).x + SIGMA * np.random.default_rng(0).standard_normal(t.size)
    return Recording(t, {"x": np.clip(x, -limit, limit)})


def test_samples_at_the_limit_are_found_all_of_them_and_no_other() -> None:
    recording = decay(0.04)
    x = recording["x"]
    at = saturated(recording.t, x, channel_noise(recording.t, x))
    assert np.array_equal(at, np.abs(x) == 0.04)
    assert np.count_nonzero(at) == 66
    assert not saturated(recording.t, decay()["x"], Noise(SIGMA, True)).any()


def test_what_is_left_is_read_as_if_nothing_had_been_cut_off() -> None:
    whole, cut = estimate(decay()), estimate(decay(0.04))
    assert "x stops at -0.04 and 0.04 m at full speed" in cut.warnings[0]
    for name in ("omega_n", "zeta", "x_k"):
        one, other = (getattr(e.methods["displacement"], name) for e in (cut, whole))
        assert abs(one.value - other.value) < 3.0 * one.stderr
    assert cut.methods["displacement"].zeta.value == pytest.approx(0.0125, rel=6e-3)


def test_a_recording_that_is_cut_off_lacks_no_physics() -> None:
    problem, notes = prepare(decay(0.04), Asked())
    assert notes[0].endswith("66 samples are left out")
    found = diagnose(problem)
    assert found.verdict == "adequate"
    assert found.base.model.f_k == pytest.approx(0.25, rel=2e-3)


def test_a_driven_slider_is_followed_over_what_its_sensor_does_not_see() -> None:
    t, fine = np.arange(1200) / 200.0, np.arange(19200) / 3200.0
    u = 6.0 * np.sin(3.1 * fine) + 4.0 * np.sin(7.3 * fine + 1.1)
    x = solve(Model(2.0, 3.0, 80.0, 1.5), t, drive=Drive(fine, u)).x
    x = x + SIGMA * np.random.default_rng(4).standard_normal(t.size)
    limit = 0.8 * float(x.max())
    problem, notes = prepare(Recording(t, {"x": np.minimum(x, limit), "u": u[::16]}), Asked())
    assert notes[-1].startswith(f"x stops at {limit:.4g} m at full speed")
    assert float(problem.channels["x"].max()) < limit
    based = fit_base(problem)
    assert based.fit.chi2 / based.fit.points == pytest.approx(1.0, abs=0.1)
    assert (based.fit.model.c, based.fit.model.f_k) == pytest.approx((3.0, 1.5), rel=2e-3)


@pytest.mark.parametrize(
    "rest",
    [
        pytest.param(lambda t: np.where(t < 1.0, 0.05, 0.05 * np.cos(12.0 * (t - 1.0))), id="held, then let go"),
        pytest.param(lambda t: 1e-3 * np.round(50.0 * np.cos(12.0 * t)), id="coarse steps"),
        pytest.param(lambda t: np.where(t < 1.0, -0.05 * np.cos(np.pi * t), 0.05), id="sticks at its turning point"),
    ],
)
def test_equal_numbers_that_the_motion_comes_to_at_rest_are_kept(rest: object) -> None:
    t = np.arange(0.0, 4.0, 2e-3)
    x: FloatArray = rest(t)  # type: ignore[operator]
    assert not saturated(t, x, channel_noise(t, x)).any()


def test_a_plastic_stop_is_left_as_it_was_met() -> None:
    """A slider runs into a stop and stays until it is pulled away: only one side goes on beyond."""
    t = np.arange(0.0, 4.0, 2e-3)
    away = np.maximum(t - 2.0, 0.0)
    x = np.where(t < 1.0, 0.05 * t, 0.05 - 0.1 * away**2)
    assert not saturated(t, x, Noise(1e-7, True)).any()


@settings(max_examples=60)
@given(
    seed=st.integers(0, 10**6),
    samples=st.integers(15, 400),
    noise=st.floats(-5.0, -2.0),
    step=st.one_of(st.just(0.0), st.floats(-4.0, -1.5)),
    friction=st.floats(0.005, 0.05),
)
def test_no_free_motion_is_cut(seed: int, samples: int, noise: float, step: float, friction: float) -> None:
    """samples a period; noise and step : powers of ten of the amplitude."""
    model = replace(SLIDER, f_k=friction * SLIDER.k * SLIDER.x0)
    t = np.arange(0.0, 8.0, 2.0 * np.pi / 12.0 / samples)
    x = simulate(model, t).x + 0.05 * 10.0**noise * np.random.default_rng(seed).standard_normal(t.size)
    if step:
        x = 0.05 * 10.0**step * np.round(x / (0.05 * 10.0**step))
    assert not saturated(t, x, channel_noise(t, x)).any()


def test_a_recording_that_is_nearly_all_cut_off_is_refused() -> None:
    t = np.arange(0.0, 3.0, 0.01)
    recording = Recording(t, {"x": np.clip(np.sin(2.0 * t), -0.2, 0.2)})
    with pytest.raises(InputError, match="within the sensor's range"):
        within_range(recording, ("x",))


def test_a_commanded_speed_is_no_sensor_at_its_limit() -> None:
    """An axis without a spring whose speed is held at its largest: v stays as it was measured."""
    t = np.arange(0.0, 6.0, 2e-3)
    v = np.clip(0.6 * np.sin(2.0 * t) / 0.5, -0.3, 0.3)
    u = 2.0 * np.gradient(v, t) + 3.0 * v + 1.5 * np.sign(v)
    problem, notes = prepare(Recording(t, {"v": v + 1e-5 * np.sin(700.0 * t), "u": u}), Asked(Restoring.NONE))
    assert problem.t.size == t.size
    assert not any("full speed" in note for note in notes)
