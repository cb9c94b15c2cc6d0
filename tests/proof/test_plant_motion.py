"""The plant's motion: the paper's digits, closed forms, convergence, other solvers, sticking and breaking away."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from harness.core.errors import InputError
from harness.proof.plant.base import Base
from harness.proof.plant.base_fit import decay_motion
from harness.proof.plant.effects import BENCH
from harness.proof.plant.integrate import simulate
from harness.proof.plant.model import (
    Drive,
    DryFriction,
    Force,
    Knock,
    Level,
    PlantModel,
    base_model,
    bristle,
    coulomb,
    regularised,
)


def force_of(name: str, **parameters: Any) -> Force:
    """The force of an effect on a slider of 1 kg and 100 N/m."""
    (force,) = BENCH[name].build(parameters, Base(1.0, 10.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 2)).forces
    return force


PAPER_TURNS = [
    1.0, -0.7988338562165538, 0.6269438451936182, -0.48006934964594244, 0.35456980889888967, -0.24733448074343986,
    0.15570533583856455, -0.07741117345368495, 0.01051132548594804,
]  # fmt: skip


def paper() -> PlantModel:
    return base_model(1.0, 1.0, 100.0, 3.0, 1.0)


def test_the_papers_case_to_its_digits() -> None:
    reversals = simulate(paper(), np.linspace(0.0, 3.0, 301), tolerance=1e-13).reversals
    assert reversals.size == 8
    assert reversals == pytest.approx(np.arange(1, 9) * math.pi / (10.0 * math.sqrt(1.0 - 0.05**2)), abs=1e-11)
    run = simulate(paper(), np.concatenate([[0.0], reversals, [3.0]]), tolerance=1e-13)
    assert run.x[:9] == pytest.approx(PAPER_TURNS, abs=1e-11)
    assert run.x[-1] == pytest.approx(0.010511325485945064, abs=1e-11)
    assert run.stuck[-1]
    assert run.v[-1] == 0.0


@settings(max_examples=15)
@example(zeta=1e-5, x_k=0.1, omega=3.0, x0=0.0, v0=2.2e-308)
@example(zeta=0.2, x_k=0.002, omega=75.0, x0=0.05, v0=2.2e-308)
@given(
    zeta=st.floats(0.0, 0.3),
    x_k=st.floats(0.002, 0.1),
    omega=st.floats(3.0, 150.0),
    x0=st.floats(-1.0, 1.0),
    v0=st.floats(-1.0, 1.0),
)
def test_base_agrees_with_the_closed_form(zeta: float, x_k: float, omega: float, x0: float, v0: float) -> None:
    t = np.linspace(0.0, 8.0 * math.pi / omega, 400)
    model = base_model(1.0, 2.0 * zeta * omega, omega**2, omega**2 * x_k, x0, v0 * omega)
    run = simulate(replace(model, length=1.0), t, tolerance=1e-11)
    x, _, a = decay_motion(t, omega, zeta, x_k, x0, v0 * omega)
    assert np.max(np.abs(run.x - x)) < 1e-8
    # a jumps at reversals: a sample beside one may fall on either side
    assert np.quantile(np.abs(run.a - a), 0.95) < 1e-7 * omega**2


def test_error_falls_with_tolerance() -> None:
    model = replace(
        paper(),
        forces=(force_of("cubic-stiffness", k3=20.0), force_of("harmonic-force", amplitude=2.0, Omega=23.0, phase=0.4)),
    )
    t = np.linspace(0.0, 2.5, 200)
    best = simulate(model, t, tolerance=1e-13).x
    errors = [float(np.max(np.abs(simulate(model, t, tolerance=tol).x - best))) for tol in (1e-4, 1e-7, 1e-10)]
    assert errors[0] < 1e-4
    assert errors[1] < 1e-6
    assert errors[2] < 1e-9


@pytest.mark.parametrize("solver", ["Radau", "LSODA"])
@pytest.mark.parametrize(
    "friction",
    [coulomb(Level(3.0, 5.0, 0.6)), bristle(Level(3.0, 5.0, 0.6), 400.0, 6.0), regularised(Level(3.0, 3.0), 0.3, 0.01)],
    ids=["coulomb-stribeck", "lugre", "regularised"],
)
def test_other_solvers_agree(solver: str, friction: DryFriction) -> None:
    model = replace(paper(), friction=friction, forces=(force_of("end-stop", gap=0.8, k_stop=30.0, side="both"),))
    t = np.linspace(0.0, 1.5, 300)
    assert simulate(model, t, solver=solver, tolerance=1e-9).x == pytest.approx(simulate(model, t).x, abs=2e-6)


def test_a_constant_push_shifts_the_whole_motion() -> None:
    t = np.linspace(0.0, 3.0, 500)
    pushed = simulate(replace(paper(), x0=1.02, forces=(force_of("constant-force", force=2.0),)), t)
    assert pushed.x == pytest.approx(simulate(paper(), t).x + 0.02, abs=1e-9)


def test_direction_dependent_damping_is_another_zeta_each_way() -> None:
    t = np.linspace(0.0, 0.62, 400)
    run = simulate(replace(paper(), forces=(force_of("asymmetric-viscous", c_diff=0.4),)), t, tolerance=1e-12)
    back, *_ = decay_motion(t, 10.0, 0.03, 0.03, 1.0, 0.0)
    turn = run.reversals[0]
    first = t <= turn
    assert run.x[first] == pytest.approx(back[first], abs=1e-10)
    lowest = decay_motion(np.array([turn]), 10.0, 0.03, 0.03, 1.0, 0.0)[0][0]
    forth, *_ = decay_motion(t[~first] - turn, 10.0, 0.07, 0.03, lowest, 0.0)
    assert run.x[~first] == pytest.approx(forth, abs=1e-9)


@pytest.mark.parametrize(
    ("force", "potential"),
    [
        (force_of("cubic-stiffness", k3=30.0), lambda x: 30.0 * x**4 / 4),
        (force_of("quadratic-stiffness", k2=-20.0), lambda x: -20.0 * x**3 / 3),
        (force_of("pendulum-stiffness"), lambda x: 100.0 * (1.0 - np.cos(x)) - 50.0 * x**2),
        (force_of("end-stop", gap=0.6, k_stop=80.0, side="upper"), lambda x: 40.0 * np.maximum(x - 0.6, 0.0) ** 2),
        (force_of("end-stop", gap=0.6, k_stop=80.0, side="lower"), lambda x: 40.0 * np.maximum(-x - 0.6, 0.0) ** 2),
        (force_of("backlash", gap=0.05), lambda x: 50.0 * np.maximum(np.abs(x) - 0.05, 0.0) ** 2 - 50.0 * x**2),
    ],
    ids=["cubic", "quadratic", "pendulum", "stop-upper", "stop-lower", "backlash"],
)
def test_stiffness_conserves_energy(force: Force, potential: object) -> None:
    assert callable(potential)
    model = replace(base_model(1.0, 0.0, 100.0, 0.0, 1.0), forces=(force,))
    run = simulate(model, np.linspace(0.0, 6.0, 600), tolerance=1e-12)
    energy = 0.5 * run.v**2 + 50.0 * run.x**2 + potential(run.x)
    assert energy == pytest.approx(np.full(600, energy[0]), rel=1e-8)


def test_harmonic_response_without_friction_is_the_textbooks() -> None:
    omega, drive = 10.0, 17.0
    response = 4.0 / (omega**2 - drive**2)
    # started on the forced solution, it stays on it
    model = replace(
        base_model(1.0, 0.0, omega**2, 0.0, response),
        forces=(force_of("harmonic-force", amplitude=4.0, Omega=drive, phase=0.0),),
    )
    t = np.linspace(0.0, 5.0, 300)
    assert simulate(model, t).x == pytest.approx(response * np.cos(drive * t), abs=1e-10)


def test_a_knock_adds_its_momentum_and_frees_a_stuck_slider() -> None:
    model = replace(base_model(2.0, 0.0, 50.0, 0.5, 0.005), knocks=(Knock(0.5, 0.8),))
    run = simulate(model, np.array([0.0, 0.4, 0.5, 0.5 + 1e-9, 0.6, 8.0]))
    assert list(run.stuck[:3]) == [True, True, True]
    assert run.v[3] == pytest.approx(0.4, abs=1e-6)
    assert run.x[4] > 0.03
    assert run.stuck[-1]


def test_a_slow_ramp_breaks_away_at_f_s_exactly() -> None:
    model = replace(
        base_model(1.0, 0.5, 100.0, 3.0, 0.0), friction=coulomb(Level(3.0, 4.2)), drive=Drive(lambda t, x, v: 2.0 * t)
    )
    run = simulate(replace(model, length=0.1), np.linspace(0.0, 2.4, 2401))
    assert np.all(run.stuck[run.t <= 2.1])
    assert not np.any(run.stuck[(run.t > 2.1) & (run.t < 2.2)])
    # at the moment it breaks away the force falls from f_s to f_k
    assert run.a[2101] == pytest.approx(1.2, abs=0.02)


def test_modulated_break_away_lets_go_when_the_level_has_fallen() -> None:
    level = Level(3.0, 3.0, None, (lambda t, x, net, work: 1.0 - 0.5 * t,))
    model = replace(paper(), friction=coulomb(level), x0=0.02)
    run = simulate(model, np.linspace(0.0, 1.5, 1501))
    # 2 N of spring are held until 3 (1 - t/2) = 2
    assert run.stuck[run.t < 2.0 / 3.0].all()
    assert not run.stuck[(run.t > 2.0 / 3.0 + 1e-3) & (run.t < 0.7)].any()


def test_held_until_released() -> None:
    t = np.linspace(0.0, 3.0, 301)
    run = simulate(replace(paper(), release=0.5), t)
    assert np.all(run.x[:50] == 1.0)
    assert np.all(run.a[:50] == 0.0)
    assert run.x[50:] == pytest.approx(simulate(paper(), t[50:] - 0.5).x, abs=1e-9)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"m": 0.0}, "plant: m: 0; a number above 0 kg is accepted"),
        ({"c": -1.0}, "plant: c: -1; 0 or more N s/m is accepted"),
        ({"restoring": "rubber"}, "plant: restoring: rubber; spring, pendulum or none is accepted"),
        ({"x0": math.nan}, "plant: x0: nan; a finite number is accepted"),
    ],
)
def test_bad_plants_are_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(InputError) as caught:
        replace(paper(), **change)  # type: ignore[arg-type]
    assert str(caught.value) == message
