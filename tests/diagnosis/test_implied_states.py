"""What a motion implies: internal states, cubics as wide as it lets them be, the force that is left over."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from harness.core.arrays import FloatArray
from harness.core.slider import PAPER
from harness.diagnosis.alignment.consistency import Consistency, consistency
from harness.diagnosis.explain.force_map import ForceMap, force_map, write_history, write_map
from harness.diagnosis.motion import Motion, motion_of
from harness.diagnosis.smoothed_state.local_cubics import longest_interval, smoothed
from harness.estimate.noise import Noise
from harness.exact.decay import Decay, free_decay
from harness.model.registry import term
from harness.model.term import History, States
from harness.model.terms.attached_mode import ridden

SIGMA, F_K = 500.0, 2.0
TIMES: FloatArray = np.asarray(np.arange(30001) * 1e-4, dtype=np.float64)
AT: FloatArray = TIMES[[7000, 13000, 29000]]


def speed(t: float) -> float:
    return float(0.3 * np.cos(5.0 * t) + 0.1 * np.sin(11.0 * t))


def history(f_k: float = F_K) -> History:
    v = 0.3 * np.cos(5.0 * TIMES) + 0.1 * np.sin(11.0 * TIMES)
    return History(TIMES, v, AT, np.interp(AT, TIMES, v), f_k)


GAINS: dict[tuple[str, tuple[float, ...]], Callable[[float], float]] = {
    ("presliding", ()): lambda w: 1.0 - w,
    ("presliding:free", (0.7,)): lambda w: max(1.0 - w, 0.0) ** 0.7,
    ("presliding:free", (1.7,)): lambda w: max(1.0 - w, 0.0) ** 1.7,
    ("presliding:free-yield", (4.0,)): lambda w: 1.0 - max(w, 0.0) ** 4.0,
}
"""What bristles at a share w of their full deflection gain of a way, by the law and the shape that is free."""


def bent(key: str, values: tuple[float, ...], motion: History) -> States:
    law = term(key)
    assert law.implied is not None
    return law.implied(values, motion)


@pytest.mark.parametrize(("key", "shape"), GAINS)
def test_bristles_bend_along_the_way_as_the_equation_in_time_says(key: str, shape: tuple[float, ...]) -> None:
    """z' = v g(w), w = sigma0 z/f_k in the direction of v (Dahl 1968; Bouc, Wen), fully bent at first."""
    gains = GAINS[key, shape]

    def rate(t: float, z: FloatArray) -> list[float]:
        v = speed(t)
        return [v * gains(float(np.copysign(SIGMA * z[0] / F_K, z[0] * v)))]

    exact = solve_ivp(rate, (0.0, 3.0), [F_K / SIGMA], t_eval=AT, rtol=1e-10, atol=1e-14, max_step=1e-3).y[0]
    # close to the full deflection the free exponent fades in proportion
    assert bent(key, (SIGMA, 1.0, *shape), history()).values.ravel() == pytest.approx(
        exact, rel=1e-3 if shape else 1e-6
    )


@pytest.mark.parametrize(("key", "shape"), GAINS)
def test_their_partials_are_differences(key: str, shape: tuple[float, ...]) -> None:
    values = np.array([SIGMA, 1.0, *shape])
    found = bent(key, tuple(values), history()).by
    for i in range(0, values.size, 2):
        h = 1e-6 * values[i] * np.eye(values.size)[i]
        more, less = (bent(key, tuple(values + sign * h), history()).values for sign in (1.0, -1.0))
        assert found[i] == pytest.approx((more - less) / (2.0 * h[i]), rel=1e-5, abs=1e-11)
    more, less = (bent(key, tuple(values), history(F_K + h)).values for h in (1e-7, -1e-7))
    assert found["f_k"] == pytest.approx((more - less) / 2e-7, rel=1e-5)


def test_what_never_moved_or_has_no_friction_is_not_bent() -> None:
    still = History(np.array([0.0, 1.0]), np.zeros(2), np.array([1.0]), np.zeros(1), F_K)
    for key, shape in GAINS:
        assert bent(key, (SIGMA, 0.0, *shape), still).values.item() == 0.0
        assert bent(key, (SIGMA, 0.0, *shape), history(0.0)).values.ravel() == pytest.approx(np.zeros(3))


def test_a_mass_that_rides_along_is_shaken_as_its_equation_says() -> None:
    """r'' = -omega^2 r - 2 zeta omega r' - x'', at rest at first; the speed is relative to the slider's."""
    omega, zeta = 21.0, 0.03

    def acceleration(t: float) -> float:
        return float(-1.5 * np.sin(5.0 * t) + 1.1 * np.cos(11.0 * t))

    exact = solve_ivp(
        lambda t, z: [z[1], -(omega**2) * z[0] - 2.0 * zeta * omega * z[1] - acceleration(t)],
        (0.0, 3.0), [0.0, 0.0], t_eval=AT, rtol=1e-11, atol=1e-14,
    ).y.T  # fmt: skip
    found = ridden((omega, 0.1, zeta), history())
    assert found.values == pytest.approx(exact, abs=1e-6 * np.abs(exact).max())
    more = ridden((omega, 0.1, zeta + 1e-4), history()).values - ridden((omega, 0.1, zeta - 1e-4), history()).values
    assert found.by[2] == pytest.approx(more / 2e-4, rel=1e-3, abs=1e-6)


@pytest.mark.parametrize("zeta", [0.0, 1.0])
def test_a_riding_mass_without_and_with_critical_damping_stays_finite(zeta: float) -> None:
    assert np.all(np.isfinite(ridden((21.0, 0.1, zeta), history()).values))


_SIGMA = 3e-6


def _there_and_back(t: FloatArray) -> FloatArray:
    """10 mm/s one way and the other, a second each, with .2 s at rest between; no time is lost in stopping."""
    v = np.where(t % 1.2 < 1.0, 0.01, 0.0) * np.where(t // 1.2 % 2 < 1, 1.0, -1.0)
    return np.concatenate(([0.0], np.cumsum(v[:-1] * np.diff(t))))


def _noisy(x: FloatArray, seed: int) -> FloatArray:
    return np.asarray(x + _SIGMA * np.random.default_rng(seed).standard_normal(x.size), dtype=np.float64)


def test_a_stop_is_not_rounded_off() -> None:
    t: FloatArray = np.arange(4000.0) * 5e-3
    x = _there_and_back(t)
    longest, y = longest_interval(t), _noisy(x, 1)
    wide, fitting = (smoothed(t, y, longest, _SIGMA, 1.05, everywhere=each) for each in (False, True))
    stops = np.flatnonzero(np.abs(np.diff(x, 2)) > 1e-9) + 1
    beside = np.unique(np.clip(stops[:, None] + np.arange(-15, 16), 0, t.size - 1))
    assert np.min(wide.half) == np.max(wide.half) == np.max(fitting.half)
    assert np.max(np.abs(wide.value - x)) > 20.0 * _SIGMA
    # nine samples, the fewest, still see a corner as a cubic
    assert np.max(np.abs(fitting.value - x)) < 9.0 * _SIGMA
    rounded, kept = (np.sqrt(np.mean((one.value - x)[beside] ** 2)) for one in (wide, fitting))
    assert kept < 0.25 * rounded
    # in the middle of a run, and of a rest, it is as wide as ever
    assert np.mean(fitting.half == np.max(wide.half)) > 0.4


@given(seed=st.integers(0, 10_000), omega=st.floats(2.0, 8.0))
@settings(max_examples=20, deadline=None)
def test_a_motion_that_never_stops_is_smoothed_as_ever(seed: int, omega: float) -> None:
    t: FloatArray = np.arange(2000.0) * 2e-3
    y = _noisy(0.01 * np.sin(omega * t), seed)
    wide, fitting = (smoothed(t, y, longest_interval(t), _SIGMA, 1.05, everywhere=each) for each in (False, True))
    # one window in 100,000 leaves so much by chance, and draws its neighbours along
    assert np.mean(fitting.half < wide.half) < 0.05
    same = fitting.half == wide.half
    assert fitting.value[same] == pytest.approx(wide.value[same], abs=0.0)
    assert np.max(np.abs(np.diff(fitting.half))) <= 1


OMEGA, DAMPING, DRAG = 10.0, 0.6, 0.003
T = np.arange(0.0, 6.0, 0.002)
NOISE = {"x": 1e-4, "v": 1e-3, "a": 1e-2}


def swing(drag: float) -> dict[str, FloatArray]:
    def slope(t: float, y: FloatArray) -> list[float]:
        return [y[1], -(OMEGA**2) * y[0] - DAMPING * y[1] - drag * abs(y[1]) * y[1]]

    x, v = solve_ivp(slope, (0.0, 6.0), [1.0, 0.0], t_eval=T, rtol=1e-10, atol=1e-12).y
    return {"x": x, "v": v, "a": -(OMEGA**2) * x - DAMPING * v - drag * np.abs(v) * v}


def mapped(channels: str) -> tuple[ForceMap, FloatArray]:
    rng = np.random.default_rng(0)
    base, real = swing(0.0), swing(DRAG)
    residual = {c: real[c] - base[c] + rng.normal(0.0, NOISE[c], T.size) for c in channels}
    motion = Motion(base["x"], base["v"], np.zeros(T.size, dtype=np.bool_), OMEGA)
    found = force_map(T, residual, {c: NOISE[c] for c in channels}, motion, DAMPING, np.full(T.size, OMEGA**2))
    return found, DRAG * np.abs(real["v"]) * real["v"]


@pytest.mark.parametrize(("channels", "share"), [("x", 0.25), ("v", 0.25), ("a", 1.0), ("xa", 0.1)])
def test_the_force_left_over_is_the_one_put_in(channels: str, share: float) -> None:
    found, true = mapped(channels)
    assert np.sqrt(np.mean((found.force - true) ** 2)) < share * np.sqrt(np.mean(true**2))
    assert np.mean(np.abs(found.force - true) < 2.0 * found.stderr) > 0.9
    law = DRAG * np.abs(found.v) * found.v
    assert np.mean(np.abs(found.cell_force - law) < 2.0 * found.cell_stderr) > 0.85


def test_maps_are_tables(tmp_path: Path) -> None:
    found, _ = mapped("xa")
    write_map(tmp_path / "map.csv", found)
    write_history(tmp_path / "time.csv", found)
    assert (tmp_path / "map.csv").read_text().startswith("x,v,force,stderr,samples\n")
    rows = np.loadtxt(tmp_path / "map.csv", delimiter=",", skiprows=1)
    assert rows[:, 4].sum() == T.size
    assert np.loadtxt(tmp_path / "time.csv", delimiter=",", skiprows=1).shape == (T.size, 3)


def test_nothing_is_said_of_a_rest() -> None:
    t = np.linspace(0.0, 2.999, 3000)
    exact = free_decay(Decay.of(PAPER, 1.0), t)
    motion = motion_of(t, {"x": exact.x}, OMEGA)
    rest = t > 2.6
    assert np.all(motion.stuck[rest])
    x = np.random.default_rng(1).normal(0.0, 1e-4, t.size)
    found = force_map(t, {"x": x}, {"x": 1e-4}, motion, 1.0, np.full(t.size, 100.0))
    assert np.all(np.isnan(found.force[rest]))
    assert np.all(np.isfinite(found.force[t < 2.4]))


def pair(gain: float = 1.0, lag: float = 0.0, offset: float = 0.0, seed: int = 0, mixed: bool = False) -> Consistency:
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 2.399, 2400)
    exact = free_decay(Decay.of(PAPER, 1.0), t)
    x = np.interp(np.maximum(t - lag, 0.0), t, exact.x) + rng.normal(0.0, 1e-4, t.size)
    a = gain * exact.a + offset + rng.normal(0.0, 0.05, t.size)
    if mixed:
        a = np.sin(17.3 * t)
    return consistency(t, {"x": x, "a": a}, {"x": Noise(1e-4, True), "a": Noise(0.05, True)}, OMEGA)[0]


def test_channels_of_one_motion_agree() -> None:
    found = [pair(seed=seed) for seed in range(40)]
    assert sum(not f.consistent for f in found) <= 2
    assert found[0].sentence == "acceleration agrees with displacement"


def test_gain_lag_and_offset_are_those_put_in() -> None:
    found = pair(1.02, 0.003, 0.2)
    for quantity, true in ((found.gain, 1.02), (found.lag, 0.003), (found.offset, 0.2)):
        assert quantity.value is not None
        assert quantity.stderr is not None
        assert abs(quantity.value - true) < 4.0 * quantity.stderr
    assert found.sentence.startswith("acceleration is 1.02 times what displacement says and is early by 0.003")


@pytest.mark.parametrize(
    ("gain", "mixed", "sentence"),
    [
        (1e3, False, "acceleration is about 1000 times what displacement says, as where a is in mm/s^2"),
        (1e-3, False, "acceleration is about 1/1000 times what displacement says, as where x is in mm"),
        (-1.0, False, "acceleration and displacement do not belong together (they move against each other)"),
        (1.0, True, "acceleration and displacement do not belong together"),
    ],
)
def test_channels_that_cannot_be_are_told(gain: float, mixed: bool, sentence: str) -> None:
    found = pair(gain, mixed=mixed)
    assert not found.consistent
    assert found.sentence.startswith(sentence)
