"""Sensitivities of the integrator: against central differences of itself, and against the closed form's derivative."""

from dataclasses import replace

import numpy as np
import pytest
from kernel_cases import DRIVE, VALUES, difference_error, goal, model, term

from harness.core.slider import Slider
from harness.exact.decay import Decay
from harness.exact.sensitivity import PARAMETERS, fill_sensitivities
from harness.kernels.solve import Effort, solve
from harness.model.model import Model, ModelTerm, Restoring

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
