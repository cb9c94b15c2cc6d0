"""PyBullet: spring and driving forces as a torque each step, dry friction as a velocity motor limited to f_k.

Every default that harms is made explicit, and every run has a world of its own: resetSimulation would keep the number
of sub-steps, and files are cached by name.
"""

import tempfile
import time
from dataclasses import replace
from logging import Logger, getLogger
from pathlib import Path
from typing import Any, ClassVar, final

from lxml import etree

from harness.core.quiet import quiet
from harness.core.scenario import Body
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.engines import models
from harness.engines.base import Route, Task
from harness.engines.joint_words import GRAVITY, coefficient
from harness.engines.samples import Motion, newton_friction, trajectory
from harness.engines.stepping import Native, Plan, Stepped, SteppedEngine, moved

log: Logger = getLogger("harness.engines.pybullet")

with quiet(log):
    import pybullet

__all__ = ["SLIDE", "PybulletBody", "PybulletEngine", "log", "pybullet"]

SLIDE, LIFT = 0, 1
"""Joint (and link) numbers in both models."""
BASE = -1
NATIVE = Native(spring=False, damping=True, moving_surface=True)
OF_WORLD = ("numSubSteps", "numSolverIterations", "solverResidualThreshold")
OF_LINKS = ("linearDamping", "angularDamping", "maxJointVelocity")
OF_CONTACT = ("contactERP", "frictionERP", "contactSlop", "contactBreakingThreshold")


def _some(settings: dict[str, Any], names: tuple[str, ...]) -> dict[str, Any]:
    return {name: settings[name] for name in names}


@final
class PybulletBody(Stepped):
    """The slider in a world that is open until it is closed; its URDF has the damping, which the engine takes."""

    def __init__(self, plan: Plan, settings: dict[str, Any]) -> None:
        slider, start = plan.task.scenario.slider, plan.task.scenario.x0
        self._plan, self._on_floor, self._normal = plan, plan.task.route == "contact", 0.0
        self.substeps = max(1, settings["numSubSteps"])
        self.client = client = pybullet.connect(pybullet.DIRECT)
        try:
            pybullet.setPhysicsEngineParameter(
                enableFileCaching=0,
                fixedTimeStep=settings["dt"],
                deterministicOverlappingPairs=1,
                physicsClientId=client,
                **_some(settings, OF_WORLD),
            )
            self.body = _load(replace(slider, c=slider.c * plan.scale), self._on_floor, client)
            joints = range(pybullet.getNumJoints(self.body, physicsClientId=client))
            for link in (BASE, *joints):
                pybullet.changeDynamics(self.body, link, physicsClientId=client, **_some(settings, OF_LINKS))
            for joint in joints:  # they come with a motor that is on
                self._motor(joint, pybullet.VELOCITY_CONTROL, 0.0)
            if self._on_floor:
                self._prepare_contact(settings)
            pybullet.resetJointState(self.body, SLIDE, start, plan.first_speed, physicsClientId=client)
        except BaseException:
            self.close()
            raise

    def _motor(self, joint: int, control: int, force: float, **more: float) -> None:
        pybullet.setJointMotorControl2(self.body, joint, control, force=force, physicsClientId=self.client, **more)

    def _prepare_contact(self, settings: dict[str, Any]) -> None:
        pybullet.setGravity(0.0, 0.0, -GRAVITY, physicsClientId=self.client)
        pybullet.setPhysicsEngineParameter(physicsClientId=self.client, **_some(settings, OF_CONTACT))
        for link in (BASE, LIFT):
            anchor = settings["frictionAnchor"]
            pybullet.changeDynamics(
                self.body, link, lateralFriction=1.0, frictionAnchor=anchor, physicsClientId=self.client
            )
        # at height zero the first step finds no contact: start as deep as the solver lets a box rest
        pybullet.resetJointState(self.body, LIFT, -settings["contactSlop"], 0.0, physicsClientId=self.client)

    def limit(self, force: float) -> None:
        if self._on_floor:
            # the floor's coefficient is 1: PyBullet multiplies the two
            mu = coefficient(self._plan.task.scenario.slider, force)
            pybullet.changeDynamics(self.body, LIFT, lateralFriction=mu, physicsClientId=self.client)
        else:
            # a motor's impulse limit is that of a whole step and is granted in every sub-step
            control = pybullet.VELOCITY_CONTROL
            self._motor(SLIDE, control, force / self.substeps, targetVelocity=self._plan.surface)

    def step(self, push: float) -> tuple[float, float, float]:
        """See Stepped.step; a force lasts one step."""
        body, client = self.body, self.client
        pybullet.setJointMotorControl2(body, SLIDE, pybullet.TORQUE_CONTROL, force=push, physicsClientId=client)
        pybullet.stepSimulation(physicsClientId=client)
        q, speed, _, motor = pybullet.getJointState(body, SLIDE, physicsClientId=client)
        return q, speed, self._rubbing() if self._on_floor else -motor

    def _rubbing(self) -> float:
        """Friction of the box on the left-hand side along x, N; keeps the normal force."""
        normal = friction = 0.0
        for point in pybullet.getContactPoints(self.body, self.body, physicsClientId=self.client):
            normal += point[9]
            pull = point[10] * point[11][0] + point[12] * point[13][0]
            friction += pull if point[4] == LIFT else -pull
        # impulses of the last sub-step, which the engine divides by the whole step
        self._normal = self.substeps * normal
        return float(self.substeps * friction)

    def floor(self) -> tuple[float, float]:
        if not self._on_floor:
            return 0.0, 0.0
        return float(pybullet.getJointState(self.body, LIFT, physicsClientId=self.client)[0]), self._normal

    def close(self) -> None:
        pybullet.disconnect(self.client)


def _load(slider: Slider, on_floor: bool, client: int) -> int:
    name = "slider_on_floor" if on_floor else "slider"
    flags = pybullet.URDF_USE_SELF_COLLISION | pybullet.URDF_USE_SELF_COLLISION_INCLUDE_PARENT
    with tempfile.TemporaryDirectory(prefix="friction-harness-") as folder:
        file = Path(folder) / f"{name}.urdf"
        file.write_bytes(etree.tostring(models.urdf(slider, name)))
        return int(
            pybullet.loadURDF(str(file), useFixedBase=True, flags=flags if on_floor else 0, physicsClientId=client)
        )


@final
class PybulletEngine(SteppedEngine):
    """PyBullet on one prismatic joint (joint and law routes) or a box that slides and lifts (contact route)."""

    name: ClassVar[str] = "pybullet"
    package: ClassVar[str] = "pybullet"
    shipped_dt: ClassVar[float] = 1.0 / 240.0
    bodies: ClassVar[bool] = True

    def simulate(self, task: Task) -> Trajectory:
        """See Engine.simulate; a body with six freedoms stands in a world of its own."""
        if not isinstance(task.scenario.action, Body):
            return SteppedEngine.simulate(self, task)
        from harness.engines.pybullet_bodies import body_motion

        settings, started = self.settled(task), time.perf_counter()
        with quiet(log):
            motion = body_motion(task, settings, _some(settings, (*OF_WORLD, *OF_CONTACT)))
        ignored = ("leapfrog: a body is read as it stands after each step",)
        lines = ignored if settings["leapfrog"] else ()
        return trajectory(self, task, settings, lines, motion, time.perf_counter() - started)

    def words(self, route: Route, shipped: bool, dt: float) -> dict[str, Any]:
        """See SteppedEngine.words; these are PyBullet's own."""
        return {
            "numSolverIterations": 50,
            "solverResidualThreshold": 1e-7,
            "numSubSteps": 0,
            "linearDamping": 0.04 if shipped else 0.0,
            "angularDamping": 0.04 if shipped else 0.0,
            "maxJointVelocity": 100.0 if shipped else 1e9,
            "contactERP": 0.08,
            "frictionERP": 0.2,
            "contactSlop": 1e-5,
            "contactBreakingThreshold": 0.02,
            "frictionAnchor": False,
        }

    def planned(self, task: Task, settings: dict[str, Any]) -> tuple[Plan, tuple[str, ...]]:
        return Plan(task, settings, NATIVE), ()

    def body(self, plan: Plan, settings: dict[str, Any]) -> Stepped:
        return PybulletBody(plan, settings)

    def motion(self, plan: Plan, body: Stepped, settings: dict[str, Any]) -> Motion:
        found = moved(plan, body)
        if settings["numSubSteps"] <= 1:
            return found
        # what the motor reports is the last sub-step's
        return replace(found, friction=newton_friction(plan.task, found.x, found.v, found.a, found.applied))

    def ignored(self, task: Task, settings: dict[str, Any]) -> tuple[str, ...]:
        lines = [
            "URDF spring: the format has none, -k x is applied as a force that PyBullet holds over each step",
            "MJCF: loadMJCF would ignore stiffness, damping and frictionloss, so the URDF is loaded",
        ]
        if task.route == "joint":
            lines.append(
                "URDF joint friction: read but without effect, a velocity motor limited to f_k acts in its place"
            )
        if task.route != "contact":
            shipped = self.presets(task.route, "as-shipped", task.dt)
            differ = [name for name in (*OF_CONTACT, "frictionAnchor") if settings[name] != shipped[name]]
            lines += [f"{name}: there is no contact on this route" for name in differ]
        if settings["numSubSteps"] > 1:
            lines.append("numSubSteps: applied forces stay frozen during sub-steps")
        return tuple(lines)
