"""The plant's motion: the paper's digits, closed forms, other solvers, and every law as the catalogue states it."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import cumulative_simpson, cumulative_trapezoid

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.proof.plant.base import Base
from harness.proof.plant.base_fit import decay_motion
from harness.proof.plant.effects import BENCH
from harness.proof.plant.hidden import build
from harness.proof.plant.integrate import PlantRun, simulate
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
        ({"m": 0.0}, "plant: m: 0; expected a number above 0 kg"),
        ({"c": -1.0}, "plant: c: -1; expected 0 or more N s/m"),
        ({"restoring": "rubber"}, "plant: restoring: rubber; expected spring, pendulum or none"),
        ({"x0": math.nan}, "plant: x0: nan; expected a finite number"),
    ],
)
def test_bad_plants_are_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(InputError) as caught:
        replace(paper(), **change)  # type: ignore[arg-type]
    assert str(caught.value) == message


OMEGA, M, ZETA, X_K, X0 = 10.0, 1.7, 0.02, 0.02, 0.5
K, C, F_K = M * OMEGA**2, 2.0 * ZETA * M * OMEGA, M * OMEGA**2 * X_K
BASE = Base(M, OMEGA, ZETA, X_K, X0, 0.0, X0, 4.0, 40_001)


def convolved(run: PlantRun, tau: float) -> FloatArray:
    """y of y' = v - y/tau from its integral form."""
    return np.asarray(np.exp(-run.t / tau) * cumulative_trapezoid(np.exp(run.t / tau) * run.v, run.t, initial=0.0))


def smooth_forces(name: str, p: Mapping[str, Any], run: PlantRun) -> FloatArray:
    """What the effect adds on the left, N."""
    t, x, v = run.t, run.x, run.v
    zero = np.zeros_like(t)
    laws: dict[str, Callable[[], FloatArray]] = {
        "quadratic-drag": lambda: p["c2"] * np.abs(v) * v,
        "asymmetric-viscous": lambda: p["c_diff"] * np.abs(v),
        "power-law-damping": lambda: p["c_p"] * np.abs(v) ** p["exponent"] * np.sign(v),
        "viscoelastic": lambda: p["k_m"] * run.states[:, 0],
        "cubic-stiffness": lambda: p["k3"] * x**3,
        "quadratic-stiffness": lambda: p["k2"] * x**2,
        "pendulum-stiffness": lambda: K * (np.sin(x) - x),
        "end-stop": lambda: p["k_stop"] * (x - np.clip(x, -p["gap"], p["gap"])),
        "backlash": lambda: -K * np.clip(x, -p["gap"], p["gap"]),
        "stiffness-drift": lambda: K * p["rate"] * t * x,
        "constant-force": lambda: zero - p["force"],
        "force-ripple": lambda: p["amplitude"] * np.cos(2.0 * math.pi * x / p["period"] + p["phase"]),
        "harmonic-force": lambda: -p["amplitude"] * np.cos(p["Omega"] * t + p["phase"]),
        "attached-mode": lambda: second_mass(p, run),
        "alien-speed-stiffness": lambda: K * p["gain"] * (v / (X0 * OMEGA)) ** 2 * x,
    }
    return np.asarray(laws[name]()) if name in laws else zero


def second_mass(p: Mapping[str, Any], run: PlantRun) -> FloatArray:
    m2 = p["mass_ratio"] * M
    x2, v2 = run.states[:, 0], run.states[:, 1]
    return np.asarray(-m2 * p["omega_2"] ** 2 * (x2 - run.x) - 2.0 * p["zeta_2"] * p["omega_2"] * m2 * (v2 - run.v))


def friction(name: str, p: Mapping[str, Any], run: PlantRun, other: FloatArray) -> FloatArray:
    """Dry friction while sliding, N; other: all other forces on the left."""
    t, x, v = run.t, run.x, run.v
    level = np.full_like(t, F_K)
    if name == "stribeck":
        level = F_K + (p["f_s"] - F_K) * np.exp(-((v / p["v_s"]) ** 2))
    elif name == "presliding":
        z = run.states[:, 0]
        return np.asarray(p["sigma0"] * z + p["sigma1"] * (v - p["sigma0"] * np.abs(v) * z / F_K))
    elif name == "regularised-friction":
        return np.asarray(F_K * np.clip((v + p["lead"] * (-other / M)) / p["v_r"], -1.0, 1.0))
    elif name == "position-dependent-friction" and "slope" in p:
        level = level * (1.0 + p["slope"] * x)
    elif name == "position-dependent-friction":
        level = level * (1.0 + p["depth"] * np.cos(2.0 * math.pi * x / p["period"] + p["phase"]))
    elif name == "friction-drift":
        level = level * np.maximum(1.0 + p["rate"] * t, 0.0)
    elif name == "normal-load-variation":
        level = level * (1.0 + p["depth"] * np.cos(p["Omega"] * t + p["phase"]))
    elif name == "alien-inertial-load":
        level = level * (1.0 + p["gain"] * np.abs(other) / (K * X0))
    elif name == "alien-structural-damping":
        level = level * (1.0 + p["gain"] * np.abs(x) / X0)
    elif name == "alien-heating":
        level = level * (1.0 + p["gain"] * run.states[:, -1] / (F_K * X0))
    return np.asarray(level * np.sign(v))


EFFECTS: dict[str, dict[str, Any]] = {
    "stribeck": {"f_s": 1.8 * F_K, "v_s": 0.6},
    "presliding": {"sigma0": 4.0 * K, "sigma1": 8.0},
    "regularised-friction": {"v_r": 0.15, "lead": 0.006},
    "position-dependent-friction": {"slope": 1.4},
    "position-dependent-friction (cosine)": {"depth": 0.6, "period": 0.23, "phase": 0.7},
    "friction-drift": {"rate": -0.3},
    "normal-load-variation": {"depth": 0.7, "Omega": 6.5, "phase": 1.1},
    "quadratic-drag": {"c2": 0.3},
    "asymmetric-viscous": {"c_diff": -0.3},
    "power-law-damping": {"c_p": 1.2, "exponent": 0.35},
    "viscoelastic": {"k_m": 0.2 * K, "tau": 0.13},
    "cubic-stiffness": {"k3": -60.0},
    "quadratic-stiffness": {"k2": 30.0},
    "pendulum-stiffness": {},
    "end-stop": {"gap": 0.38, "k_stop": 0.4 * K, "side": "both"},
    "backlash": {"gap": 0.015},
    "stiffness-drift": {"rate": 0.02},
    "constant-force": {"force": 1.3},
    "force-ripple": {"amplitude": 1.5, "period": 0.21, "phase": 0.5},
    "harmonic-force": {"amplitude": 1.0, "Omega": 24.0, "phase": 2.0},
    "attached-mode": {"omega_2": 31.0, "mass_ratio": 0.06, "zeta_2": 0.02},
    "alien-inertial-load": {"gain": 2.0},
    "alien-structural-damping": {"gain": 2.0},
    "alien-heating": {"gain": 0.2},
    "alien-speed-stiffness": {"gain": 0.08},
}


def jump_free_integral(t: FloatArray, rate: FloatArray, jumps: FloatArray) -> FloatArray:
    """Running integral from the first sample; intervals that hold a jump of the integrand are taken as given (nan)."""
    steps = np.diff(cumulative_simpson(rate, x=t, initial=0.0))
    held = np.searchsorted(t, jumps) - 1
    # Simpson's parabola reaches over neighbouring intervals, and |v|^p is steep there
    for offset in range(-6, 7):
        steps[np.clip(held + offset, 0, steps.size - 1)] = np.nan
    return np.asarray(steps)


@pytest.mark.parametrize("label", EFFECTS)
def test_law_is_the_catalogues(label: str) -> None:
    name, p = label.split(" ", maxsplit=1)[0], EFFECTS[label]
    model, _ = build(BASE, {name: p})
    run = simulate(model, BASE.times)
    other = C * run.v + K * run.x + smooth_forces(name, p, run)
    total = M * run.a + other + friction(name, p, run, other)
    # the start is a turning point: sgn(0) there is not the direction it sets off in
    moving = ~run.stuck & (run.v != 0.0)
    assert moving.sum() > 10_000
    assert np.max(np.abs(total[moving])) < 1e-9 * K * X0
    kinks = np.append(0.0, run.reversals)
    for integral, rate in ((run.x, run.v), (run.v, run.a)):
        missed = np.diff(integral) - jump_free_integral(run.t, rate, kinks)
        assert np.nanmax(np.abs(missed)) < 2e-7 * np.max(np.abs(integral))
    assert np.all(run.v[run.stuck] == 0.0)


def test_maxwell_branch_is_its_convolution() -> None:
    p = EFFECTS["viscoelastic"]
    run = simulate(build(BASE, {"viscoelastic": p})[0], BASE.times)
    assert run.states[:, 0] == pytest.approx(convolved(run, p["tau"]), abs=1e-6)


def test_second_mass_moves_by_the_force_that_holds_it() -> None:
    p = EFFECTS["attached-mode"]
    run = simulate(build(BASE, {"attached-mode": p})[0], BASE.times)
    momentum = p["mass_ratio"] * M * run.states[:, 1]
    assert momentum == pytest.approx(cumulative_simpson(second_mass(p, run), x=run.t, initial=0.0), abs=1e-6)


def test_bristle_follows_its_own_equation() -> None:
    p = EFFECTS["presliding"]
    run = simulate(build(BASE, {"presliding": p})[0], BASE.times, tolerance=1e-12)
    z = run.states[:, 0]
    rate = run.v - p["sigma0"] * np.abs(run.v) * z / F_K
    assert z == pytest.approx(cumulative_trapezoid(rate, run.t, initial=0.0), abs=2e-6)
    assert np.max(np.abs(z)) <= F_K / p["sigma0"] * (1.0 + 1e-6)


def test_work_against_friction_closes_the_energy_balance() -> None:
    run = simulate(build(BASE, {"stribeck": EFFECTS["stribeck"]})[0], BASE.times)
    energy = 0.5 * M * run.v**2 + 0.5 * K * run.x**2
    viscous = cumulative_simpson(C * run.v**2, x=run.t, initial=0.0)
    assert energy + viscous + run.states[:, -1] == pytest.approx(np.full(run.t.size, energy[0]), rel=1e-7)


def test_rattle_keeps_momentum_and_only_loses_energy() -> None:
    free = Base(M, OMEGA, 0.0, 0.0, X0, 0.0, X0, 2.0, 20_001)
    p = {"mass_ratio": 0.05, "clearance": 0.1, "omega_c": 200.0, "zeta_c": 0.1}
    run = simulate(build(free, {"alien-rattle": p})[0], free.times)
    m2, (x2, v2) = p["mass_ratio"] * M, run.states[:, :2].T
    assert M * run.v + m2 * v2 == pytest.approx(-cumulative_simpson(K * run.x, x=run.t, initial=0.0), abs=1e-6)
    squeeze = np.maximum(np.abs(x2 - run.x) - p["clearance"], 0.0)
    energy = 0.5 * (M * run.v**2 + K * run.x**2 + m2 * v2**2 + m2 * p["omega_c"] ** 2 * squeeze**2)
    assert np.max(np.diff(energy)) < 1e-7 * energy[0]
    assert energy[-1] < 0.999 * energy[0]
    assert np.max(squeeze) > 0.0
