"""Every term of the catalogue in every engine, against the reference integrator."""

import numpy as np
import pytest
from engine_cases import INSTALLED, engine

from harness.core.errors import SimulationError
from harness.engines.law import Drive
from harness.engines.realise import task_of
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm, Restoring

BASE = Model(1.0, 1.0, 100.0, 3.0, x0=1.0)

TERMS: list[tuple[str, dict[str, float]]] = [
    ("stribeck", {"f_s": 5.0, "v_s": 0.5}),
    ("static-friction", {"f_s": 5.0}),
    ("presliding", {"sigma0": 3000.0, "sigma1": 5.0}),
    ("regularised-friction", {"v_r": 0.05, "lead": 0.01}),
    ("position-dependent-friction", {"slope": 0.5}),
    ("position-dependent-friction:periodic", {"depth": 0.4, "period": 0.3, "phase": 0.5}),
    ("friction-drift", {"rate": 0.2}),
    ("normal-load-variation", {"depth": 0.4, "Omega": 9.0, "phase": 0.5}),
    ("quadratic-drag", {"c2": 0.3}),
    ("asymmetric-viscous", {"c_diff": 0.5}),
    ("power-law-damping", {"c_p": 1.0, "exponent": 0.5}),
    ("viscoelastic", {"k_m": 30.0, "tau": 0.1}),
    ("cubic-stiffness", {"k3": 40.0}),
    ("quadratic-stiffness", {"k2": 20.0}),
    ("pendulum-stiffness", {}),
    ("end-stop", {"gap": 0.5, "k_stop": 100.0}),
    ("backlash", {"gap": 0.05}),
    ("stiffness-drift", {"rate": 0.05}),
    ("constant-force", {"force": 1.5}),
    ("force-ripple", {"amplitude": 1.0, "period": 0.2, "phase": 0.3}),
    ("harmonic-force", {"A": 1.5, "Omega": 13.0, "phase": 0.3}),
    ("impulse", {"time": 0.7, "impulse": 1.0}),
    ("attached-mode", {"omega_2": 25.0, "mass_ratio": 0.2, "zeta_2": 0.02}),
]


@pytest.mark.parametrize(("key", "values"), TERMS, ids=[key for key, _ in TERMS])
@pytest.mark.parametrize("name", INSTALLED)
def test_every_term_moves_as_in_the_reference(name: str, key: str, values: dict[str, float]) -> None:
    model = BASE.with_terms(ModelTerm.named(key, **values))
    trace = engine(name).simulate(task_of(model, 2.0, 5e-4))
    exact = simulate(model, trace.t)
    plain = simulate(BASE, trace.t)
    error = np.abs(trace.x - exact.x).max()
    assert error < 4e-3
    if key != "static-friction":  # shows only where something is held
        assert error < 0.2 * np.abs(plain.x - exact.x).max()


@pytest.mark.parametrize("name", INSTALLED)
def test_a_sum_of_terms_with_a_drive_moves_as_in_the_reference(name: str) -> None:
    from harness.kernels.solve import Drive as KernelDrive

    model = BASE.with_terms(
        ModelTerm.named("stribeck", f_s=4.0, v_s=0.3),
        ModelTerm.named("normal-load-variation", depth=0.3, Omega=7.0, phase=0.0),
        ModelTerm.named("cubic-stiffness", k3=30.0),
        ModelTerm.named("viscoelastic", k_m=20.0, tau=0.1),
    )
    t = np.linspace(0.0, 2.5, 251)
    u = 5.0 * np.cos(6.0 * t)
    trace = engine(name).simulate(task_of(model, 2.0, 5e-4, drive=Drive(t, u)))
    exact = simulate(model, trace.t, KernelDrive(t, u))
    assert np.abs(trace.x - exact.x).max() < 4e-3


def test_a_free_axis_and_a_pendulum_are_passed_on() -> None:
    assert task_of(Model(1.0, 1.0, 0.0, 3.0, restoring=Restoring.NONE), 1.0, 1e-3).restoring == "none"
    assert task_of(Model(1.0, 1.0, 100.0, 3.0, restoring=Restoring.PENDULUM), 1.0, 1e-3).restoring == "pendulum"
    assert task_of(BASE, 1.0, 1e-3).law is None


def test_what_no_engine_can_be_told_is_refused() -> None:
    model = BASE.with_terms(ModelTerm.named("regularised-friction", v_r=0.05, lead=0.01))
    with pytest.raises(SimulationError, match="with a lead and a driving force there is no law to call"):
        task_of(model, 1.0, 1e-3, drive=Drive.none())
    with pytest.raises(SimulationError, match="friction without stick has no contact route"):
        task_of(model, 1.0, 1e-3, route="contact")
