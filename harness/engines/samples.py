"""What acts on the slider in a Task, as every adapter shares it, and what an engine recorded, as a core Trajectory."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.events import Mode
from harness.core.scenario import Belt, Harmonic, Hold
from harness.core.trajectory import Source, Trajectory
from harness.engines.base import Engine, Restoring, Task


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
        force -= float(task.words.force(np.array(scenario.x0), np.array(scenario.v0 - belt_speed(task))))
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


UNSATURATED = 1.0 - 1e-6
"""A friction force below this share of its limit is not saturated: the contact sticks."""


@dataclass(frozen=True, slots=True)
class Motion:
    """Samples at t = i dt in the frame of the laboratory; arrays of shape (n + 1,).

    x : m. v : m/s. a : m/s^2. applied : driving forces and force law, N. friction : dry friction on the left-hand side,
    N. limit : what |friction| could have reached, N. lift : m, normal : N, on the contact route.
    """

    x: FloatArray
    v: FloatArray
    a: FloatArray
    applied: FloatArray
    friction: FloatArray
    limit: FloatArray
    lift: FloatArray | None = None
    normal: FloatArray | None = None


def restoring_forces(task: Task, x: FloatArray) -> FloatArray:
    """k x, k sin x or nothing, N."""
    k = task.scenario.slider.k
    forces: dict[Restoring, FloatArray] = {"spring": k * x, "pendulum": k * np.sin(x), "none": np.zeros_like(x)}
    return forces[task.restoring]


def newton_friction(task: Task, x: FloatArray, v: FloatArray, a: FloatArray, applied: FloatArray) -> FloatArray:
    """Dry friction as what Newton's second law leaves: u - m a - c v - restoring force, N."""
    slider = task.scenario.slider
    if task.words is not None:
        applied = applied - task.words.force(x, v - belt_speed(task))  # the joint is the belt's
    return applied - slider.m * a - slider.c * v - restoring_forces(task, x)


def _farthest(task: Task, motion: Motion) -> float:
    """A distance no sound run reaches: a thousand times what its start and its forces explain, m."""
    if task.restoring != "spring":
        return np.inf
    scenario, slider = task.scenario, task.scenario.slider
    forces = np.abs(motion.applied[np.isfinite(motion.applied)]).max(initial=0.0) + slider.break_away
    start = abs(scenario.x0) + abs(scenario.v0) / slider.omega_n + forces / slider.k
    return float(1e3 * (1.0 + slider.omega_n * scenario.duration) * (start + abs(belt_speed(task)) / slider.omega_n))


def trajectory(
    engine: Engine, task: Task, settings: dict[str, Any], ignored: tuple[str, ...], motion: Motion, wall: float
) -> Trajectory:
    """The validated Trajectory of a run; raises SimulationError with the time for one that diverged."""
    dt = float(settings["dt"])
    t: FloatArray = np.arange(motion.x.size, dtype=np.float64) * dt
    sound = np.isfinite(motion.x) & np.isfinite(motion.v) & np.isfinite(motion.a)
    broken = np.flatnonzero(~(sound & (np.abs(motion.x) <= _farthest(task, motion))))
    if broken.size:
        raise SimulationError(f"{engine.name}: the run diverged at t = {t[broken[0]]:g} s (dt = {dt:g} s)")
    stuck = np.abs(motion.friction) < UNSATURATED * motion.limit
    direction = np.sign(motion.v - belt_speed(task))
    for otherwise in (motion.friction, motion.a):  # at rest, about to move
        direction = np.where(direction == 0.0, np.sign(otherwise), direction)
    mode = np.where(stuck, int(Mode.STICK), direction).astype(np.int8)
    extra = {"friction_force": motion.friction}
    extra |= {name: y for name, y in (("lift", motion.lift), ("normal_force", motion.normal)) if y is not None}
    route = {"route": task.route, "restoring": task.restoring}
    source = Source(engine.name, task.preset, engine.version(), dt, route | settings, ignored, wall)
    return Trajectory(t, motion.x, motion.v, motion.a, source, motion.applied, mode, extra)
