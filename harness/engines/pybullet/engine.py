"""PyBullet: spring and driving forces as a torque each step, dry friction as a velocity motor limited to f_k.

How PyBullet is stepped: the general way, and a lean loop where only the spring depends on the state.
"""

import time
from dataclasses import replace
from typing import Any, ClassVar, final

import numpy as np

from harness.core.quiet import quiet
from harness.core.registered import version
from harness.core.slider import Slider
from harness.core.trajectory import Trajectory
from harness.engines.base import TUNED_DT, Engine, Preset, Route, Task, resolve
from harness.engines.pybullet.world import LIFT, SLIDE, World, log, opened, pybullet
from harness.engines.samples import Motion, newton_friction, trajectory
from harness.engines.stepping import Native, Plan, Stepped, stepped_through

NATIVE = Native(spring=False, damping=True, moving_surface=True)


def plan(task: Task, settings: dict[str, Any]) -> Plan:
    """The numbers of a task as PyBullet is given them."""
    return Plan(task, settings, NATIVE)


def model(plan: Plan) -> Slider:
    """The slider whose URDF is loaded: its damping is the engine's and so is scaled."""
    slider = plan.task.scenario.slider
    return replace(slider, c=slider.c * plan.scale)


class PybulletBody(Stepped):
    """The slider in an open world."""

    def __init__(self, world: World, plan: Plan, substeps: int) -> None:
        self._world, self._plan, self._substeps = world, plan, substeps
        self._on_floor = plan.task.route == "contact"
        self._normal = 0.0

    def limit(self, force: float) -> None:
        """See Stepped.limit."""
        plan = self._plan
        self._world.limit(plan.task.route, force, plan.surface, plan.task.scenario.slider, self._substeps)

    def step(self, push: float) -> tuple[float, float, float]:
        """See Stepped.step; a force lasts one step."""
        body, client = self._world.body, self._world.client
        pybullet.setJointMotorControl2(body, SLIDE, pybullet.TORQUE_CONTROL, force=push, physicsClientId=client)
        pybullet.stepSimulation(physicsClientId=client)
        q, speed, _, motor = pybullet.getJointState(body, SLIDE, physicsClientId=client)
        if not self._on_floor:
            return q, speed, -motor
        # impulses of the last sub-step, which the engine divides by the whole step
        self._normal, friction = (self._substeps * force for force in self._world.contact())
        return q, speed, friction

    def floor(self) -> tuple[float, float]:
        """See Stepped.floor."""
        if not self._on_floor:
            return 0.0, 0.0
        world = self._world
        height = pybullet.getJointState(world.body, LIFT, physicsClientId=world.client)[0]
        return float(height), self._normal


def motion(plan: Plan, world: World, substeps: int) -> Motion:
    """Step through a run."""
    lean = plan.simple() and plan.task.route == "joint"
    moved = _lean(plan, world, substeps) if lean else stepped_through(plan, PybulletBody(world, plan, substeps))
    if substeps == 1:
        return moved
    # what the motor reports is the last sub-step's
    return replace(moved, friction=newton_friction(plan.task, moved.x, moved.v, moved.a, moved.applied))


def _lean(plan: Plan, world: World, substeps: int) -> Motion:
    """Joint route with one constant level of friction, in as few calls a step as can be."""
    slider, body, client = plan.task.scenario.slider, world.body, world.client
    stiffness = plan.scale * slider.k if plan.task.restoring == "spring" else 0.0
    pushes: list[float] = (plan.scale * plan.driving).tolist()
    world.limit("joint", plan.scale * slider.f_k, plan.surface, slider, substeps)
    push, step, read = pybullet.setJointMotorControl2, pybullet.stepSimulation, pybullet.getJointState
    torque = pybullet.TORQUE_CONTROL
    q, speed = plan.task.scenario.x0, plan.first_speed
    positions, speeds, motor = [q], [speed], []
    for force in pushes:
        push(body, SLIDE, torque, force=force - stiffness * q, physicsClientId=client)
        step(physicsClientId=client)
        q, speed, _, friction = read(body, SLIDE, physicsClientId=client)
        positions.append(q)
        speeds.append(speed)
        motor.append(friction)
    limits = np.full(plan.steps, slider.f_k)
    return plan.samples(positions, speeds, plan.driving, limits, -np.array(motor) / plan.scale)


SHIPPED_DT = 1.0 / 240.0
"""PyBullet's own step, s."""

CONTACT_ONLY = ("contactERP", "frictionERP", "contactSlop", "contactBreakingThreshold", "frictionAnchor")


def presets(route: Route, preset: Preset, dt: float | None) -> dict[str, Any]:
    """Every setting of a preset; see harness.engines.base.Engine.presets.

    leapfrog : read PyBullet's step (v+ = v + dt a(x), x+ = x + dt v+) as the leapfrog it is: the run starts with the
    speed of half a step earlier, damping is scaled to act on the speed in the middle, and the speed of a sample is the
    mean of those half a step to either side. The other names are PyBullet's own.
    """
    settings: dict[str, Any] = {
        "dt": SHIPPED_DT if dt is None else dt,
        "leapfrog": False,
        "numSolverIterations": 50,
        "solverResidualThreshold": 1e-7,
        "numSubSteps": 0,
        "linearDamping": 0.04,
        "angularDamping": 0.04,
        "maxJointVelocity": 100.0,
        "contactERP": 0.08,
        "frictionERP": 0.2,
        "contactSlop": 1e-5,
        "contactBreakingThreshold": 0.02,
        "frictionAnchor": False,
    }
    if preset == "tuned":
        settings |= {
            "dt": TUNED_DT if dt is None else dt,
            "leapfrog": True,
            "linearDamping": 0.0,
            "angularDamping": 0.0,
            "maxJointVelocity": 1e9,
        }
    return settings


def unused(settings: dict[str, Any], shipped: dict[str, Any], route: Route) -> tuple[str, ...]:
    """What PyBullet does not honour, of the model and of settings that differ from what ships, one sentence each."""
    lines = [
        "URDF spring: the format has none, -k x is applied as a force that PyBullet holds over each step",
        "MJCF: loadMJCF would ignore stiffness, damping and frictionloss, so the URDF is loaded",
    ]
    if route == "joint":
        lines.append("URDF joint friction: read but without effect, a velocity motor limited to f_k stands for it")
    if route != "contact":
        differ = [name for name in CONTACT_ONLY if settings[name] != shipped[name]]
        lines += [f"{name}: there is no contact on this route" for name in differ]
    if settings["numSubSteps"] > 1:
        lines.append("numSubSteps: applied forces stay frozen during sub-steps")
    return tuple(lines)


@final
class PybulletEngine(Engine):
    """PyBullet on one prismatic joint (joint and law routes) or a box that slides and lifts (contact route)."""

    name: ClassVar[str] = "pybullet"

    def version(self) -> str:
        """Version of the pybullet package."""
        return version("pybullet")

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        """Settings of a preset; see Engine.presets."""
        return presets(route, preset, dt)

    def simulate(self, task: Task) -> Trajectory:
        """Run a task; see Engine.simulate."""
        settings = resolve(self, task)
        ignored = unused(settings, self.presets(task.route, "as-shipped", task.dt), task.route)
        planned = plan(task, settings)
        built, substeps = model(planned), max(1, settings["numSubSteps"])
        with quiet(log), opened(built, task.route, settings, task.scenario.x0, planned.first_speed) as world:
            started = time.perf_counter()
            recorded = motion(planned, world, substeps)
            wall = time.perf_counter() - started
        return trajectory(self, task, settings, ignored, recorded, wall)
