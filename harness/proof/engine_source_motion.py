"""The motion of a plant as an engine has it: spring, damper and dry friction are the engine's, the rest is pushed with.

The step of both engines, v+ = v + h a(x), x+ = x + h v+, is read as the leapfrog it is: the run begins with the speed
of half a step earlier, and the speed at a step is the mean of those before and after it (Hairer, Lubich and Wanner,
Acta Numerica 12, 2003).
"""

import math
from abc import ABC, abstractmethod

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.proof.plant.friction import Regularised
from harness.proof.plant.integrate import PlantRun
from harness.proof.plant.machine import Machine
from harness.proof.plant.model import PlantModel

FINENESS = 2.5e-4
"""Step times the fastest frequency: the motion is within 5e-5 of its length there, a tenth of the least noise."""
MOST_STEPS = 2_000_000


class Body(ABC):
    """The slider in one engine."""

    @abstractmethod
    def step(self, push: float, limit: float) -> tuple[float, float]:
        """Push with a force (N) for one step, friction limited (N); position (m) and speed (m/s) after it."""

    @abstractmethod
    def close(self) -> None:
        """Give back what the engine holds."""


class Task:
    """One plant in the numbers that an engine is given.

    dt : step, s. x0 : m. first_speed : half a step before the start, m/s. Raises SimulationError for what no engine is
    told: friction or branches with states of their own, break-away above the level at rest, another spring.
    """

    def __init__(self, model: PlantModel, duration: float) -> None:
        friction = model.friction
        level = friction.level
        if model.branches or friction.states or (level.f_s != level.f_k and level.v_s is None):
            raise SimulationError("engine source: states of their own and break-away are not for an engine")
        if model.restoring != "spring" or model.release > 0.0:
            raise SimulationError("engine source: a slider on its spring, free from the start, is accepted")
        self.model, self.machine = model, Machine(model)
        rates = [model.omega_n, *(force.rate for force in model.forces)]
        if model.drive is not None:
            rates.append(model.drive.rate)
        self.dt = FINENESS / max(rates)
        self.steps = math.ceil(duration / self.dt) + 1
        if self.steps > MOST_STEPS:
            raise SimulationError(f"engine source: {self.steps} steps, {MOST_STEPS} at most")
        self.smooth = friction if isinstance(friction, Regularised) else None
        self.x0 = model.x0
        start = [model.x0, model.v0]
        d = self.machine.direction(0.0, [*start, 0.0])
        first = self.machine.motion(0.0, [*start, 0.0], d)[0] if d != 0.0 else 0.0
        self.first_acceleration = first
        self.first_speed = model.v0 - 0.5 * self.dt * first

    def pulses(self) -> FloatArray:
        """Forces (N) of the knocks, shape (steps,): each spread over two steps so that both moments are right."""
        push = np.zeros(self.steps + 1)
        for knock in self.model.knocks:
            i = int(knock.time / self.dt)
            if i < self.steps:
                # the speed of step i is the mean over it: only what comes after the knock counts
                late = knock.time / self.dt - i
                push[i] += (1.0 - late) * knock.impulse / self.dt
                push[i + 1] += late * knock.impulse / self.dt
        return push[: self.steps]


def run(task: Task, body: Body, t: FloatArray) -> PlantRun:
    """Step a body through a task; the motion at the times t (s, shape (n,), from 0 on)."""
    x, half = _stepped(task, body)
    model, dt = task.model, task.dt
    v = 0.5 * (half[:-1] + half[1:])
    v[0] = model.v0
    a = np.diff(half) / dt - task.pulses() / model.m
    at = dt * np.arange(task.steps)
    where = CubicHermiteSpline(at, x, v)
    x_t, v_t, a_t = np.asarray(where(t)), np.interp(t, at, v), np.interp(t, at, a)
    states = [list(pair) for pair in zip(x_t.tolist(), v_t.tolist(), strict=True)]
    net = np.array(
        [task.machine.net(now, s, math.copysign(1.0, s[1])) for now, s in zip(t.tolist(), states, strict=True)]
    )
    u = np.zeros(t.size)
    if model.drive is not None:
        u = np.array([model.drive.law(now, *s) for now, s in zip(t.tolist(), states, strict=True)])
    still = np.abs(v_t) < 1e-5 * task.machine.units[1]
    sign = np.where(np.abs(v) < 1e-9 * task.machine.units[1], 0.0, np.sign(v))
    turns = at[1:][(sign[:-1] != 0.0) & (sign[1:] != sign[:-1])]
    return PlantRun(t, x_t, v_t, a_t, u, net - model.m * a_t, still, np.zeros((t.size, 0)), turns)


def _stepped(task: Task, body: Body) -> tuple[FloatArray, FloatArray]:
    """Positions (steps,) at and speeds (steps + 1,) half a step before the steps, and after the last."""
    model, machine, level, smooth = task.model, task.machine, task.model.friction.level, task.smooth
    laws, drive, dt = machine.laws, model.drive, task.dt
    constant = level.v_s is None and not level.modulations
    limit = 0.0 if smooth is not None else level.f_k
    pulses: list[float] = task.pulses().tolist()
    x, speed, before = task.x0, task.first_speed, task.first_speed - dt * task.first_acceleration
    positions, speeds = [x], [speed]
    for i, pulse in enumerate(pulses):
        # the speed now, half a step after the one that is known
        v = speed + 0.5 * (speed - before)
        now = i * dt
        d = math.copysign(1.0, v) if v != 0.0 else 0.0
        push = pulse
        for law in laws:
            push -= law(now, x, v, d)
        if drive is not None:
            push += drive.law(now, x, v)
        if smooth is not None or not constant:
            net = push - pulse - model.c * v - model.k * x
            height = level.sliding(now, x, v, net, 0.0)
            if smooth is None:
                limit = height
            else:
                push -= smooth.act(height, v, d, net / model.m, 0.0)[0]
        before = speed
        x, speed = body.step(push, limit)
        positions.append(x)
        speeds.append(speed)
    return np.array(positions[:-1]), np.array(speeds)
