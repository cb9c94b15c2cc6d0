"""Every term of the catalogue in every engine, by a law and by words of its joint, against the reference."""

import numpy as np
import pytest
from engine_cases import CALLING, engine

from harness.core.errors import SimulationError
from harness.engines.forces import Drive
from harness.engines.joint_words import JOINT, elements, words_of
from harness.engines.simulator import EngineSimulator, task_of
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import TERMS
from harness.model.term import Slot, Term

BASE = Model(1.0, 1.0, 100.0, 2.0, x0=1.0)

JOINTED = [name for name, route in CALLING if route == "joint"]
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


HEAVIER = Model(1.3, 1.0, 100.0, 3.0, x0=1.0)

SAID = [entry for t in TERMS if elements(entry := ModelTerm(t, t.example), HEAVIER.k, JOINT)]
"""Every term that is made of what a joint has words for."""


@pytest.mark.parametrize("entry", SAID, ids=lambda entry: entry.term.key)
def test_words_of_the_joint_and_a_force_law_are_the_same(entry: ModelTerm) -> None:
    model = HEAVIER.with_terms(entry)
    mujoco = engine("mujoco")
    by_law = mujoco.simulate(task_of(model, 2.0, 1e-3))
    task = task_of(model, 2.0, 1e-3, native=mujoco.native)
    assert task.law is None
    by_words = mujoco.simulate(task)
    assert np.abs(by_words.x - by_law.x).max() < 1e-9
    assert np.abs(by_words.a - by_law.a).max() < 1e-5
    assert np.abs(by_words.extra["friction_force"] - by_law.extra["friction_force"]).max() < 1e-4
    assert np.abs(by_words.x - simulate(model, by_words.t).x).max() < 2e-3


def test_words_and_laws_stand_side_by_side() -> None:
    model = HEAVIER.with_terms(
        ModelTerm.named("stribeck", f_s=5.0, v_s=0.5),
        *(entry for entry in SAID if not entry.term.variant),
        ModelTerm.named("viscoelastic", k_m=20.0, tau=0.1),
        ModelTerm.named("sensor-bias", bias=0.5),
    )
    trace = EngineSimulator.named("mujoco")(model, 2.0, 2e-4, None)
    assert np.abs(trace.x - simulate(model, trace.t).x).max() < 1e-3
    terms = trace.source.settings["terms"]
    assert {name for name, how in terms.items() if how == "attribute of the joint"} == {e.term.name for e in SAID}
    assert terms["stribeck"] == "limit of the engine's own friction, set in every step"
    assert terms["viscoelastic"] == "force law, called at every stage of the step"
    assert terms["sensor-bias"] == "none: what a sensor makes of the motion"


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "implicit", "discrete"])
def test_every_integrator_has_the_terms(integrator: str) -> None:
    model = HEAVIER.with_terms(*(entry for entry in SAID if not entry.term.corner))
    trace = EngineSimulator.named("mujoco", "tuned", {"integrator": integrator})(model, 1.0, 1e-4, None)
    exact = simulate(model, trace.t)
    assert np.abs(trace.x - exact.x).max() < 5e-3
    assert np.median(np.abs(trace.a - exact.a)) < 0.2


def test_a_friction_that_looks_ahead_sees_every_force() -> None:
    model = HEAVIER.with_terms(
        ModelTerm.named("regularised-friction", v_r=0.05, lead=0.01), ModelTerm.named("cubic-stiffness", k3=40.0)
    )
    trace = EngineSimulator.named("mujoco")(model, 2.0, 5e-4, None)
    assert trace.source.settings["terms"]["cubic-stiffness"].startswith("force law")
    assert np.abs(trace.x - simulate(model, trace.t).x).max() < 1e-4


@pytest.mark.usefixtures("pybullet")
def test_an_engine_without_words_refuses_them() -> None:
    model = HEAVIER.with_terms(ModelTerm.named("cubic-stiffness", k3=40.0))
    with pytest.raises(SimulationError, match="pybullet: its joint has no words"):
        engine("pybullet").simulate(task_of(model, 1.0, 1e-3, native=JOINT))
    assert EngineSimulator.named("pybullet")(model, 0.1, 1e-3, None).source.settings["terms"] == {
        "cubic-stiffness": "force law, called at every stage of the step"
    }
    with pytest.raises(ValueError, match="stribeck has no words of a joint"):
        words_of([ModelTerm.named("stribeck", f_s=5.0, v_s=0.5)], 100.0)
