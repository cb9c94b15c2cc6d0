"""A slider in PyBullet: dry friction is a velocity motor limited to its level, spring and damper are torques."""

import logging
import tempfile
from pathlib import Path
from typing import final

from harness.core.quiet import quiet
from harness.proof.engine_source_motion import Body, Task

log = logging.getLogger(__name__)

with quiet(log):
    import pybullet

URDF = """
<robot name="slider">
  <link name="world"/>
  <link name="slider">
    <inertial><mass value="{m!r}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
  </link>
  <joint name="slide" type="prismatic">
    <parent link="world"/><child link="slider"/><axis xyz="1 0 0"/>
    <limit lower="-1e9" upper="1e9" effort="1e12" velocity="1e9"/>
  </joint>
</robot>
"""
SLIDE = 0


@final
class PybulletBody(Body):
    """One prismatic joint in a world of its own."""

    def __init__(self, task: Task) -> None:
        self._c, self._k, self._dt = task.model.c, task.model.k, task.dt
        self._x, self._v, self._before = task.x0, task.first_speed, task.first_speed
        self._before -= task.dt * task.first_acceleration
        self._limit = -1.0
        self._client = pybullet.connect(pybullet.DIRECT)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=task.dt, numSubSteps=0, enableFileCaching=0, physicsClientId=self._client
        )
        with tempfile.TemporaryDirectory() as folder, quiet(log):
            path = Path(folder) / "slider.urdf"
            path.write_text(URDF.format(m=task.model.m))
            self._body = pybullet.loadURDF(str(path), useFixedBase=True, physicsClientId=self._client)
        for link in (-1, SLIDE):
            # both default to 0.04
            pybullet.changeDynamics(
                self._body, link, linearDamping=0.0, angularDamping=0.0, jointDamping=0.0,
                maxJointVelocity=1e9, physicsClientId=self._client,
            )  # fmt: skip
        pybullet.resetJointState(self._body, SLIDE, self._x, self._v, physicsClientId=self._client)

    def step(self, push: float, limit: float) -> tuple[float, float]:
        """See Body.step."""
        body, client = self._body, self._client
        if limit != self._limit:
            pybullet.setJointMotorControl2(
                body, SLIDE, pybullet.VELOCITY_CONTROL, targetVelocity=0.0, force=limit, physicsClientId=client
            )
            self._limit = limit
        v = self._v + 0.5 * (self._v - self._before)
        torque = push - self._k * self._x - self._c * v
        pybullet.setJointMotorControl2(body, SLIDE, pybullet.TORQUE_CONTROL, force=torque, physicsClientId=client)
        pybullet.stepSimulation(physicsClientId=client)
        self._before = self._v
        self._x, self._v, _, _ = pybullet.getJointState(body, SLIDE, physicsClientId=client)
        return self._x, self._v

    def close(self) -> None:
        """See Body.close."""
        pybullet.disconnect(physicsClientId=self._client)
