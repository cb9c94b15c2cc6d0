"""Harmonic forcing against Den Hartog's formula and against an integration that knows only the equation."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.events import EventKind
from harness.core.scenario import Harmonic
from harness.core.slider import Slider
from harness.exact.harmonic import Response, continuous_amplitude, driven, least_force, response

UNDAMPED = Slider(m=1.0, c=0.0, k=100.0, f_k=3.0)


class Integrated:
    """Event-driven integration by scipy: x, v at any time, intervals at rest, extreme positions."""

    def __init__(self, slider: Slider, drive: Harmonic, x: float, v: float, until: float) -> None:
        self.pieces: list[tuple[float, float, object]] = []
        self.rest, self.extremes = 0.0, []

        def force(t: float) -> float:
            return drive.amplitude * math.cos(drive.omega * t + drive.phase)

        t, step = 0.0, 1e-3 / max(slider.omega_n, drive.omega)
        while t < until:
            if v == 0.0:
                self.extremes.append(x)
                load = force(t) - slider.k * x
                if abs(load) <= slider.break_away:
                    end = self._break_away(slider, force, x, t, until, 50 * step)
                    self.pieces.append((t, end, x))
                    self.rest += end - t
                    t = end
                    load = force(t + step) - slider.k * x
                direction = math.copysign(1.0, load)
            else:
                direction = math.copysign(1.0, v)
            if t >= until:
                break

            def slide(t: float, s: FloatArray, direction: float = direction) -> tuple[float, float]:
                pushed = force(t) - slider.c * s[1] - slider.k * s[0] - slider.f_k * direction
                return float(s[1]), float(pushed / slider.m)

            def rest(t: float, s: FloatArray, direction: float = direction, begin: float = t) -> float:
                return float(s[1]) * direction if t > begin + step else 1.0

            rest.terminal, rest.direction = True, -1.0  # type: ignore[attr-defined]
            run = solve_ivp(
                slide, (t, until), (x, v), "DOP853", events=rest, rtol=1e-11, atol=1e-13,
                max_step=200 * step, dense_output=True,
            )  # fmt: skip
            self.pieces.append((t, float(run.t[-1]), run.sol))
            t, x, v = float(run.t[-1]), float(run.y[0, -1]), 0.0
            if run.t_events[0].size == 0:
                v = float(run.y[1, -1])

    @staticmethod
    def _break_away(slider: Slider, force: object, x: float, t: float, until: float, step: float) -> float:
        assert callable(force)

        def margin(time: float) -> float:
            return abs(float(force(time)) - slider.k * x) - slider.break_away

        later = t + step
        while later < until and margin(later) <= 0.0:
            later += step
        # the load may start on the edge itself and recede
        return float(brentq(margin, later - step, later, xtol=1e-14)) if later < until else until

    def __call__(self, t: float) -> tuple[float, float]:
        piece = next(what for begin, end, what in self.pieces if begin <= t <= end)
        if isinstance(piece, float):
            return piece, 0.0
        assert callable(piece)
        x, v = piece(t)
        return float(x), float(v)


def agree(found: Response, slider: Slider, drive: Harmonic) -> None:
    """From the state at t = 0 the integration comes back to it, with the same stops and extremes on the way."""
    x, v, _, _ = found.states(np.array([0.0]))
    truth = Integrated(slider, drive, float(x[0]), float(v[0]), found.period)
    size = max(found.amplitude, slider.x_k)
    times = np.linspace(0.0, found.period, 60)
    xs, vs, _, _ = found.states(times[:-1])
    for t, at, speed in zip(times[:-1], xs, vs, strict=True):
        x_true, v_true = truth(float(t))
        assert at == pytest.approx(x_true, abs=1e-7 * size)
        assert speed == pytest.approx(v_true, abs=1e-6 * size * max(slider.omega_n, drive.omega))
    assert truth(found.period)[0] == pytest.approx(float(x[0]), abs=1e-7 * size)
    assert found.stop_fraction == pytest.approx(truth.rest / found.period, abs=1e-5)
    assert found.amplitude == pytest.approx(0.5 * float(np.ptp(truth.extremes)), rel=1e-6)


def test_den_hartogs_checked_case() -> None:
    """r = 0.8, f = f_k/A = 0.3: the undamped slider m = 1, k = 100, f_k = 3 under 10 N."""
    drive = Harmonic(10.0, 8.0)
    assert 1e3 * continuous_amplitude(UNDAMPED, drive) == pytest.approx(262.610, abs=5e-4)
    found = response(UNDAMPED, drive)
    assert found.stops == found.stop_fraction == 0
    assert found.amplitude == continuous_amplitude(UNDAMPED, drive)
    agree(found, UNDAMPED, drive)


@pytest.mark.parametrize("r", [0.55, 0.8, 0.95, 1.3, 2.5])
@pytest.mark.parametrize("f", [0.05, 0.2, 0.3])
def test_undamped_amplitude_is_the_printed_formula(r: float, f: float) -> None:
    v = 1.0 / (1.0 - r * r)
    u = math.sin(math.pi / r) / (r * (1.0 + math.cos(math.pi / r)))
    drive = Harmonic(3.0 / f, 10.0 * r)
    expected = drive.amplitude / 100.0 * math.sqrt(v * v - (f * u) ** 2)
    assert continuous_amplitude(UNDAMPED, drive) == pytest.approx(expected, rel=1e-12)


def test_random_continuous_motions_agree_with_integration() -> None:
    rng = np.random.default_rng(21)
    for _ in range(8):
        slider = Slider(rng.uniform(0.5, 3), rng.uniform(0.05, 3), rng.uniform(50, 300), rng.uniform(0.5, 3))
        omega = slider.omega_n * rng.uniform(0.6, 2)
        drive = Harmonic(least_force(slider, omega) * rng.uniform(1.05, 4), omega, rng.uniform(-3, 3))
        found = response(slider, drive)
        assert found.stops == 0
        agree(found, slider, drive)


def test_random_motions_with_stops_agree_with_integration() -> None:
    rng = np.random.default_rng(22)
    stops = set()
    for _ in range(14):
        f_k = rng.uniform(0.5, 3)
        f_s = f_k * (1.0 if rng.random() < 0.5 else rng.uniform(1, 1.5))
        slider = Slider(rng.uniform(0.5, 3), rng.uniform(0, 3), rng.uniform(50, 300), f_k, f_s)
        omega = slider.omega_n * 10 ** rng.uniform(-1, 0.1)
        drive = Harmonic(f_s * rng.uniform(1.1, 2.5), omega, rng.uniform(-3, 3))
        found = response(slider, drive)
        stops.add(found.stops)
        agree(found, slider, drive)
    assert {0, 2} < stops  # continuous, two stops a cycle, and more


def test_the_limit_parts_motion_with_stops_from_motion_without() -> None:
    for omega in (6.0, 8.0, 13.0):
        slider = Slider(1.0, 0.4, 100.0, 3.0)
        least = least_force(slider, omega)
        above = response(slider, Harmonic(1.0001 * least, omega))
        below = response(slider, Harmonic(0.9999 * least, omega))
        assert above.stops == 0
        assert below.stops > 0
        assert 0.0 < below.stop_fraction < 0.1
        assert above.amplitude == pytest.approx(below.amplitude, rel=0.005)
        with pytest.raises(InputError, match=r"drive: amplitude: .* with which the slider stops; expected .* or more"):
            continuous_amplitude(slider, Harmonic(0.999 * least, omega))


def test_no_force_keeps_an_undamped_slider_moving_at_a_third_of_its_frequency() -> None:
    assert least_force(UNDAMPED, 10.0 / 3.0) == math.inf


def test_frictionless_response_is_the_linear_one() -> None:
    slider, drive = Slider(1.0, 0.5, 100.0, 0.0), Harmonic(2.0, 7.0, 0.4)
    expected = 2.0 / math.hypot(100.0 - 49.0, 0.5 * 7.0)
    assert continuous_amplitude(slider, drive) == pytest.approx(expected, rel=1e-13)
    assert least_force(slider, 7.0) == 0.0


def test_below_break_away_it_never_moves() -> None:
    found = response(Slider(1.0, 0.5, 100.0, 3.0, 4.0), Harmonic(3.9, 3.0))
    assert (found.amplitude, found.stop_fraction, found.stops) == (0.0, 1.0, 1)


@pytest.mark.parametrize("start", [(0.0, 0.0), (0.3, 0.0), (-0.2, 2.0)])
def test_transient_from_any_start_agrees_with_integration(start: tuple[float, float]) -> None:
    slider, drive = Slider(1.0, 0.3, 100.0, 3.0, 3.6), Harmonic(5.0, 4.0, 0.7)
    t = np.linspace(0.0, 6.0, 200)
    run = driven(slider, drive, *start, 6.0).sample(t)
    truth = Integrated(slider, drive, *start, 6.0)
    for j, time in enumerate(t):
        assert run.x[j] == pytest.approx(truth(float(time))[0], abs=1e-8)
    assert run.u is not None
    np.testing.assert_allclose(run.u, 5.0 * np.cos(4.0 * t + 0.7))


def test_equation_and_jumps_hold_at_every_event() -> None:
    slider, drive = Slider(1.0, 0.3, 100.0, 3.0, 3.6), Harmonic(5.0, 4.0)
    motion = driven(slider, drive, 0.0, 0.0, 10.0)
    events = motion.events()
    assert set(events.kind.tolist()) >= {EventKind.STICK, EventKind.BREAK_AWAY}
    breaks = events.of(EventKind.BREAK_AWAY)
    np.testing.assert_allclose(np.abs(breaks.a_after), 0.6, rtol=1e-9)  # (f_s - f_k)/m
    assert np.all(breaks.a_before == 0.0)
    load = 5.0 * np.cos(4.0 * breaks.t) - 100.0 * breaks.x
    np.testing.assert_allclose(np.abs(load), 3.6, rtol=1e-12)
    run = motion.sample(np.linspace(0.0, 10.0, 3001))
    assert run.mode is not None
    assert run.u is not None
    friction = run.u - run.a - 0.3 * run.v - 100.0 * run.x
    slips = run.mode != 0
    np.testing.assert_allclose(friction[slips], 3.0 * run.mode[slips], atol=1e-11)
    assert np.all(np.abs(friction[~slips]) <= 3.6 + 1e-12)


def test_sign_of_the_amplitude_is_half_a_turn() -> None:
    one = response(UNDAMPED, Harmonic(-5.0, 3.0, 0.2))
    two = response(UNDAMPED, Harmonic(5.0, 3.0, 0.2 + math.pi))
    assert one.amplitude == pytest.approx(two.amplitude, rel=1e-12)


@pytest.mark.parametrize(
    ("omega", "message"),
    [
        (
            10.0,
            "drive: omega: 10 rad/s, the natural frequency of a slider without viscous damping; expected another",
        ),
        (0.0, "drive: omega: 0; expected a number above 0 rad/s"),
    ],
)
def test_bad_input(omega: float, message: str) -> None:
    with pytest.raises(InputError) as caught:
        response(UNDAMPED, Harmonic(5.0, omega))
    assert str(caught.value).startswith(message)
