"""The integrator's motion and sensitivities: closed forms, its order, events, energy, and differences."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from kernel_cases import DRIVE, VALUES, difference_error, goal, model, term

from benchmarks.exact_sensitivity import PARAMETERS, fill_sensitivities
from harness.core.errors import InputError, SimulationError
from harness.core.events import EventKind
from harness.core.slider import PAPER, Slider
from harness.exact.decay import Decay, free_decay
from harness.kernels.solve import Drive, Effort, simulate, solve
from harness.model.model import Model, ModelTerm, Restoring

PAPER_STICKS_AT = 0.010511325485945064


@given(
    st.floats(0.0, 1.4),
    st.floats(0.0, 3.0),
    st.floats(-1.0, 1.0),
    st.floats(0.0, 0.4),
    st.floats(-1.0, 1.0),
    st.floats(-1.0, 1.0),
)
def test_agrees_with_the_closed_form(
    zeta: float, log_k: float, log_m: float, share: float, x0: float, speed: float
) -> None:
    k, m = 10.0**log_k, 10.0**log_m
    slider = Slider(m, 2.0 * zeta * math.sqrt(k * m), k, share * k)
    w, size = slider.omega_n, max(abs(x0), abs(speed), 1e-3)
    t = np.linspace(0.0, 25.0 / w, 301)
    exact = free_decay(Decay.of(slider, x0, speed * w), t)
    ours = solve(Model.of_slider(slider, x0, speed * w), t, effort=Effort(1e-13))
    clear = np.all(np.abs(t[:, None] - exact.events.t[None, :]) > 1e-8 / w, axis=1) if len(exact.events) else t >= 0
    assert np.abs(ours.x - exact.x).max() < 1e-10 * size
    assert np.abs(ours.v - exact.v).max() < 1e-10 * size * w
    assert np.abs(ours.a - exact.a)[clear].max() < 1e-10 * size * w * w


def test_the_papers_case_sticks_where_it_is_known_to() -> None:
    s = solve(Model.of_slider(PAPER, 1.0), np.array([3.0]), effort=Effort(1e-14))
    assert s.x[0] == pytest.approx(PAPER_STICKS_AT, abs=1e-13)
    assert (len(s.events), s.events.kind[-1]) == (8, EventKind.STICK)


def test_events_are_those_of_the_closed_form() -> None:
    exact = free_decay(Decay.of(PAPER, 1.0), np.linspace(0.0, 3.0, 10)).events
    ours = simulate(Model.of_slider(PAPER, 1.0), np.linspace(0.0, 3.0, 10), tolerance=1e-13).events
    assert (ours.kind == exact.kind).all()
    for name in ("t", "x", "a_before", "a_after"):
        assert np.abs(getattr(ours, name) - getattr(exact, name)).max() < 2e-10, name


def test_error_falls_with_the_tolerance_at_fifth_order() -> None:
    m, t = model(term("cubic-stiffness"), term("stribeck")), np.linspace(0.0, 3.0, 50)
    best = solve(m, t, effort=Effort(1e-14)).x
    runs = [solve(m, t, effort=Effort(tolerance)) for tolerance in (1e-7, 1e-12)]
    error = [np.abs(run.x - best).max() for run in runs]
    order = math.log(error[0] / error[1]) / math.log(runs[1].steps / runs[0].steps)
    assert 4.5 < order < 6.5


def test_energy_lost_is_the_work_of_friction_and_damping() -> None:
    t = np.linspace(0.0, 3.0, 6001)
    s = solve(Model.of_slider(PAPER, 1.0), t, effort=Effort(1e-12))
    stored = 0.5 * PAPER.m * s.v**2 + 0.5 * PAPER.k * s.x**2
    power = PAPER.c * s.v**2 + PAPER.f_k * np.abs(s.v)
    lost = np.concatenate(([0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(t))))
    assert np.abs(stored + lost - stored[0]).max() < 2e-5 * stored[0]


def test_samples_before_the_release_show_it_held_and_after_sticking_at_rest() -> None:
    m = Model(1.0, 1.0, 100.0, 3.0, x0=1.0, v0=2.0, t0=0.5)
    s = solve(m, np.array([-1.0, 0.2, 0.5, 9.0]), ("x0",))
    assert (s.x[:3] == 1.0).all()
    assert s.v.tolist() == [0.0, 0.0, 2.0, 0.0]
    assert s.dx[:3, 0].tolist() == [1.0, 1.0, 1.0]
    assert s.mode.tolist() == [0, 0, 1, 0]
    assert solve(m, np.array([0.1])).x.tolist() == [1.0]
    assert solve(m, np.array([0.5])).a[0] == pytest.approx(-(100.0 + 2.0 + 3.0), abs=1e-12)


def test_samples_are_the_same_whatever_the_gaps() -> None:
    m, t = model(term("stribeck")), np.linspace(0.0, 3.0, 601)
    whole = solve(m, t)
    some = np.r_[0:40, 300:310, 590:601]
    part = solve(m, t[some])
    assert np.abs(part.x - whole.x[some]).max() < 1e-12


def test_stuck_from_the_start() -> None:
    s = solve(Model(1.0, 1.0, 100.0, 3.0, x0=0.02), np.linspace(0.0, 1.0, 5), ("x0", "k"))
    assert s.x.tolist() == [0.02] * 5
    assert (s.dx[:, 0] == 1.0).all()
    assert (s.dx[:, 1] == 0.0).all()
    assert len(s.events) == 0


@pytest.mark.parametrize("law", ["coulomb", "bristle"])
def test_a_knock_moves_it_by_its_impulse(law: str) -> None:
    terms = (term("impulse", 0.5, 2.6),) + ((term("presliding"),) if law == "bristle" else ())
    s = solve(model(*terms, x0=0.0, v0=0.0), np.array([0.4, 0.5, 0.5 + 1e-9]))
    assert s.v[0] == pytest.approx(0.0, abs=1e-12)
    assert s.v[1:] == pytest.approx([2.0, 2.0], abs=1e-6)
    assert s.events.kind[0] == EventKind.KNOCK


@pytest.mark.parametrize("time", [0.0, 3.0])
def test_a_knock_at_the_first_and_the_last_sample_counts(time: float) -> None:
    s = solve(model(term("impulse", time, 1.3), x0=0.0, v0=0.0), np.array([0.0, 3.0]))
    assert (s.v[0] if time == 0.0 else s.v[1]) == pytest.approx(1.0, abs=1e-12)


def test_a_dip_of_the_speed_through_zero_within_a_step_is_seen() -> None:
    m = model(term("harmonic-force", 2.0, 6.0, 1.0), m=1.0, c=0.0, k=1.0, f_k=0.2, x0=0.0, v0=0.8)
    t = np.linspace(0.0, 12.0, 11)
    fine = solve(m, t, effort=Effort(1e-12), shortest_cycle=200.0).events
    coarse = solve(m, t, effort=Effort(3e-4), shortest_cycle=2.0).events
    assert len(fine) > 10
    assert coarse.kind.tolist() == fine.kind.tolist()
    assert np.abs(coarse.t - fine.t).max() < 0.02


def test_break_away_when_the_drive_passes_f_s() -> None:
    drive = Drive(np.array([1.0, 3.0]), np.array([0.0, 8.0]))
    s = solve(Model(1.0, 0.5, 100.0, 3.0, 4.0), np.linspace(0.0, 5.0, 50), drive=drive)
    assert s.events.kind[0] == EventKind.BREAK_AWAY
    assert s.events.t[0] == pytest.approx(2.0, abs=1e-12)
    assert s.events.a_after[0] == pytest.approx(1.0, abs=1e-12)
    assert s.x[-1] > 0.0


def test_a_force_exactly_at_the_limit_holds() -> None:
    drive = Drive(np.array([0.0, 1.0, 2.0]), np.array([0.0, 3.0, 3.0]))
    s = solve(Model(1.0, 0.5, 100.0, 3.0), np.linspace(0.0, 5.0, 20), drive=drive)
    assert (s.x == 0.0).all()


def test_the_drive_is_constant_outside_its_knots() -> None:
    m = Model(1.0, 2.0, 100.0, 0.0)
    for knots in ([-3.0, -2.0], [40.0, 41.0]):
        drive = Drive(np.array(knots), np.array([7.0, 5.0]))
        rest = solve(m, np.array([20.0]), drive=drive).x[0]
        assert rest == pytest.approx((5.0 if knots[0] < 0.0 else 7.0) / 100.0, abs=1e-9)


def test_a_free_axis_stops_after_its_energy_is_gone() -> None:
    m = Model(2.0, 0.0, 0.0, 3.0, restoring=Restoring.NONE, v0=1.5)
    s = solve(m, np.linspace(0.0, 3.0, 4))
    assert s.x[-1] == pytest.approx(0.5 * 2.0 * 1.5**2 / 3.0, rel=1e-12)
    assert s.events.t[0] == pytest.approx(1.0, rel=1e-12)


def test_a_bristle_tends_to_sliding_friction_as_it_stiffens() -> None:
    # after a reversal it unloads over 2 f_k/sigma0: a delay that goes with the root of that
    t = np.linspace(0.0, 1.5, 100)
    sliding = solve(model(), t, effort=Effort(1e-11)).x
    soft, stiff = (solve(model(term("presliding", sigma0, 0.0)), t, effort=Effort(1e-11)) for sigma0 in (1e5, 1e7))
    ratio = np.abs(soft.x - sliding).max() / np.abs(stiff.x - sliding).max()
    assert ratio == pytest.approx(10.0, rel=0.1)
    assert stiff.steps < 5000


def test_a_static_level_below_the_sliding_one_acts_as_that() -> None:
    below, same = model(term("static-friction", 0.5)), model()
    t = np.linspace(0.0, 5.0, 200)
    assert (solve(below, t, drive=DRIVE).x == solve(same, t, drive=DRIVE).x).all()


def test_a_model_at_rest_under_a_push_alone_is_followed() -> None:
    s = solve(model(term("constant-force", 20.0), x0=0.0, v0=0.0), np.array([8.0]))
    assert 0.19 < s.x[0] < 0.25


def test_two_terms_of_a_kind_have_names_of_their_own() -> None:
    m = model(term("attached-mode"), term("attached-mode", 41.0, 0.1, 0.03))
    s = solve(m, np.linspace(0.0, 1.0, 20), ("attached-mode.omega_2", "attached-mode#2.omega_2", (1, 0)))
    assert (s.dx[:, 1] == s.dx[:, 2]).all()
    assert np.abs(s.dx[:, 0] - s.dx[:, 1]).max() > 1e-4


def test_what_cannot_be_followed_is_an_error() -> None:
    with pytest.raises(SimulationError, match="could not be followed beyond"):
        solve(model(term("cubic-stiffness", -400.0)), np.linspace(0.0, 3.0, 30))
    with pytest.raises(SimulationError, match="more than"):
        solve(model(), np.linspace(0.0, 3.0, 30), effort=Effort(1e-12, 10))


def test_a_place_that_cannot_be_passed_costs_few_steps() -> None:
    """A bristle whose load goes to nothing turns infinitely stiff; of a hundred cycles one is paid for."""
    unloaded = model(term("presliding", 4.4, 0.1), term("normal-load-variation", 1.0, 21.6, -2.3))
    with pytest.raises(SimulationError, match=r"beyond t = 0\.\d+ s: it took more than (\d+) steps") as told:
        solve(unloaded, np.linspace(0.0, 80.0, 400), effort=Effort(1e-6, 600))
    assert int(str(told.value).split("more than ")[1].split()[0]) < 5 * 600


BAD = [
    (lambda: solve(model(), np.array([])), r"simulation: t: an array of shape \(0,\); expected a vector"),
    (lambda: solve(model(), np.array([0.0, np.nan])), "simulation: t, row 2: nan; expected a finite number"),
    (lambda: solve(model(), np.array([1.0, 0.5])), "time 0.5 s comes before 1 s; expected times that do not decrease"),
    (
        lambda: solve(model(), np.array([1.0]), ("bogus",)),
        "'bogus' is no parameter of the model; expected one of x0, v0",
    ),
    (lambda: Drive(np.array([0.0, 0.0]), np.array([1.0, 1.0])), "times that increase"),
    (lambda: Drive(np.array([]), np.array([])), "drive: no knots"),
    (lambda: Drive(np.array([0.0]), np.array([np.inf])), "drive: u, row 1: inf"),
    (lambda: solve(model(*[term("attached-mode")] * 6), np.array([1.0])), "14 states; expected at most 12"),
]


@pytest.mark.parametrize(("call", "message"), BAD)
def test_bad_input_is_named(call: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()  # type: ignore[operator]


T = np.linspace(0.0137, 3.0, 151)


@pytest.mark.parametrize("key", VALUES)
def test_every_term_agrees_with_differences(key: str) -> None:
    m = model(term(key))
    error, where, _ = difference_error(m, T)
    assert error < goal(m), where


PAIRS = (
    ("pendulum-stiffness", "tabulated-force"),
    ("tabulated-friction", "tabulated-friction:backward"),
    ("normal-load-variation", "attached-mode"),
    ("friction-drift:free", "tabulated-friction:forward"),
    ("presliding", "pendulum-stiffness"),
    ("end-stop:free", "backlash"),
    ("load-dependent-friction:gravity", "end-stop:positive-free"),
    ("viscoelastic", "quadratic-stiffness"),
    ("end-stop:positive-free", "stiffness-drift"),
    ("constant-force", "tabulated-friction:position"),
    ("normal-load-variation", "power-law-damping"),
    ("cubic-stiffness", "cubic-stiffness:free"),
    ("friction-drift", "pendulum-stiffness"),
    ("end-stop", "stiffness-drift:free"),
    ("regularised-friction:free", "tabulated-stiffness"),
    ("end-stop", "backlash"),
    ("presliding", "quadratic-drag"),
    ("cubic-stiffness:free", "harmonic-force"),
    ("end-stop:free", "tabulated-friction"),
    ("position-dependent-friction:periodic", "tabulated-friction:forward"),
)
"""A few; python -m benchmarks.sensitivities asks all."""


@pytest.mark.parametrize(("first", "second"), PAIRS)
def test_pairs_agree_with_differences(first: str, second: str) -> None:
    m = model(term(first), term(second))
    error, where, _ = difference_error(m, T[::2])
    assert error < 2.0 * goal(m), where


MODULATED = (term("position-dependent-friction"), term("normal-load-variation"))


@pytest.mark.parametrize("law", [(), (term("stribeck"),), (term("presliding", 600.0, 3.0),)])
def test_modulations_of_every_law_agree_with_differences(law: tuple[ModelTerm, ...]) -> None:
    m = model(*law, *MODULATED)
    error, where, _ = difference_error(m, T[::3])
    assert error < 2.0 * goal(m), where


REST = {"x0": 0.15, "v0": 0.3}
DRIVEN = {
    "coulomb": model(**REST),
    "f_s": model(f_s=3.5, **REST),
    "static-friction": model(term("static-friction", 4.0), **REST),
    "stribeck": model(term("stribeck", 4.0, 0.3), **REST),
    "modulated break-away": model(term("stribeck", 4.0, 0.3), *MODULATED, f_k=2.0, **REST),
    "modulated f_s": model(*MODULATED, f_s=3.0, **REST),
    "f_s with a branch": model(term("friction-drift", 0.1), term("viscoelastic", 30.0, 0.5), f_s=3.0, **REST),
    "harmonic on top": model(term("harmonic-force", 3.0, 13.0, 0.4), f_s=3.0, **REST),
    "knock out of stick": model(term("impulse", 2.8, 1.5), f_s=3.0, **REST),
}


@pytest.mark.parametrize("name", DRIVEN)
def test_driven_motion_with_break_away_agrees_with_differences(name: str) -> None:
    error, where, s = difference_error(DRIVEN[name], np.linspace(0.01, 5.9, 201), DRIVE)
    assert np.count_nonzero(s.events.kind == 2) >= 2
    assert error < 2e-6, where


def test_a_free_axis_agrees_with_differences() -> None:
    free = replace(model(**REST, k=1.0), k=0.0, restoring=Restoring.NONE, f_s=3.0)
    error, where, _ = difference_error(free, np.linspace(0.01, 5.9, 201), DRIVE)
    assert error < 2e-6, where


@pytest.mark.parametrize("seed", range(12))
def test_agrees_with_the_derivative_of_the_closed_form(seed: int) -> None:
    rng = np.random.default_rng(seed)
    k, m, zeta = 10.0 ** rng.uniform(0, 3), 10.0 ** rng.uniform(-1, 1), rng.uniform(0.0, 1.2)
    slider = Slider(m, 2.0 * zeta * float(np.sqrt(k * m)), k, k * 10.0 ** rng.uniform(-2.5, -0.7))
    w = slider.omega_n
    x0, v0 = 1.0 + rng.uniform(), w * rng.normal()
    t = np.sort(rng.uniform(0.0, 25.0 / w, 200))
    x, v, a = np.empty((3, t.size))
    dx, dv, da = np.empty((3, t.size, len(PARAMETERS)))
    fill_sensitivities(Decay.of(slider, x0, v0), t, x, v, a, dx, dv, da)
    s = solve(Model.of_slider(slider, x0, v0), t, ("k", "c", "f_k", "x0", "v0", "m"), effort=Effort(1e-12))
    clear = np.all(np.abs(t[:, None] - s.events.t[None, :]) > 1e-7 / w, axis=1)
    # by the chain rule from omega_n = sqrt(k/m), zeta = c/(2 sqrt(k m)), x_k = f_k/k
    to_ours = np.array(
        [
            [w / (2 * k), -zeta / (2 * k), -slider.x_k / k, 0, 0, 0],
            [0, 1.0 / (2.0 * np.sqrt(k * m)), 0, 0, 0, 0],
            [0, 0, 1.0 / k, 0, 0, 0],
            [0, 0, 0, 1.0, 0, 0],
            [0, 0, 0, 0, 1.0, 0],
            [-w / (2 * m), -zeta / (2 * m), 0, 0, 0, 0],
        ]
    )
    for theirs, ours in ((dx, s.dx), (dv, s.dv), (da, s.da)):
        expected = theirs @ to_ours.T
        size = np.abs(expected[clear]).max(axis=0) + 1e-300
        assert (np.abs(ours - expected)[clear].max(axis=0) / size).max() < 1e-8
