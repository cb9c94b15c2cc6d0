"""Samples at the end of a range or beside the motion are left out; nothing that a mass can do counts as one."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.app.shared.estimates import estimate
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.diagnosis.fit.model_fit import fit
from harness.diagnosis.pipeline import diagnose, fit_base, prepare
from harness.diagnosis.request import Asked
from harness.estimate.noise import Noise, channel_noise
from harness.estimate.saturation import saturated, within_range
from harness.estimate.stray import stray
from harness.kernels.solve import Drive, Scales, simulate, solve
from harness.model.model import Model, ModelTerm, Restoring

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
    assert notes[0].endswith("66 samples are skipped")
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


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), rate=st.floats(10.0, 60.0), step=st.sampled_from([0.0, 4e-4, 1.5e-3]))
def test_no_rest_of_a_servo_is_cut(seed: int, rate: float, step: float) -> None:
    """Quintic moves between rests of seconds, coarsely and irregularly sampled by a counting encoder."""
    r = np.random.default_rng(seed)
    goals, begin, x = r.uniform(-1.5, 1.5, 9), 0.0, 0.0
    t = np.cumsum((1.0 + 0.4 * r.uniform(-1.0, 1.0, int(36 * rate))) / rate)
    y = np.zeros(t.size)
    for goal in goals:
        lasts = r.uniform(0.6, 2.0)
        s = np.clip((t - begin) / lasts, 0.0, 1.0)
        y += (goal - x) * s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        x, begin = goal, begin + lasts + r.uniform(1.0, 3.0)
    y = np.round(y / step) * step if step else y
    assert not saturated(t, y, channel_noise(t, y, rests=True)).any()


def test_what_runs_down_to_rest_is_no_sensor_at_its_limit() -> None:
    t = np.arange(0.0, 12.0, 0.01)
    v = np.maximum(168.0 * np.exp(-0.12 * t) - 150.0 * (1.0 - np.exp(-0.12 * t)), 0.0)
    found, notes = within_range(Recording(t, {"v": 0.01 * np.rint(100.0 * v)}), ("v",))
    assert (len(found), notes) == (t.size, ())


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


DRAG = Model(1.0, 0.05, 100.0, 0.05, x0=0.1, terms=(ModelTerm.named("quadratic-drag", c2=2.0),))
SCATTER = 1e-5
LOST = {40: (3e-4,), 207: (0.02, 0.021, 0.019), 500: (-0.004,) * 6, 903: (1e-3, -1e-3)}
"""Where a tracker lost its mark, and by how much it was off, m."""


def swing(seconds: float = 6.0) -> Recording:
    t = np.arange(0.0, seconds, 5e-3)
    return Recording(t, {"x": simulate(DRAG, t).x + SCATTER * np.random.default_rng(0).standard_normal(t.size)})


def lost(recording: Recording) -> Recording:
    x = recording["x"].copy()
    for first, by in LOST.items():
        x[first : first + len(by)] += by
    return Recording(recording.t, {**recording.channels, "x": x})


def test_exactly_what_strays_is_found_and_by_how_much() -> None:
    recording = lost(swing())
    off = stray(recording.t, recording["x"], Noise(SCATTER, True))
    expected = np.zeros(off.size)
    for first, by in LOST.items():
        expected[first : first + len(by)] = by
    assert np.array_equal(off != 0.0, expected != 0.0)
    assert off == pytest.approx(expected, abs=5.0 * SCATTER)
    clean = swing()
    assert not stray(clean.t, clean["x"], Noise(SCATTER, True)).any()


def test_what_lasts_longer_may_be_motion() -> None:
    recording = swing()
    x = recording["x"].copy()
    x[300:307] += 0.004
    assert not stray(recording.t, x, Noise(SCATTER, True)).any()


@pytest.mark.parametrize(("steps", "found"), [(4, False), (8, True)])
def test_a_few_steps_of_an_encoder_are_its_noise(steps: int, found: bool) -> None:
    step, t = 1e-3, np.arange(0.0, 4.0, 5e-3)
    x = step * np.round(0.1 * np.cos(10.0 * t) / step)
    x[333] += steps * step
    assert stray(t, x, Noise(step / np.sqrt(12.0), True, step=step)).any() == found


Shape = Callable[[FloatArray], FloatArray]


def _bounce(width: float) -> Shape:
    return lambda s: np.asarray(np.interp(s, [0.0, width], [1.0, -0.7]), dtype=np.float64)


def _sine(period: int) -> Shape:
    return lambda s: np.asarray(np.cos(2.0 * np.pi * s / period), dtype=np.float64)


SHAPES: dict[str, Shape] = {
    "corner": np.abs,
    "step": lambda s: np.where(s < 0.0, 0.0, 1.0),
    "kink of the force": lambda s: s * np.abs(s),
    "flat top": lambda s: np.minimum(-0.02 * s**2, -0.5),
    "quick bounce": _bounce(0.5),
    "bounce": _bounce(3.0),
    "slow bounce": _bounce(6.0),
    **{f"sine of {n}": _sine(n) for n in (8, 10, 13, 20, 41)},
}


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
@given(place=st.floats(-3.0, 3.0), slope=st.floats(-1.0, 1.0), scale=st.floats(1e-6, 1e6))
@settings(max_examples=60, deadline=None)
def test_no_motion_of_a_mass_strays_though_there_is_no_noise(
    shape: Shape, place: float, slope: float, scale: float
) -> None:
    s = np.arange(-40.0, 41.0) - place
    assert not stray(s, scale * (shape(s) + slope * s), Noise(1e-9 * scale, True)).any()


@given(
    shift=st.floats(-1e3, 1e3), scale=st.floats(1e-6, 1e6), pace=st.floats(1e-4, 1e4), begin=st.floats(-100.0, 100.0)
)
@settings(max_examples=40, deadline=None)
def test_units_and_zeros_change_nothing(shift: float, scale: float, pace: float, begin: float) -> None:
    recording = lost(swing(5.0))
    t, x = recording.t, recording["x"]
    once = stray(t, x, Noise(SCATTER, True))
    again = stray(pace * (t + begin), scale * (x + 1e-3 * shift), Noise(scale * SCATTER, True))
    assert np.array_equal(once != 0.0, again != 0.0)
    assert again / scale == pytest.approx(once, abs=1e-3 * SCATTER)


def test_nothing_is_said_across_a_gap_or_of_a_few_samples() -> None:
    recording = lost(swing())
    keep = (recording.t < recording.t[197]) | (recording.t > recording.t[206])
    off = stray(recording.t[keep], recording["x"][keep], Noise(SCATTER, True))
    # the run at 207 begins a stretch now: nothing before it tells where it should be
    assert np.array_equal(recording.t[keep][off != 0.0], recording.t[[40, *range(500, 506), 903, 904]])
    for few in range(11):
        assert not stray(recording.t[:few], recording["x"][:few], Noise(SCATTER, True)).any()


def test_what_is_left_is_diagnosed_as_if_nothing_had_strayed() -> None:
    asked = Asked(Restoring.SPRING, zero_free=False)
    problem, notes = prepare(lost(swing()), asked)
    (said,) = [note for note in notes if "stray" in note]
    assert said == (
        "12 samples of x stray from the motion by up to 0.021 m and come back at once (the first at t = 0.2 s): skipped"
    )
    assert problem.t.size == swing().t.size - 12
    outcome = diagnose(problem)
    assert [m.name for m in outcome.mechanisms] == ["quadratic-drag"]
    assert outcome.refined.model.terms[0].values[0] == pytest.approx(2.0, rel=2e-3)
    assert outcome.refined.chi2 / outcome.refined.points == pytest.approx(1.0, abs=0.1)
    found, clean = outcome.refined, prepare(swing(), asked)[0]
    same = fit(found.model, clean, found.free, Scales.of(found.model))
    assert found.model.terms[0].values[0] == pytest.approx(same.model.terms[0].values[0], rel=1e-3)


def test_an_identification_says_it_too() -> None:
    found = estimate(lost(swing()))
    assert any("12 samples of x stray" in warning for warning in found.warnings)


def test_driven_samples_stay_where_they_are_and_count_for_nothing() -> None:
    t: FloatArray = np.arange(2000.0) * 4e-3
    u: FloatArray = 6.0 * np.sin(3.1 * t) + 4.0 * np.sin(7.3 * t)
    noise = SCATTER * np.random.default_rng(1).standard_normal(t.size)
    x = solve(Model(2.0, 3.0, 80.0, 1.5), t, drive=Drive(t, u)).x + noise
    wrong = x.copy()
    for first, by in LOST.items():
        wrong[first : first + len(by)] += by
    problem, notes = prepare(Recording(t, {"x": wrong, "u": u}), Asked(Restoring.SPRING))
    assert any(note.startswith("12 samples of x stray") for note in notes)
    assert np.array_equal(problem.t, t)
    assert np.array_equal(problem.weight["x"] == 0.0, wrong != x)
    assert problem.channels["x"] == pytest.approx(x, abs=5.0 * SCATTER)
    based = fit_base(problem)
    assert based.fit.chi2 / based.fit.points == pytest.approx(1.0, abs=0.1)
    assert based.fit.model.f_k == pytest.approx(1.5, rel=1e-3)
