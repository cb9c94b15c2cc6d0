"""What an engine recorded, put together as a core Trajectory."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.events import Mode
from harness.core.trajectory import Source, Trajectory
from harness.engines.actions import belt_speed
from harness.engines.base import Engine, Restoring, Task

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


def restoring_force(task: Task, x: FloatArray) -> FloatArray:
    """k x, k sin x or nothing, N."""
    k = task.scenario.slider.k
    forces: dict[Restoring, FloatArray] = {"spring": k * x, "pendulum": k * np.sin(x), "none": np.zeros_like(x)}
    return forces[task.restoring]


def newton_friction(task: Task, x: FloatArray, v: FloatArray, a: FloatArray, applied: FloatArray) -> FloatArray:
    """Dry friction as what Newton's second law leaves: u - m a - c v - restoring force, N."""
    slider = task.scenario.slider
    if task.words is not None:
        applied = applied - task.words.force(x, v)
    return applied - slider.m * a - slider.c * v - restoring_force(task, x)


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
    if motion.lift is not None and motion.normal is not None:
        extra |= {"lift": motion.lift, "normal_force": motion.normal}
    route = {"route": task.route, "restoring": task.restoring}
    source = Source(engine.name, task.preset, engine.version(), dt, route | settings, ignored, wall)
    return Trajectory(t, motion.x, motion.v, motion.a, source, motion.applied, mode, extra)
