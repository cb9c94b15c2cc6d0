"""Every law of the plant against the equation as the catalogue states it, written here a second time over arrays."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson, cumulative_trapezoid

from harness.core.arrays import FloatArray
from harness.proof.plant.base import Base
from harness.proof.plant.hidden import build
from harness.proof.plant.integrate import PlantRun, simulate

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
