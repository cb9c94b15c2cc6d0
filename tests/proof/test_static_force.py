"""What a table of a machine measures: all that is static in it, main effect and small ones, and nothing else."""

from typing import Any

import numpy as np
import pytest

from benchmarks.calibrate.static_force import static_force
from harness.core.arrays import FloatArray

OMEGA, LENGTH, X_K = 10.0, 0.5, 0.02
"""m = 1 kg, so that k = 100 N/m, the scale of the speed is 5 m/s and f_k = 2 N."""


def answer(form: str, at: FloatArray, plant: dict[str, dict[str, Any]]) -> dict[str, Any]:
    base = {"m": 1.0, "omega_n": OMEGA, "zeta": 0.01, "x_k": X_K, "x0": -LENGTH, "options": ["--restoring", "spring"]}
    return {**base, "plant": plant, "table": {"form": form, "at": at.tolist(), "force": [0.0] * at.size}}


IN_TIME = {"harmonic-force": {"amplitude": 3.0, "Omega": 2.0, "phase": 0.1}, "stiffness-drift": {"rate": 0.2}}
SOFT = {"alien-softening": {"size": 4.0, "width": 0.3}}
DRAG = {"quadratic-drag": {"c2": 0.7}}
CUBIC = {"cubic-stiffness": {"k3": -5.0}}
RUBS = {"alien-edge-rub": {"size": 0.4}}
BOTH = {"alien-position-viscous": {"size": 1.5}}


def test_a_table_over_position_measures_every_spring() -> None:
    x = np.linspace(-0.5, 0.4, 31)
    found = static_force(answer("f(x)", x, {**SOFT, **CUBIC, **DRAG, **RUBS, **BOTH, **IN_TIME}))
    assert found == pytest.approx(4.0 * np.tanh(x / 0.3) - 5.0 * x**3)


def test_a_table_over_speed_measures_every_damper_and_friction_that_falls() -> None:
    v = np.linspace(-3.0, 4.0, 32)
    stribeck = {"stribeck": {"f_s": 2.6, "v_s": 0.8}}
    pushed = {"constant-force": {"force": 1.0}}
    found = static_force(answer("f(v)", v, {**SOFT, **DRAG, **BOTH, **IN_TIME, **stribeck, **pushed}))
    assert found == pytest.approx(0.7 * v * np.abs(v) + 0.6 * np.sign(v) * np.exp(-((v / 0.8) ** 2)))


def test_a_table_of_friction_by_position_measures_what_rubs() -> None:
    x = np.linspace(-0.5, 0.5, 31)
    sloped = {"position-dependent-friction": {"slope": 0.3}}
    found = static_force(answer("g(x) sgn v", x, {**SOFT, **RUBS, **sloped, "friction-drift": {"rate": 0.1}}))
    rubs = 1.0 + 0.4 * (x / LENGTH) ** 4 / 2.0
    assert found == pytest.approx(2.0 * (rubs * (1.0 + 0.3 * x) - 1.0))
