"""friction.py: numpy alone, under a hundred lines, and what it is put on moves as the reference does."""

import ast
from pathlib import Path
from types import ModuleType
from typing import Any

import mujoco
import numpy as np
import pytest

import harness
from harness.core.arrays import FloatArray
from harness.engines import model_files
from harness.engines.friction_file import friction_file
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.registry import TERMS

SLIDER = Model(1.0, 1.0, 100.0, 3.0, x0=0.5)
PENDULUM = Model(0.5, 0.05, 4.0, 0.1, x0=1.2, restoring=Restoring.PENDULUM)
LAWS: dict[str, tuple[ModelTerm, ...]] = {
    "coulomb": (),
    "stribeck": (ModelTerm.named("stribeck", f_s=4.5, v_s=0.4),),
    "load": (ModelTerm.named("load-dependent-friction", gain=1.5),),
    "across": (ModelTerm.named("load-dependent-friction:across", gain_2=9.0),),
    "presliding": (ModelTerm.named("presliding", sigma0=3000.0, sigma1=5.0),),
    "lugre": (ModelTerm.named("presliding", sigma0=3000.0, sigma1=5.0), ModelTerm.named("stribeck", f_s=4.5, v_s=0.4)),
    "regularised": (ModelTerm.named("regularised-friction", v_r=0.2, lead=0.0),),
    "power": (ModelTerm.named("power-law-damping", c_p=0.8, exponent=0.5),),
    "drift": (ModelTerm.named("friction-drift", rate=-0.1),),
    "drag": (ModelTerm.named("quadratic-drag", c2=1.5),),
}


def module(model: Model, joint: str) -> Any:
    made = ModuleType("friction")
    exec(friction_file(model, joint), made.__dict__)
    return made


def exported(model: Model, into: Path) -> Any:
    """The file as it is left beside the model's own."""
    made = ModuleType("friction")
    exec(model_files.export(model, into)["friction.py"].read_text(), made.__dict__)
    return made


def in_mujoco(model: Model, dt: float, duration: float, tmp_path: Path) -> FloatArray:
    """Position of the model's own file with friction.py in a plain loop."""
    own = mujoco.MjModel.from_xml_string(model_files.mjcf(model).decode())
    own.opt.timestep, own.opt.integrator = dt, mujoco.mjtIntegrator.mjINT_RK4
    data = mujoco.MjData(own)
    data.qpos[0], data.qvel[0] = model.x0, model.v0
    friction = exported(model, tmp_path).attach(own, data)
    found = [model.x0]
    for _ in range(round(duration / dt)):
        friction()
        mujoco.mj_step(own, data)
        found.append(float(data.qpos[0]))
    return np.array(found)


@pytest.mark.parametrize("name", LAWS)
def test_a_slider_in_mujoco_moves_as_the_reference(name: str, tmp_path: Path) -> None:
    model = SLIDER.with_terms(*LAWS[name])
    x = in_mujoco(model, 2e-4, 1.5, tmp_path)
    exact = harness.simulate(model, np.arange(x.size) * 2e-4)
    assert np.abs(x - exact.x).max() < 1.5e-3
    assert len(friction_file(model, "slide").splitlines()) < 100


@pytest.mark.parametrize("name", ["coulomb", "lugre", "drift"])
def test_a_slider_in_mjx_moves_as_the_reference(name: str) -> None:
    mjx = pytest.importorskip("mujoco.mjx")
    import jax

    model, dt = SLIDER.with_terms(*LAWS[name]), 5e-4
    own = mujoco.MjModel.from_xml_string(model_files.mjcf(model).decode())
    own.opt.timestep, own.opt.integrator = dt, mujoco.mjtIntegrator.mjINT_EULER
    own.dof_frictionloss[0] = 0.0
    friction = module(model, "slide")
    begun = mjx.make_data(own).replace(qpos=np.array([model.x0]), qvel=np.array([model.v0]))
    there = mjx.put_model(own)

    def one(carry: Any, _: None) -> Any:
        data, state = friction.step(there, *carry)
        return (data, state), data.qpos[0]

    start = jax.tree.map(jax.numpy.asarray, friction.START)
    x = np.concatenate(([model.x0], np.asarray(jax.jit(lambda c: jax.lax.scan(one, c, None, 3000))((begun, start))[1])))
    exact = harness.simulate(model, np.arange(x.size) * dt)
    assert np.abs(x - exact.x).max() < 4e-3


@pytest.mark.parametrize("integrator", ["EULER", "IMPLICITFAST", "RK4"])
def test_it_holds_a_load_without_a_creep_and_breaks_away_above(integrator: str) -> None:
    model = Model(1.0, 2.0, 0.0, 3.0, f_s=4.0, restoring=Restoring.NONE)
    text = model_files.mjcf(model).decode()
    own = mujoco.MjModel.from_xml_string(text)
    own.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{integrator}")
    for load, moves in ((3.9, False), (4.1, True)):
        data = mujoco.MjData(own)
        own.opt.gravity[:] = (load, 0.0, 0.0)
        friction = module(model, "slide").attach(own, data)
        for _ in range(500):
            friction()
            mujoco.mj_step(own, data)
        assert (abs(data.qpos[0]) > 1e-3) == moves
        if not moves:
            assert abs(data.qvel[0]) < 1e-12


@pytest.mark.parametrize("name", ["coulomb", "stribeck", "gravity", "presliding", "drag"])
def test_a_pendulum_in_pybullet_moves_as_the_reference(name: str, tmp_path: Path) -> None:
    pybullet = pytest.importorskip("pybullet")
    terms = {
        "coulomb": (),
        "stribeck": (ModelTerm.named("stribeck", f_s=0.18, v_s=0.5),),
        "gravity": (ModelTerm.named("load-dependent-friction:gravity", gain=0.8),),
        "presliding": (ModelTerm.named("presliding", sigma0=20.0, sigma1=0.05),),
        "drag": (ModelTerm.named("quadratic-drag", c2=0.05),),
    }[name]
    model = PENDULUM.with_terms(*terms)
    file, dt = model_files.export(model, tmp_path)["pendulum.urdf"], 2e-4
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setPhysicsEngineParameter(fixedTimeStep=dt, enableFileCaching=0, physicsClientId=client)
        pybullet.setGravity(0, 0, -9.81, physicsClientId=client)
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        body = pybullet.loadURDF(str(file), useFixedBase=True, flags=flags, physicsClientId=client)
        pybullet.resetJointState(body, 0, model.x0, physicsClientId=client)
        own, x = exported(model, tmp_path), [model.x0]
        for _ in range(7500):
            own.apply(body, 0, client)
            pybullet.stepSimulation(physicsClientId=client)
            x.append(pybullet.getJointState(body, 0, physicsClientId=client)[0])
    finally:
        pybullet.disconnect(client)
    exact = harness.simulate(model, np.arange(len(x)) * dt)
    assert np.abs(np.array(x) - exact.x).max() < 4e-3


@pytest.mark.parametrize("term", [term for term in TERMS if term.in_python and term.internal == 0], ids=lambda t: t.key)
def test_an_expression_is_the_law(term: Any) -> None:
    from harness.engines.friction_file import _expression
    from harness.model.law import COLUMNS, KINETIC, V_SCALE
    from harness.model.term import Slot

    rng = np.random.default_rng(1)
    entry = ModelTerm(term, term.example)
    theta = np.zeros(40)
    theta[KINETIC], theta[V_SCALE], o = 2.0, 1.0, 10
    theta[o : o + len(term.example)] = term.example
    names = {name: getattr(np, name) for name in ("abs", "clip", "cos", "exp", "pi", "sign", "sin")}
    for x, v, t in rng.uniform(-1.0, 1.0, (20, 3)):
        out = np.zeros(COLUMNS)
        changes = "t" in term.law.__code__.co_varnames[:3]
        if term.slot is Slot.FRICTION_LEVEL:
            term.law(v, theta, o, out)
        elif term.slot is Slot.FRICTION_LAW:
            term.law(v, 0.3, 1.0, theta, o, out)
        else:
            term.law(x, v, *([t] if changes else []), theta, o, out)
        said = eval(_expression(entry), names | {"x": x, "v": v, "t": t, "f_k": 2.0, "a": 0.3})
        assert said == pytest.approx(out[0], rel=1e-4)


def test_the_file_needs_numpy_alone() -> None:
    tree = ast.parse(friction_file(SLIDER, 'a "joint"\\'))
    early = [one for one in tree.body if isinstance(one, ast.Import | ast.ImportFrom)]
    assert {ast.unparse(one).split()[1] for one in early} == {"numpy"}


def test_what_the_file_has_not_is_in_its_first_line(tmp_path: Path) -> None:
    terms = (ModelTerm.named("quadratic-drag", c2=1.5), ModelTerm.named("cubic-stiffness", k3=20.0))
    first = (exported(SLIDER.with_terms(*terms), tmp_path).__doc__ or "").splitlines()[0]
    assert first == "Friction of slide: dry 3, viscous 1, quadratic-drag. Not in it: cubic-stiffness."
