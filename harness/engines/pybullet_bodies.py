"""A body with six freedoms in PyBullet: on a slope, between two fingers, rolling or spinning on a floor.

PyBullet multiplies the friction of the two in contact, so that the other one's is 1; it has no count of directions:
torsional and rolling friction act where they are set.
"""

import math
from typing import Any

import numpy as np
import pybullet

from harness.core.arrays import FloatArray
from harness.core.scenario import Body
from harness.engines.base import Task
from harness.engines.joint_words import GRAVITY
from harness.engines.samples import Motion

_FINGER, _FINGER_MASS = 0.5, 0.1
"""Half thickness over the body's size, and kg."""
_TORSIONAL, _ROLLING = 4, 6
"""condim from which on those act."""


def body_motion(task: Task, settings: dict[str, Any], world: dict[str, Any]) -> Motion:
    """The run of a body; positions are those that PyBullet reports after each step. world : its parameters."""
    body, slider, dt = task.scenario.action, task.scenario.slider, settings["dt"]
    assert isinstance(body, Body)
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=dt, deterministicOverlappingPairs=1, physicsClientId=client, **world
        )
        along = body.load * body.mu * GRAVITY if body.place == "slope" else 0.0
        pybullet.setGravity(along, 0.0, -GRAVITY, physicsClientId=client)
        one = _Scene(client, body, slider.m, settings)
        rows = one.stepped(task.steps(dt), task.scenario.v0)
    finally:
        pybullet.disconnect(client)
    x, v, lift = rows.T.copy()
    a = np.gradient(v, dt)
    push = slider.m * (GRAVITY if body.place == "grip" else along)
    limit = math.inf if body.place == "floor" else slider.f_k
    return Motion(x, v, a, np.full(x.size, push), push - slider.m * a, np.full(x.size, limit), lift)


class _Scene:
    """A world with the body in it."""

    def __init__(self, client: int, body: Body, mass: float, settings: dict[str, Any]) -> None:
        self.client, self.described, self.fingers = client, body, -1
        size, start = body.size, 0.0 if body.place == "grip" else body.size
        shapes = {
            "box": {"shapeType": pybullet.GEOM_BOX, "halfExtents": [size] * 3},
            "cylinder": {"shapeType": pybullet.GEOM_CYLINDER, "radius": size, "height": 2.0 * size},
            "sphere": {"shapeType": pybullet.GEOM_SPHERE, "radius": size},
        }
        own = pybullet.createCollisionShape(physicsClientId=client, **shapes[body.shape])
        self.body = pybullet.createMultiBody(mass, own, basePosition=[0.0, 0.0, start], physicsClientId=client)
        damping = {name: settings[name] for name in ("linearDamping", "angularDamping")}
        pybullet.changeDynamics(
            self.body,
            -1,
            lateralFriction=0.0 if body.condim == 1 else body.mu,
            spinningFriction=body.mu_t if body.condim >= _TORSIONAL else 0.0,
            rollingFriction=body.mu_r if body.condim >= _ROLLING else 0.0,
            frictionAnchor=settings["frictionAnchor"],
            physicsClientId=client,
            **damping,
        )
        # a body at rest is not to be put to sleep
        pybullet.changeDynamics(
            self.body, -1, activationState=pybullet.ACTIVATION_STATE_DISABLE_SLEEPING, physicsClientId=client
        )
        if body.place == "grip":
            self._grip(0.5 * mass * GRAVITY / (body.mu * body.load))
        else:
            plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=client)
            floor = pybullet.createMultiBody(0.0, plane, physicsClientId=client)
            pybullet.changeDynamics(floor, -1, lateralFriction=1.0, physicsClientId=client)

    def _grip(self, force: float) -> None:
        """Two fingers on prismatic joints, each pressed with a force, N."""
        client, size, thick = self.client, self.described.size, _FINGER * self.described.size
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_BOX, halfExtents=[thick, size, size], physicsClientId=client
        )
        signs, no_turn = (-1.0, 1.0), [0.0, 0.0, 0.0, 1.0]
        self.force = force
        self.fingers = pybullet.createMultiBody(
            0.0,
            linkMasses=[_FINGER_MASS] * 2,
            linkCollisionShapeIndices=[shape] * 2,
            linkVisualShapeIndices=[-1] * 2,
            linkPositions=[[sign * (size + thick), 0.0, 0.0] for sign in signs],
            linkOrientations=[no_turn] * 2,
            linkInertialFramePositions=[[0.0] * 3] * 2,
            linkInertialFrameOrientations=[no_turn] * 2,
            linkParentIndices=[0, 0],
            linkJointTypes=[pybullet.JOINT_PRISMATIC] * 2,
            linkJointAxis=[[-sign, 0.0, 0.0] for sign in signs],
            physicsClientId=client,
        )
        for link in (0, 1):
            pybullet.changeDynamics(self.fingers, link, lateralFriction=1.0, physicsClientId=client)
            pybullet.setJointMotorControl2(
                self.fingers, link, pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=client
            )

    def stepped(self, steps: int, v0: float) -> FloatArray:
        """x, v and lift, (steps + 1, 3); the start first."""
        one, client = self.described, self.client
        if one.place == "floor":
            turning = [0.0, 0.0, v0 / one.size] if one.spins else [0.0, v0 / one.size, 0.0]
            moving = [0.0 if one.spins else v0, 0.0, 0.0]
            pybullet.resetBaseVelocity(self.body, moving, turning, physicsClientId=client)
        height = pybullet.getBasePositionAndOrientation(self.body, physicsClientId=client)[0][2]
        rows, rim = [(0.0, v0, 0.0)], 0.0
        for _ in range(steps):
            for link in (0, 1) if self.fingers >= 0 else ():
                pybullet.setJointMotorControl2(
                    self.fingers, link, pybullet.TORQUE_CONTROL, force=self.force, physicsClientId=client
                )
            pybullet.stepSimulation(physicsClientId=client)
            place, _ = pybullet.getBasePositionAndOrientation(self.body, physicsClientId=client)
            speed, turning = pybullet.getBaseVelocity(self.body, physicsClientId=client)
            if one.place == "grip":
                rows.append((height - place[2], -speed[2], abs(place[0])))
            elif one.spins:
                rim += one.size * turning[2] * pybullet.getPhysicsEngineParameters(client)["fixedTimeStep"]
                rows.append((rim, one.size * turning[2], place[2] - height))
            else:
                rows.append((place[0], speed[0], place[2] - height))
        return np.array(rows)
