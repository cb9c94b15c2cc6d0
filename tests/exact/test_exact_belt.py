"""Stick-slip on a belt against an integration that knows only the equation, and the cases without a cycle."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from harness.core.errors import InputError
from harness.core.events import EventKind, Mode
from harness.core.scenario import CurveBelt, Hold
from harness.core.slider import PAPER, Slider
from harness.exact.belt import LimitCycle, SteadySliding, curve_cycle, limit_cycle
from harness.exact.decay import creep
from harness.kernels.solve import Drive, simulate
from harness.model.model import Model, ModelTerm

CHECKED = Slider(m=1.0, c=0.2, k=100.0, f_k=3.0, f_s=4.0)


def integrated_slip(slider: Slider, speed: float) -> tuple[float, float] | None:
    """Time and position at the end of the slip after break-away, from scipy; None when the slider never catches up."""
    start = (slider.break_away - slider.c * speed) / slider.k

    def slide(_: float, s: np.ndarray) -> tuple[float, float]:
        return s[1], (slider.f_k - slider.c * s[1] - slider.k * s[0]) / slider.m

    def caught(t: float, s: np.ndarray) -> float:
        # the start itself is no catch
        return float(s[1] - speed) if t > 0.0 else -1.0

    caught.terminal, caught.direction = True, 1.0  # type: ignore[attr-defined]
    span = (0.0, 20.0 / slider.omega_n)
    run = solve_ivp(slide, span, (start, speed), "DOP853", events=caught, rtol=1e-12, atol=1e-14)
    return (float(run.t_events[0][0]), float(run.y_events[0][0, 0])) if run.t_events[0].size else None


def test_the_checked_case() -> None:
    cycle = limit_cycle(CHECKED, 0.1)
    assert isinstance(cycle, LimitCycle)
    assert cycle.period == pytest.approx(0.6658, abs=5e-5)
    assert cycle.stick_fraction == pytest.approx(0.2830, abs=5e-5)
    # counted with a threshold of 1 mm/s, a hundredth of the belt's speed, it reads 0.286
    assert cycle.fraction_within(1e-3) == pytest.approx(0.286, abs=5e-4)
    assert cycle.fraction_within(0.0) == pytest.approx(cycle.stick_fraction, rel=1e-12)
    assert cycle.fraction_within(1.0) == 1.0


def test_random_sliders_agree_with_integration() -> None:
    rng = np.random.default_rng(12)
    cycles = 0
    for _ in range(60):
        f_k = rng.uniform(0.5, 5)
        slider = Slider(rng.uniform(0.5, 3), rng.uniform(0, 4), rng.uniform(20, 500), f_k, f_k * rng.uniform(1.05, 2))
        speed = float(10 ** rng.uniform(-2.5, 0.3))
        cycle, truth = limit_cycle(slider, speed), integrated_slip(slider, speed)
        if truth is None:
            assert isinstance(cycle, SteadySliding)
            assert cycle.x == slider.x_k
            continue
        cycles += 1
        assert isinstance(cycle, LimitCycle)
        assert cycle.slip_time == pytest.approx(truth[0], rel=1e-8)
        assert cycle.stick_x == pytest.approx(truth[1], abs=1e-9)
        # while it sticks the spring is loaded at the speed of the belt
        assert cycle.stick_time == pytest.approx((cycle.break_away_x - truth[1]) / speed, rel=1e-6, abs=1e-8)
    assert 20 < cycles < 60


def test_samples_obey_the_equation_and_repeat() -> None:
    cycle = limit_cycle(CHECKED, 0.1)
    assert isinstance(cycle, LimitCycle)
    t = np.linspace(-0.3, 2.0, 2301)
    run = cycle.sample(t)
    assert run.mode is not None
    slips = run.mode == Mode.SLIP_NEGATIVE
    force = CHECKED.m * run.a + CHECKED.c * run.v + CHECKED.k * run.x
    np.testing.assert_allclose(force[slips], CHECKED.f_k, rtol=1e-12)
    assert np.all(np.abs(force[~slips]) <= CHECKED.break_away + 1e-12)
    assert np.all(run.v[~slips] == 0.1)
    again = cycle.sample(t + 3 * cycle.period)
    np.testing.assert_allclose(again.x, run.x, atol=1e-13)
    fine = cycle.sample(np.linspace(0, cycle.period, 40001)).x
    assert np.max(fine) == pytest.approx(cycle.highest, abs=1e-9)
    assert np.min(fine) == pytest.approx(cycle.lowest, abs=1e-9)
    assert cycle.amplitude == pytest.approx(0.5 * np.ptp(fine), abs=1e-9)


def test_events_of_the_cycle() -> None:
    cycle = limit_cycle(CHECKED, 0.1)
    assert isinstance(cycle, LimitCycle)
    events = cycle.sample(np.linspace(0.0, 2 * cycle.period, 100)).events
    kinds = [EventKind.BREAK_AWAY, EventKind.STICK] * 2 + [EventKind.BREAK_AWAY]
    assert list(events.kind) == kinds
    # at break-away the friction drops from f_s to f_k
    assert events.a_after[0] == pytest.approx(-(4.0 - 3.0) / 1.0, rel=1e-12)
    assert events.a_before[0] == events.a_after[1] == 0.0


@pytest.mark.parametrize(
    ("slider", "why"),
    [
        (Slider(1, 0.2, 100, 3), "f_s does not exceed f_k"),
        (Slider(1, 30, 100, 3, 4), "the slider is not underdamped"),
        (Slider(1, 4, 100, 3, 3.01), "viscous damping keeps the slip slower than the belt"),
    ],
)
def test_steady_sliding_says_why(slider: Slider, why: str) -> None:
    assert limit_cycle(slider, 0.1) == SteadySliding(slider.x_k, why)


def test_belt_and_hold_refuse_what_they_are_not_for() -> None:
    with pytest.raises(InputError, match=r"belt: speed: 0; expected a number above 0 m/s"):
        limit_cycle(CHECKED, 0.0)
    with pytest.raises(InputError, match=r"hold: force: 3.5 N; expected a load of at most f_s = 3 N"):
        creep(PAPER, Hold(3.5))
    assert creep(PAPER, Hold(-2.91)) == 0.0


def test_a_belt_with_a_curve_moves_as_the_event_driven_reference() -> None:
    rng = np.random.default_rng(5)
    for number in range(6):
        f_k = float(rng.uniform(1.0, 4.0))
        slider = Slider(
            rng.uniform(0.5, 3), rng.uniform(0, 0.4), rng.uniform(80, 300), f_k, f_k * rng.uniform(1.2, 1.6)
        )
        drop = slider.break_away - f_k
        speed = float(drop / slider.k * slider.omega_n * rng.uniform(0.5, 1.2))
        c_2 = 0.03 * drop / speed**2 if number % 2 else 0.0
        belt = CurveBelt(speed, speed * float(rng.uniform(0.3, 1.0)), c_2)
        cycle = curve_cycle(slider, belt)
        assert isinstance(cycle, LimitCycle)
        # in the belt's frame the spring's end moves back; the catalogue's terms say the curve
        terms = [ModelTerm.named("stribeck", f_s=slider.break_away, v_s=belt.v_s)]
        terms += [ModelTerm.named("quadratic-drag", c2=c_2)] if c_2 else []
        start = cycle.stick_x + 0.5 * speed * cycle.stick_time
        model = Model(slider.m, slider.c, slider.k, f_k, x0=start).with_terms(*terms)
        until = 3.0 * cycle.period
        force = [-slider.c * speed, -slider.c * speed - slider.k * speed * until]
        t = np.linspace(0.0, until, 200)
        moved = simulate(model, t, Drive(np.array([0.0, until]), np.array(force)))
        ahead = cycle.slip_time + 0.5 * cycle.stick_time
        np.testing.assert_allclose(moved.x + speed * t, cycle.sample(t + ahead).x, atol=1e-8)
        leaves = moved.events.of(EventKind.BREAK_AWAY).t
        np.testing.assert_allclose(np.diff(leaves), cycle.period, rtol=1e-8)


def test_a_steep_curve_is_the_jump_and_a_flat_one_ends_stick_slip() -> None:
    jump = limit_cycle(CHECKED, 0.1)
    assert isinstance(jump, LimitCycle)
    off = []
    for v_s in (1e-3, 5e-4):
        steep = curve_cycle(CHECKED, CurveBelt(0.1, v_s))
        assert isinstance(steep, LimitCycle)
        off.append(abs(steep.period / jump.period - 1.0))
    assert off[1] < 0.8 * off[0] < 0.01
    assert curve_cycle(CHECKED, CurveBelt(0.1, 0.05, 100.0)).why == "the slip stays slower than the belt"  # type: ignore[union-attr]
