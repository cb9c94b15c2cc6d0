"""What holds before a number is read from a recording: it moves, its channels agree, and the model meets the noise."""

from collections.abc import Callable, Sequence
from contextlib import suppress

import numpy as np
import pytest

import harness
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.exact.decay import Decay, free_decay
from harness.model.model import ModelTerm

W, ZETA, X_K, X0 = 8.0, 0.02, 1e-3, 0.1
Channels = dict[str, FloatArray]


def swing(channels: str = "xa", drag: float = 0.0, n: int = 700) -> Recording:
    """A free decay of some ten cycles with noise of a thousandth."""
    rng = np.random.default_rng(4)
    t = np.linspace(0.0, 8.0, n)
    slider = Slider(1.0, 2.0 * ZETA * W, W * W, X_K * W * W)
    exact = free_decay(Decay.of(slider, X0), t) if drag == 0.0 else _with_drag(drag, t)
    size = {"x": X0, "v": X0 * W, "a": X0 * W * W}
    noisy = {c: getattr(exact, c) + 1e-3 * size[c] * rng.standard_normal(n) for c in channels}
    return Recording(t, noisy, "rec.csv")


def _with_drag(drag: float, t: FloatArray) -> Trajectory:
    terms = (ModelTerm.named("quadratic-drag", c2=drag),)
    model = harness.Model(1.0, 2.0 * ZETA * W, W * W, X_K * W * W, x0=X0, terms=terms)
    return harness.simulate(model, t)


def changed(change: Callable[[Channels], Channels], channels: str = "xa") -> Recording:
    found = swing(channels)
    return Recording(found.t, {**found.channels, **change(dict(found.channels))}, "rec.csv")


def at_rest(kind: str) -> Recording:
    rng = np.random.default_rng(1)
    y = {
        "white noise": 1e-3 * rng.standard_normal(600),
        "stuck": np.full(600, 0.02) + 1e-3 * (np.arange(600) == 100),
        "drift": np.linspace(0.0, 0.1, 600) + 1e-3 * rng.standard_normal(600),
        "relaxing": 0.1 * (1.0 - np.exp(-np.linspace(0.0, 4.0, 600))) + 2e-3 * rng.standard_normal(600),
    }[kind]
    return Recording(np.linspace(0.0, 6.0, 600), {"x": y}, "rec.csv")


@pytest.mark.parametrize("kind", ["white noise", "stuck", "drift", "relaxing"])
def test_what_does_not_move_gets_no_number(kind: str) -> None:
    still = at_rest(kind)
    with pytest.raises(InputError):
        harness.identify(still)
    with pytest.raises(InputError):
        harness.diagnose(still, engines=())
    noise = Recording(still.t, {"x": 1e-3 * np.random.default_rng(2).standard_normal(still.t.size)}, "sim.csv")
    for simulation in (swing("x"), noise):
        with suppress(InputError):
            assert harness.compare(simulation, still).verdict == "different"


FAULTS = [
    (lambda y: {"a": y["a"] / 9.80665}, "xa", "9.81"),
    (lambda y: {"v": y["v"] / 1.66}, "xv", "1.66 times too small"),
    (lambda y: {"a": np.clip(y["a"], -4.0, 4.0)}, "xa", "acceleration stops at -4 and 4 m/s^2"),
    (lambda y: {"a": np.clip(y["a"], -4.0, 4.0)}, "a", "acceleration stops at -4 and 4 m/s^2"),
]


@pytest.mark.parametrize(("change", "channels", "told"), FAULTS)
def test_a_wrong_scale_or_a_limit_is_told(change: Callable[[Channels], Channels], channels: str, told: str) -> None:
    recording = changed(change, channels)
    asked: tuple[Callable[[], Sequence[str]], ...] = (
        lambda: harness.identify(recording).warnings,
        lambda: harness.compare(swing(channels), recording).sentences,
    )
    for ask in asked:
        try:
            said = ask()
        except InputError as error:
            said = [str(error)]
        assert any(told in line for line in said)


def test_a_channel_of_the_other_sign_is_refused_with_what_mends_it() -> None:
    with pytest.raises(InputError, match=r"Try: --columns 'a=-1\*a'"):
        harness.identify(changed(lambda y: {"a": -y["a"]}))


def test_numbers_of_a_model_that_misses_something_are_called_biased() -> None:
    found = harness.identify(swing("x", drag=3.0))
    assert any("these numbers are biased" in line and "harness diagnose rec.csv" in line for line in found.warnings)
    assert found.baseline is not None
    assert (found.baseline.chi2_per_point or 0.0) > 4.0
    plain = harness.identify(swing("x"))
    assert not plain.warnings
    assert plain.baseline is not None
    assert plain.baseline.chi2_per_point == pytest.approx(1.0, abs=0.2)


def other(recording: Recording, scale: float, clock: float, ahead: float, every: int) -> Recording:
    """The same motion in another unit of length, on another clock, by every so many samples."""
    by = {"x": scale, "v": scale / clock, "a": scale / clock**2}
    kept = slice(None, None, every)
    return Recording(
        clock * recording.t[kept] + ahead, {c: by[c] * y[kept] for c, y in recording.channels.items()}, "rec.csv"
    )


@pytest.mark.parametrize(
    ("scale", "clock", "ahead", "every"),
    [(-1e3, 1.0, 0.0, 1), (1.0, 2.5, 0.0, 1), (1.0, 1.0, 1.7e9, 1), (-1e-3, 0.4, -30.0, 2)],
)
def test_unit_clock_sign_and_half_of_the_samples_change_no_answer(
    scale: float, clock: float, ahead: float, every: int
) -> None:
    plain = harness.identify(swing())
    seen = harness.identify(other(swing(), scale, clock, ahead, every))
    assert plain.warnings == []
    # 96 m each way in a second: whether that is in mm is asked, and nothing else
    assert [line.split(": ")[1] for line in seen.warnings] == (["is x in mm?"] if abs(scale) > 100.0 else [])
    for method in ("acceleration", "displacement"):
        one, again = plain.estimates[method], seen.estimates[method]
        by = {"omega_n": 1.0 / clock, "zeta": 1.0, "x_k": abs(scale)}
        for name, factor in by.items():
            first, second = getattr(one, name), getattr(again, name)
            if first.value is None:
                assert second.value is None
                continue
            assert abs(second.value / factor - first.value) < 3.0 * (first.stderr + second.stderr / factor)


def test_a_steady_speed_of_few_counts_is_no_saturated_sensor() -> None:
    rng = np.random.default_rng(5)
    steps = rng.integers(-1, 2, 400).astype(float)
    with pytest.raises(InputError, match=r"3 values in all, 0\.1 apart: its sensor's steps"):
        harness.diagnose(Recording(np.arange(400) / 100.0, {"v": 2.4 + 0.1 * steps}, "motor.csv"))
