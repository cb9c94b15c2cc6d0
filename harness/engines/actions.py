"""What acts on the slider in a Task, as functions of time and place that every adapter shares."""

import math

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.scenario import Belt, Harmonic, Hold
from harness.engines.base import Task


def driving_force(task: Task, t: FloatArray) -> FloatArray:
    """Action and drive of a task at times t (s), N; a belt is no force."""
    force: FloatArray = np.zeros_like(t)
    match task.scenario.action:
        case Harmonic() as action:
            force += action.amplitude * np.cos(action.omega * t + action.phase)
        case Hold() as action:
            force += action.force
    if task.drive is not None:
        force += np.interp(t, task.drive.t, task.drive.u)
    return force


def belt_speed(task: Task) -> float:
    """Speed of the floor under the slider, m/s."""
    return task.scenario.action.speed if isinstance(task.scenario.action, Belt) else 0.0


def restoring_force(task: Task, x: float) -> float:
    """k x, k sin x or nothing, N."""
    k = task.scenario.slider.k
    if task.restoring == "spring":
        return k * x
    return k * math.sin(x) if task.restoring == "pendulum" else 0.0


def load_at_start(task: Task) -> float:
    """Every force but dry friction and a force law at t = 0, N."""
    scenario = task.scenario
    driven = float(driving_force(task, np.zeros(1))[0])
    return driven - restoring_force(task, scenario.x0) - scenario.slider.c * scenario.v0


def held_at_start(task: Task) -> bool:
    """Whether the slider starts at rest on its floor with no more than the break-away force on it."""
    if task.scenario.v0 != belt_speed(task):
        return False
    return abs(load_at_start(task)) <= task.scenario.slider.break_away


def acceleration_at_start(task: Task) -> float:
    """Acceleration just after t = 0 without a force law, m/s^2."""
    if held_at_start(task):
        return 0.0
    scenario = task.scenario
    load = load_at_start(task)
    sliding = scenario.v0 - belt_speed(task)
    direction = math.copysign(1.0, sliding if sliding != 0.0 else load)
    return (load - direction * scenario.slider.f_k) / scenario.slider.m
