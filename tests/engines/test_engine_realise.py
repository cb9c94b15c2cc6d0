"""Every term of the catalogue in every engine, against the reference integrator."""

import numpy as np
import pytest
from engine_cases import JOINTED, engine

from harness.core.errors import SimulationError
from harness.engines.law import Drive
from harness.engines.realise import task_of
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import TERMS
from harness.model.term import Slot, Term

BASE = Model(1.0, 1.0, 100.0, 2.0, x0=1.0)

ACTING = [term for term in TERMS if term.slot is not Slot.OBSERVATION]


@pytest.mark.parametrize("term", ACTING, ids=lambda term: term.key)
@pytest.mark.parametrize("name", JOINTED)
def test_every_term_moves_as_in_the_reference(name: str, term: Term) -> None:
    model = BASE.with_terms(ModelTerm(term, term.example))
    trace = engine(name).simulate(task_of(model, 2.0, 5e-4))
    exact = simulate(model, trace.t)
    plain = simulate(BASE, trace.t)
    error = np.abs(trace.x - exact.x).max()
    assert error < 4e-3
    if term.slot is not Slot.BREAK_AWAY:  # shows only where something is held
        assert error < 0.2 * np.abs(plain.x - exact.x).max()


@pytest.mark.parametrize("name", JOINTED)
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
