"""How PyBullet is stepped: the general way, and a lean loop where only the spring depends on the state."""

from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.slider import Slider
from harness.engines.base import Task
from harness.engines.pybullet.world import LIFT, SLIDE, World, pybullet
from harness.engines.samples import Motion, newton_friction
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
