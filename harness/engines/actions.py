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


def level_at_start(task: Task, dt: float) -> tuple[float, float]:
    """Sliding and break-away friction at t = 0, N."""
    slider, law = task.scenario.slider, task.law
    if law is None or law.level is None:
        return slider.f_k, slider.break_away
    level = float(law.level(*_start_of(task, dt)))
    return level, level * slider.break_away / slider.f_k if slider.f_k > 0.0 else level + slider.break_away


def load_at_start(task: Task, dt: float) -> float:
    """Every force but dry friction at t = 0, N; ``dt`` is the step a law's internal states would advance by."""
    scenario, law = task.scenario, task.law
    force = float(driving_force(task, np.zeros(1))[0])
    if law is not None and law.force is not None:
        force += float(law.force(*_start_of(task, dt)))
    if task.words is not None:
        force -= float(task.words.force(np.array(scenario.x0), np.array(scenario.v0)))
    return force - restoring_force(task, scenario.x0) - scenario.slider.c * scenario.v0


def _start_of(task: Task, dt: float) -> tuple[float, float, float, FloatArray, FloatArray]:
    """Arguments of a law at t = 0, its states moved as they will be then."""
    assert task.law is not None
    scenario, (state, params) = task.scenario, task.law.own()
    if task.law.advance is not None:
        task.law.advance(0.0, scenario.x0, scenario.v0, dt, state, params)
    return 0.0, scenario.x0, scenario.v0, state, params


def held_at_start(task: Task, dt: float) -> bool:
    """Whether the slider starts at rest on its floor with no more than the break-away force on it."""
    if task.scenario.v0 != belt_speed(task):
        return False
    return abs(load_at_start(task, dt)) <= level_at_start(task, dt)[1]


def acceleration_at_start(task: Task, dt: float) -> float:
    """Acceleration just after t = 0, m/s^2."""
    if held_at_start(task, dt):
        return 0.0
    scenario = task.scenario
    load = load_at_start(task, dt)
    sliding = scenario.v0 - belt_speed(task)
    direction = math.copysign(1.0, sliding if sliding != 0.0 else load)
    return (load - direction * level_at_start(task, dt)[0]) / scenario.slider.m
