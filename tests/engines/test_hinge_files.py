"""Models of angles as MJCF and URDF: loaded alone, without this program's laws, they move as the model does."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from harness.core.arrays import FloatArray
from harness.engines import model_files
from harness.engines.joint_words import GRAVITY
from harness.kernels.solve import simulate
from harness.model.model import Model, ModelTerm, Restoring

pybullet = pytest.importorskip("pybullet")

SWING = Model(0.02, 0.004, 0.9, 0.008, restoring=Restoring.PENDULUM, x0=1.3)
TORSION = Model(0.02, 0.004, 0.9, 0.008, x0=1.3)
SPAN, STEP = 2.0, 2e-4


def in_mujoco(file: Path, x0: float) -> FloatArray:
    """The angle (n,) at every step of the file alone."""
    model = mujoco.MjModel.from_xml_path(str(file))
    model.opt.timestep, model.opt.integrator = STEP, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.dof_solref[:] = (2.0 * STEP, 1.0)
    data = mujoco.MjData(model)
    data.qpos[0] = x0
    shown = [x0]
    for _ in range(round(SPAN / STEP)):
        mujoco.mj_step(model, data)
        shown.append(float(data.qpos[0]))
    return np.array(shown)


def in_pybullet(file: Path, x0: float) -> FloatArray:
    """As a user of PyBullet loads it: gravity set, friction held by the motor, no damping of the world's."""
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setGravity(0, 0, -GRAVITY, physicsClientId=client)
        pybullet.setTimeStep(STEP, physicsClientId=client)
        body = pybullet.loadURDF(str(file), useFixedBase=True, physicsClientId=client)
        for link in (-1, 0):
            pybullet.changeDynamics(body, link, linearDamping=0, angularDamping=0, physicsClientId=client)
        friction = pybullet.getJointInfo(body, 0, physicsClientId=client)[7]
        pybullet.setJointMotorControl2(
            body, 0, pybullet.VELOCITY_CONTROL, targetVelocity=0.0, force=friction, physicsClientId=client
        )
        pybullet.resetJointState(body, 0, x0, physicsClientId=client)
        shown = [x0]
        for _ in range(round(SPAN / STEP)):
            pybullet.stepSimulation(physicsClientId=client)
            shown.append(pybullet.getJointState(body, 0, physicsClientId=client)[0])
        return np.array(shown)
    finally:
        pybullet.disconnect(client)


def exact(model: Model) -> FloatArray:
    return simulate(model, np.linspace(0.0, SPAN, round(SPAN / STEP) + 1)).x


@pytest.mark.parametrize(
    "model",
    [SWING, TORSION, TORSION.with_terms(ModelTerm.named("cubic-stiffness", k3=0.3))],
    ids=["pendulum", "torsion", "hardening"],
)
def test_the_file_alone_moves_in_mujoco_as_the_model(model: Model, tmp_path: Path) -> None:
    files = model_files.export(model, tmp_path, angular=True)
    assert np.abs(in_mujoco(files["pendulum.xml"], model.x0) - exact(model)).max() < 5e-3 * model.x0


def test_the_file_alone_moves_in_pybullet_as_the_model(tmp_path: Path) -> None:
    files = model_files.export(SWING, tmp_path)
    assert np.abs(in_pybullet(files["pendulum.urdf"], SWING.x0) - exact(SWING)).max() < 5e-3 * SWING.x0


def test_what_a_hinge_cannot_say_is_said_in_radians() -> None:
    said = model_files.cannot_say(SWING, "urdf")
    assert "urdf: gravity is the reader's to set, 9.81 m/s^2 along -z" in said
    assert "urdf: no release (x0 = 1.3 rad, v0 = 0 rad/s)" in said
    assert not [line for line in model_files.cannot_say(SWING, "xml") if "sin" in line or "spring" in line]
    assert "urdf: no torsion spring (k = 0.9 N m/rad), and gravity is to be none" in model_files.cannot_say(
        TORSION, "urdf", angular=True
    )
