"""A clean arm under a controller, simulated by MuJoCo itself: it sticks and creeps, and nothing is named."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from harness.core.robot.joint_log import JointLog
from harness.robot.arm import load_arm
from harness.robot.whole_arm.whole import whole_arm

F_K, C = np.array([1.5, 0.5]), np.array([1.0, 0.3])
ARM = """
<mujoco><option gravity="0 0 -9.81" timestep=".002"/><worldbody>
  <body><joint name="shoulder" axis="0 1 0" armature=".05"/>
    <geom type="capsule" fromto="0 0 0 .4 0 0" size=".04" mass="2" contype="0"/>
    <body pos=".4 0 0"><joint name="elbow" axis="0 1 0" armature=".05"/>
      <geom type="capsule" fromto="0 0 0 .3 0 0" size=".03" mass="1" contype="0"/></body>
  </body>
</worldbody></mujoco>
"""


def _logged(late: int) -> JointLog:
    """20 s at 500 Hz; late : samples by which the torque's record is."""
    model = mujoco.MjModel.from_xml_string(ARM)
    model.dof_frictionloss[:], model.dof_damping[:] = F_K, C
    data, bare = mujoco.MjData(model), mujoco.MjModel.from_xml_string(ARM)
    ahead = mujoco.MjData(bare)
    count, omega = 2.0 * np.pi / 2**18, 20.0
    t = np.arange(10001) * model.opt.timestep
    waves = 2.0 * np.pi * np.array([[0.23, 0.71], [0.31, 0.83]])
    sizes, turns = np.array([[0.7, 0.2], [0.9, 0.25]]), np.array([[0.0, 1.0], [0.5, 2.0]])
    angle = waves * t[:, None, None] + turns
    q, v, a = (np.sum(sizes * f, axis=2) for f in (np.sin(angle), waves * np.cos(angle), -(waves**2) * np.sin(angle)))
    data.qpos[:], data.qvel[:] = q[0], v[0]
    seen, torque, inertia = np.zeros_like(q), np.zeros_like(q), np.zeros((2, 2))
    following, last = np.zeros(2), q[0]
    for k in range(t.size):
        seen[k] = np.round(data.qpos / count) * count
        torque[k] = following
        ahead.qpos[:], ahead.qvel[:], ahead.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(bare, ahead)
        mujoco.mj_fullM(bare, ahead, inertia)
        speed, last = (seen[k] - last) / model.opt.timestep, seen[k]
        error = omega**2 * (q[k] - seen[k]) + 1.4 * omega * (v[k] - speed)
        data.qfrc_applied[:] = torque[k]
        mujoco.mj_step(model, data)
        following = ahead.qfrc_inverse + inertia @ error
    # the first second is the way onto the motion
    recorded = np.roll(torque, late, axis=0)[500:]
    names = ("shoulder", "elbow")
    position, effort = ({name: y[:, i].copy() for i, name in enumerate(names)} for y in (seen[500:], recorded))
    return JointLog(t[500:], position, effort=effort)


def test_a_clean_arm_in_closed_loop_is_quiet(tmp_path: Path) -> None:
    """The bus hands on a torque that is one sample old."""
    (tmp_path / "arm.xml").write_text(ARM)
    found = whole_arm(_logged(1), load_arm(tmp_path / "arm.xml"))
    assert not found.named
    for joint, f_k, c in zip(found.joints, F_K, C, strict=True):
        assert joint.coulomb.value == pytest.approx(f_k, rel=0.01)
        assert joint.viscous.value == pytest.approx(c, rel=0.05)
