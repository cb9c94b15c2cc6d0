"""One PyBullet world with a slider in it, opened and closed; every default that harms is made explicit."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from logging import Logger, getLogger
from pathlib import Path
from typing import Any

from lxml import etree

from harness.core.quiet import quiet
from harness.core.slider import Slider
from harness.engines import models
from harness.engines.base import Route
from harness.engines.joint_words import GRAVITY, coefficient

log: Logger = getLogger("harness.engines.pybullet")

with quiet(log):
    import pybullet

__all__ = ["log", "pybullet"]


SLIDE, LIFT = 0, 1
"""Joint (and link) numbers in both models."""

BASE = -1


@dataclass(frozen=True, slots=True)
class World:
    """A connected world: client number, body number, and the links of the box and (contact route) the joints."""

    client: int
    body: int
    box: int

    def limit(self, route: Route, force: float, target: float, slider: Slider, substeps: int) -> None:
        """Set the limit of the friction force, N; ``target`` is the speed of the surface that rubs (joint), m/s."""
        if route == "joint":
            # a motor's impulse limit is that of a whole step and is granted in every sub-step
            pybullet.setJointMotorControl2(
                self.body,
                SLIDE,
                pybullet.VELOCITY_CONTROL,
                targetVelocity=target,
                force=force / substeps,
                physicsClientId=self.client,
            )
        elif route == "contact":
            # the floor's coefficient is 1: PyBullet multiplies the two
            mu = coefficient(slider, force)
            pybullet.changeDynamics(self.body, self.box, lateralFriction=mu, physicsClientId=self.client)

    def contact(self) -> tuple[float, float]:
        """Normal force on the box and friction force on the left-hand side along x, N, of the last (sub-)step."""
        normal = friction = 0.0
        for point in pybullet.getContactPoints(self.body, self.body, physicsClientId=self.client):
            normal += point[9]
            pull = point[10] * point[11][0] + point[12] * point[13][0]
            friction += pull if point[4] == self.box else -pull
        return normal, friction


@contextmanager
def opened(slider: Slider, route: Route, settings: dict[str, Any], x0: float, v0: float) -> Iterator[World]:
    """A fresh world at rest in time, closed at the end.

    Nothing survives from one run to the next: resetSimulation would keep the number of sub-steps, and files are cached
    by name.
    """
    name = "slider_on_floor" if route == "contact" else "slider"
    client = pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setPhysicsEngineParameter(
            enableFileCaching=0,
            fixedTimeStep=settings["dt"],
            numSubSteps=settings["numSubSteps"],
            numSolverIterations=settings["numSolverIterations"],
            solverResidualThreshold=settings["solverResidualThreshold"],
            deterministicOverlappingPairs=1,
            physicsClientId=client,
        )
        body = _load(slider, name, route, client)
        for link in range(BASE, pybullet.getNumJoints(body, physicsClientId=client)):
            pybullet.changeDynamics(
                body,
                link,
                linearDamping=settings["linearDamping"],
                angularDamping=settings["angularDamping"],
                maxJointVelocity=settings["maxJointVelocity"],
                physicsClientId=client,
            )
        # joints come with a motor that is on
        for joint in range(pybullet.getNumJoints(body, physicsClientId=client)):
            pybullet.setJointMotorControl2(body, joint, pybullet.VELOCITY_CONTROL, force=0.0, physicsClientId=client)
        world = World(client, body, LIFT if route == "contact" else SLIDE)
        if route == "contact":
            _prepare_contact(world, settings)
        pybullet.resetJointState(body, SLIDE, x0, v0, physicsClientId=client)
        yield world
    finally:
        pybullet.disconnect(client)


def _load(slider: Slider, name: str, route: Route, client: int) -> int:
    flags = pybullet.URDF_USE_SELF_COLLISION | pybullet.URDF_USE_SELF_COLLISION_INCLUDE_PARENT
    with tempfile.TemporaryDirectory(prefix="friction-harness-") as folder:
        file = Path(folder) / f"{name}.urdf"
        file.write_bytes(etree.tostring(models.urdf(slider, name)))
        return int(
            pybullet.loadURDF(
                str(file), useFixedBase=True, flags=flags if route == "contact" else 0, physicsClientId=client
            )
        )


def _prepare_contact(world: World, settings: dict[str, Any]) -> None:
    pybullet.setGravity(0.0, 0.0, -GRAVITY, physicsClientId=world.client)
    pybullet.setPhysicsEngineParameter(
        contactERP=settings["contactERP"],
        frictionERP=settings["frictionERP"],
        contactSlop=settings["contactSlop"],
        contactBreakingThreshold=settings["contactBreakingThreshold"],
        physicsClientId=world.client,
    )
    for link in (BASE, world.box):
        pybullet.changeDynamics(
            world.body,
            link,
            lateralFriction=1.0,
            frictionAnchor=settings["frictionAnchor"],
            physicsClientId=world.client,
        )
    # at height zero the first step finds no contact: start as deep as the solver lets a box rest
    pybullet.resetJointState(world.body, LIFT, -settings["contactSlop"], 0.0, physicsClientId=world.client)
