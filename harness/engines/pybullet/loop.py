"""The step loops: a lean one where only the spring depends on the state, a general one for everything else."""

from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.engines.actions import acceleration_at_start, belt_speed, driving_force, held_at_start, restoring_force
from harness.engines.base import Task
from harness.engines.models import GRAVITY
from harness.engines.pybullet.client import pybullet
from harness.engines.pybullet.world import LIFT, SLIDE, World
from harness.engines.samples import UNSATURATED, Motion, newton_friction


class Run:
    """One task in the numbers that PyBullet is given.

    With leapfrog every force is scaled by m/(m + c dt/2), which makes damping act on the mean of the speeds before and
    after the step. Contact and belt: the box lives in the frame of the belt and the spring's end moves instead.

    model : the slider whose URDF is loaded. first_speed : speed of the joint at the start, m/s.
    """

    def __init__(self, task: Task, settings: dict[str, Any]) -> None:
        slider = task.scenario.slider
        self.task, self.settings = task, settings
        self.dt: float = settings["dt"]
        self.steps = task.steps(self.dt) + 1  # one more than samples need: acceleration is that of the step to come
        self.scale = slider.m / (slider.m + 0.5 * self.dt * slider.c) if settings["leapfrog"] else 1.0
        self.model = replace(slider, c=slider.c * self.scale)
        belt = belt_speed(task)
        self.frame = belt if task.route == "contact" else 0.0
        self.target = belt if task.route == "joint" else 0.0
        self.surface = belt - self.frame
        self.substeps = max(1, settings["numSubSteps"])
        self.t = self.dt * np.arange(self.steps)
        self.driving = driving_force(task, self.t)
        back = 0.5 * self.dt * acceleration_at_start(task, self.dt) if settings["leapfrog"] else 0.0
        self.first_speed = task.scenario.v0 - self.frame - back

    def motion(self, world: World) -> Motion:
        """Step through the run."""
        slider = self.task.scenario.slider
        simple = self.task.law is None and self.task.route == "joint" and slider.break_away == slider.f_k
        return self._plain(world) if simple and self.task.restoring != "pendulum" else self._general(world)

    def _plain(self, world: World) -> Motion:
        """Joint route with one constant level of friction: only the spring depends on the state."""
        slider, body, client = self.task.scenario.slider, world.body, world.client
        stiffness = self.scale * slider.k if self.task.restoring == "spring" else 0.0
        pushes: list[float] = (self.scale * self.driving).tolist()
        world.limit("joint", self.scale * slider.f_k, self.target, slider, self.substeps)
        push, step, read = pybullet.setJointMotorControl2, pybullet.stepSimulation, pybullet.getJointState
        torque = pybullet.TORQUE_CONTROL
        q, speed = self.task.scenario.x0, self.first_speed
        positions, speeds, motor = [q], [speed], []
        for force in pushes:
            push(body, SLIDE, torque, force=force - stiffness * q, physicsClientId=client)
            step(physicsClientId=client)
            q, speed, _, friction = read(body, SLIDE, physicsClientId=client)
            positions.append(q)
            speeds.append(speed)
            motor.append(friction)
        limits = np.full(self.steps, slider.f_k)
        return self._samples(positions, speeds, self.driving, limits, -np.array(motor) / self.scale)

    def _general(self, world: World) -> Motion:
        """Every route, with force laws, levels of friction and break-away decided step by step."""
        task, dt, scale = self.task, self.dt, self.scale
        slider, law, route = task.scenario.slider, task.law, task.route
        body, client = world.body, world.client
        state = np.zeros(0) if law is None else law.state.copy()
        ratio = slider.break_away / slider.f_k if slider.f_k > 0.0 else 1.0
        excess = slider.break_away if slider.f_k == 0.0 else 0.0
        stuck = held_at_start(task, dt)
        applied, limits, friction = np.empty(self.steps), np.empty(self.steps), np.empty(self.steps)
        lift, normal = np.zeros(self.steps), np.zeros(self.steps)
        q, speed, last, in_force = task.scenario.x0, self.first_speed, self.first_speed, -1.0
        height = -self.settings["contactSlop"] if route == "contact" else 0.0
        positions, speeds = [q], [speed]
        for i in range(self.steps):
            t = i * dt
            x = q + self.frame * t
            # with leapfrog the joint's speed is that of half a step ago
            v = speed + self.frame + (0.5 * (speed - last) if self.settings["leapfrog"] else 0.0)
            force, level = self.driving[i], slider.f_k
            if law is not None:
                if law.advance is not None:
                    law.advance(t, x, v, dt, state, law.params)
                if law.force is not None:
                    force += law.force(t, x, v, state, law.params)
                if law.level is not None:
                    level = law.level(t, x, v, state, law.params)
            limit = level * ratio + excess if stuck else level
            push = scale * (force - restoring_force(task, x) - slider.c * self.frame)
            if route == "law":
                wanted = slider.m * (speed - self.surface) / dt + push - scale * slider.c * speed
                friction[i] = min(max(wanted / scale, -limit), limit)
                push -= scale * friction[i]
            elif limit != in_force:
                world.limit(route, scale * limit, self.target, slider, self.substeps)
                in_force = limit
            pybullet.setJointMotorControl2(body, SLIDE, pybullet.TORQUE_CONTROL, force=push, physicsClientId=client)
            pybullet.stepSimulation(physicsClientId=client)
            last = speed
            q, speed, _, motor = pybullet.getJointState(body, SLIDE, physicsClientId=client)
            if route == "joint":
                friction[i] = -motor / scale
            elif route == "contact":
                lift[i] = height
                # impulses of the last sub-step, which the engine divides by the whole step
                normal[i], friction[i] = (self.substeps * force for force in world.contact())
                friction[i] /= scale
                height = pybullet.getJointState(body, LIFT, physicsClientId=client)[0]
                limit *= normal[i] / (slider.m * GRAVITY)
            stuck = bool(abs(friction[i]) < UNSATURATED * limit)
            applied[i], limits[i] = force, limit
            positions.append(q)
            speeds.append(speed)
        motion = self._samples(positions, speeds, applied, limits, friction)
        return replace(motion, lift=lift, normal=normal) if route == "contact" else motion

    def _samples(
        self,
        positions: list[float],
        speeds: list[float],
        applied: FloatArray,
        limits: FloatArray,
        friction: FloatArray,
    ) -> Motion:
        joint = np.array(speeds) + self.frame
        x = np.array(positions[:-1]) + self.frame * self.t
        a = np.diff(joint) / self.dt
        v = joint[:-1].copy()
        if self.settings["leapfrog"]:
            v = 0.5 * (joint[:-1] + joint[1:])
            v[0] = self.task.scenario.v0
        if self.substeps > 1:
            # what the motor reports is the last sub-step's
            friction = newton_friction(self.task, x, v, a, applied)
        return Motion(x, v, a, applied, friction, limits)
