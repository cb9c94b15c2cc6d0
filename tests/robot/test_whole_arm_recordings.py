"""A real arm of two joints: friction of the size its makers found, and nothing absurd beside it."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from harness.core.robot.joint_log import JointLog
from harness.robot.arm import Arm
from harness.robot.whole_arm.model_columns import PAYLOAD, TILT
from harness.robot.whole_arm.whole import whole_arm


@pytest.fixture
def folder(recordings: Path) -> Path:
    found = recordings / "machines" / "dfki-double-pendulum"
    if not found.is_dir():
        pytest.skip("no log of the double pendulum here")
    return found


@pytest.mark.full
def test_a_double_pendulum_has_the_friction_its_makers_found_and_a_lag(folder: Path) -> None:
    model = mujoco.MjModel.from_xml_path(str(folder / "double_pendulum.urdf"))
    shipped, damping = model.dof_frictionloss.copy(), model.dof_damping.copy()
    model.dof_frictionloss[:] = model.dof_damping[:] = 0.0
    arm = Arm("double_pendulum.urdf", model, ("Joint1", "Joint2"), model.dof_armature.copy(), shipped, damping)
    rows = np.loadtxt(folder / "dfki_double_20220812-061157.csv", delimiter=",", skiprows=1)
    log = JointLog(
        rows[:, 0], {"Joint1": rows[:, 1], "Joint2": rows[:, 2]}, effort={"Joint1": rows[:, 5], "Joint2": rows[:, 6]}
    )
    found = whole_arm(log, arm, lowpass=15.0)
    for joint in found.joints:
        assert joint.coulomb.value == pytest.approx(0.135, abs=0.06)
        assert joint.held_out is not None
        assert joint.held_out[1] < 1.05 * joint.held_out[0]
    errors = {error.name: error for error in found.model}
    assert not {PAYLOAD, TILT} & errors.keys()
    assert abs(dict(errors["torque-delay"].parameters)["delay"].value or 0.0) < 0.02
