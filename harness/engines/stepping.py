"""For engines that are stepped from outside: what to push with before each step, and what the samples mean.

Friction of engines that do not tell it: what is missing in the momentum of a step.
"""

import logging
import math
import time
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quiet import quiet
from harness.core.trajectory import Trajectory
from harness.engines.base import TUNED_DT, Engine, Preset, Route, Task, choice, resolve
from harness.engines.joint_words import GRAVITY
from harness.engines.samples import (
    UNSATURATED,
    Motion,
    acceleration_at_start,
    belt_speed,
    driving_force,
    held_at_start,
    restoring_force,
    trajectory,
)


@dataclass(frozen=True, slots=True)
class Native:
    """Which parts of the slider the engine computes by itself; the others are pushed with.

    implicit : the engine takes damping (and its spring) at the end of the step. moving_surface : its joint friction can
    be given the speed of a belt; without it the joint lives in the frame of the belt and the spring's end moves.
    break_away : its friction has a static level besides, f_s for a limit of f_k; it is not switched from outside.
    """

    spring: bool
    damping: bool
    implicit: bool = False
    moving_surface: bool = False
    break_away: bool = False


class Stepped(ABC):
    """One engine with one slider in it, ready to be stepped. Forces are those of the engine (Plan.scale).

    sticks_below : share of the limit below which the friction force means that the slider sticks; less than
    UNSATURATED where friction is a smooth function of the speed, which never quite reaches its limit.
    """

    sticks_below: float = UNSATURATED

    @abstractmethod
    def limit(self, force: float) -> None:
        """Set the limit of the engine's friction force, N."""

    @abstractmethod
    def step(self, push: float) -> tuple[float, float, float]:
        """Push with a force (N) for one step; position, speed and friction force on the left-hand side after it."""

    def floor(self) -> tuple[float, float]:
        """Height of the box (m) and normal force (N) after the last step; zeros where there is no floor."""
        return 0.0, 0.0

    def close(self) -> None:  # noqa: B027  (most hold nothing)
        """Give back what the engine holds."""


class Plan:
    """One task in the numbers that a stepped engine is given.

    With leapfrog a step v+ = v + dt a(x), x+ = x + dt v+ is read as the leapfrog it is: the run starts with the speed
    of half a step earlier, every force is scaled by m/(m + c dt/2), which makes damping act on the mean of the speeds
    before and after the step, and the speed of a sample is that mean.

    first_speed : speed of the joint at the start, m/s. frame : speed of the frame the joint lives in, m/s. surface :
    speed of what rubs in that frame, m/s. steps : one more than samples need, acceleration is that of the step to come.
    """

    def __init__(self, task: Task, settings: dict[str, Any], native: Native) -> None:
        slider = task.scenario.slider
        self.task, self.native = task, native
        self.leapfrog: bool = settings["leapfrog"]
        self.dt: float = settings["dt"]
        self.steps = task.steps(self.dt) + 1
        self.scale = slider.m / (slider.m + 0.5 * self.dt * slider.c) if self.leapfrog else 1.0
        belt = belt_speed(task)
        keeps_frame = native.moving_surface and task.route != "contact"
        self.frame = 0.0 if keeps_frame else belt
        self.surface = belt - self.frame
        self.t: FloatArray = np.arange(self.steps, dtype=np.float64) * self.dt
        self.driving = driving_force(task, self.t)
        back = 0.5 * self.dt * acceleration_at_start(task, self.dt) if self.leapfrog else 0.0
        self.first_speed = task.scenario.v0 - self.frame - back

    def limits(self, friction: FloatArray, speeds: FloatArray, level: float, static: float) -> FloatArray:
        """What |friction| (N) could have reached in steps that end with these speeds (m/s).

        A joint that breaks away by itself slides at ``level`` (N), and no slower than half a step under what break-away
        leaves over; what crosses the level at rest is still held, up to ``static`` (N).
        """
        if not self.native.break_away:
            return np.full(friction.shape, level)
        slow = 0.5 * self.dt * (static - level) / self.task.scenario.slider.m
        return np.where((np.abs(friction) >= UNSATURATED * level) & (np.abs(speeds) > slow), level, static)

    def simple(self) -> bool:
        """Whether friction is the engine's, of constant levels, and nothing but the spring depends on the state."""
        slider, task = self.task.scenario.slider, self.task
        plain = task.law is None and task.route != "law" and task.restoring != "pendulum"
        return plain and (slider.break_away == slider.f_k or self.native.break_away)

    def push(self, q: float, speed: float, t: float, force: float) -> tuple[float, float]:
        """Force to push the joint with (N), and the sum of all forces but friction, both scaled."""
        slider, task = self.task.scenario.slider, self.task
        x = q + self.frame * t
        spring = restoring_force(task, x)
        damping = slider.c * (speed + self.frame)
        others = self.scale * (force - spring - damping)
        engine = restoring_force(task, q) if self.native.spring and task.restoring == "spring" else 0.0
        if self.native.damping:
            engine += slider.c * speed
        return others + self.scale * engine, others

    def samples(
        self,
        positions: list[float],
        speeds: list[float],
        applied: FloatArray,
        limits: FloatArray,
        friction: FloatArray,
    ) -> Motion:
        """Motion from the joint's positions and speeds before the first and after every step."""
        joint = np.array(speeds) + self.frame
        x = np.array(positions[:-1]) + self.frame * self.t
        v = joint[:-1].copy()
        if self.leapfrog:
            v = 0.5 * (joint[:-1] + joint[1:])
            v[0] = self.task.scenario.v0
        a = np.diff(joint) / self.dt
        if self.native.implicit:
            # (v+ - v)/dt holds the forces of the end of the step; these are those of the sample
            slider = self.task.scenario.slider
            spring = np.array([restoring_force(self.task, position) for position in x])
            a = (applied - slider.c * v - spring - friction) / slider.m
        return Motion(x, v, a, applied, friction, limits)


def moved(plan: Plan, body: Stepped) -> Motion:
    """Step through a run: in as few calls a step as can be where friction has one constant level."""
    return _lean(plan, body) if plan.simple() else stepped_through(plan, body)


def _lean(plan: Plan, body: Stepped) -> Motion:
    slider, task, scale, native = plan.task.scenario.slider, plan.task, plan.scale, plan.native
    k = slider.k if task.restoring == "spring" else 0.0
    # a frame that moves stretches the spring and is damped whoever computes the two
    pushes: list[float] = (scale * (plan.driving - plan.frame * (k * plan.t + slider.c))).tolist()
    stiffness = 0.0 if native.spring else scale * k
    damping = 0.0 if native.damping else scale * slider.c
    body.limit(scale * slider.f_k)
    q, speed, step = task.scenario.x0, plan.first_speed, body.step
    positions, speeds, friction = [q], [speed], []
    floors, floor = ([body.floor()], body.floor) if task.route == "contact" else ([], None)
    for force in pushes:
        q, speed, rubbing = step(force - stiffness * q - damping * speed)
        positions.append(q)
        speeds.append(speed)
        friction.append(rubbing)
        if floor is not None:
            floors.append(floor())
    rubs = np.array(friction) / scale
    limits = plan.limits(rubs, np.array(speeds[1:]), slider.f_k, slider.break_away) * (body.sticks_below / UNSATURATED)
    if floor is None:
        return plan.samples(positions, speeds, plan.driving, limits, rubs)
    height, normal = np.array(floors)[:-1, 0], np.array(floors)[1:, 1]
    limits *= normal / (slider.m * GRAVITY)
    motion = plan.samples(positions, speeds, plan.driving, limits, rubs)
    return replace(motion, lift=height, normal=normal)


def stepped_through(plan: Plan, body: Stepped) -> Motion:
    """Every route, with force laws, levels of friction and break-away decided step by step."""
    task, dt, scale = plan.task, plan.dt, plan.scale
    slider, law, route = task.scenario.slider, task.law, task.route
    state, params = (np.zeros(0), np.zeros(0)) if law is None else law.own()
    ratio = slider.break_away / slider.f_k if slider.f_k > 0.0 else 1.0
    excess = slider.break_away if slider.f_k == 0.0 else 0.0
    switched = not plan.native.break_away
    metric = slider.m / dt + (slider.c if plan.native.implicit and plan.native.damping else 0.0)
    stuck = held_at_start(task, dt)
    applied, limits, friction = np.empty(plan.steps), np.empty(plan.steps), np.empty(plan.steps)
    lift, normal = np.zeros(plan.steps), np.zeros(plan.steps)
    q, speed, last, in_force = task.scenario.x0, plan.first_speed, plan.first_speed, -1.0
    lift[0] = body.floor()[0]
    positions, speeds = [q], [speed]
    for i in range(plan.steps):
        t = i * dt
        force, level = float(plan.driving[i]), slider.f_k
        if law is not None:
            x, v = q + plan.frame * t, speed + plan.frame
            if plan.leapfrog:
                v += 0.5 * (speed - last)  # the joint's speed is that of half a step ago
            if law.advance is not None:
                law.advance(t, x, v, dt, state, params)
            if law.force is not None:
                force += law.force(t, x, v, state, params)
            if law.level is not None:
                level = law.level(t, x, v, state, params)
        limit = level * ratio + excess if stuck and switched else level
        push, others = plan.push(q, speed, t, force)
        if route == "law":
            wanted = metric * (speed - plan.surface) + others
            held = min(max(wanted / scale, -limit), limit)
            push -= scale * held
        elif limit != in_force:
            body.limit(scale * limit)
            in_force = limit
        last = speed
        q, speed, rubbing = body.step(push)
        friction[i] = held if route == "law" else rubbing / scale
        if route == "contact":
            height, normal[i] = body.floor()
            lift[i + 1 : i + 2] = height
            limit *= body.sticks_below / UNSATURATED * normal[i] / (slider.m * GRAVITY)
        if not switched:
            limit = float(plan.limits(friction[i], np.asarray(speed), level, level * ratio + excess))
        stuck = bool(abs(friction[i]) < UNSATURATED * limit)
        applied[i], limits[i] = force, limit
        positions.append(q)
        speeds.append(speed)
    motion = plan.samples(positions, speeds, applied, limits, friction)
    return replace(motion, lift=lift, normal=normal) if route == "contact" else motion


SINGLE_PRECISION = "precision: positions, speeds and forces are single, about seven digits"
SINGLE = float(np.finfo(np.float32).eps)
"""Rounding of a number in single precision, relative."""
ROUNDINGS = 8.0
"""Roundings of a speed in a step: two a sub-step, of four sub-steps."""


class Momentum:
    """Friction over a step of n equal sub-steps v+ = (v + (h/n) (u - f - k x+)/m) / (1 + h c/(n m)), x+ = x + (h/n) v+.

    m in kg; c in N s/m and k in N/m are what the engine takes at the end of every sub-step, zero for what is pushed
    with; h in s. The speed after the step is linear, v+ = A x + B v + C u - D f, so that f follows from it. last : the
    impulse of friction comes after the spring and damper of a sub-step have been solved for, so that they do not weigh
    it: v+ = (v + (h/n) (u - k x+)/m) / (1 + h c/(n m)) - (h/n) f/m, x+ on the right that of a step without f. first :
    impulses of the whole step, h u and h f, come in the first sub-step.
    """

    def __init__(
        self, m: float, c: float, k: float, h: float, n: int, *, last: bool = False, first: bool = False
    ) -> None:
        part = h / n
        weight = 1.0 / (1.0 + part * (c + part * k) / m)
        once: FloatArray = np.array([[1.0 - part**2 * k * weight / m, part * weight], [-part * k * weight / m, weight]])
        given: FloatArray = part * weight / m * np.array([part, 1.0])
        rubbed: FloatArray = part / m * np.array([part, 1.0]) if last else given
        powers: list[FloatArray] = [np.eye(2)]
        for _ in range(n):
            powers.append(once @ powers[-1])
        state = powers[n]
        sums: FloatArray = n * powers[n - 1] if first else np.sum(powers[:n], axis=0)
        gained, lost = sums @ given, sums @ rubbed
        self._of_x, self._of_v = float(state[1, 0]), float(state[1, 1])
        self._gain, self._loss = float(gained[1]), float(lost[1])

    def friction(self, x: float, v: float, after: float, push: float, limit: float) -> float:
        """Friction force on the left-hand side, N, held constant over the step.

        x (m) and v (m/s) before the step, ``after`` (m/s) behind it; push in N. A force that is ``limit`` (N) to
        within the rounding of single precision is the limit.
        """
        kept = self._of_x * x + self._of_v * v
        force = (self._gain * push + kept - after) / self._loss
        slack = ROUNDINGS * SINGLE * ((abs(kept) + abs(after)) / self._loss + abs(push))
        return math.copysign(limit, force) if abs(abs(force) - limit) < slack else force


def own_or_pushed(task: Task, settings: dict[str, Any]) -> tuple[Plan, tuple[str, ...]]:
    """The plan of a task whose engine has some of these settings, and what it does not honour.

    own_spring : spring and damper are words of the joint, which the engine takes at the end of every sub-step; a
    pendulum is pushed with all the same. Without it they are a force held over the whole step. own_viscous : the damper
    is the viscous part of the joint's friction. own_break_away : the joint breaks away by itself, on the joint route.
    leapfrog : that step is read as the leapfrog of harness.engines.stepping.Plan; with a spring or damper of its own
    the engine takes none.
    """
    spring = bool(settings.get("own_spring", False))
    damping = spring or bool(settings.get("own_viscous", False))
    ignored = ("leapfrog: the joint's own spring or damper is taken at the end of a step",)
    lines = ignored if damping and settings["leapfrog"] else ()
    away = bool(settings.get("own_break_away", False)) and task.route == "joint"
    native = Native(spring, damping, implicit=damping, break_away=away)
    return Plan(task, settings | {"leapfrog": settings["leapfrog"] and not damping}, native), lines


class SteppedEngine(Engine):
    """An engine that is stepped from outside: an adapter says its words, its slider and what it does not honour.

    shipped_dt : its own step, s. choices : settings that are names, with the names there are.
    """

    shipped_dt: ClassVar[float]
    choices: ClassVar[Mapping[str, tuple[str, ...]]] = {}

    def words(self, route: Route, shipped: bool, dt: float) -> dict[str, Any]:
        """Settings of a preset besides dt (s) and leapfrog, which Plan explains; see Engine.presets."""
        return {}

    @abstractmethod
    def body(self, plan: Plan, settings: dict[str, Any]) -> Stepped:
        """The engine with the slider in it."""

    def ignored(self, task: Task, settings: dict[str, Any]) -> tuple[str, ...]:
        """What the engine does not honour, one sentence each."""
        return ()

    def motion(self, plan: Plan, body: Stepped, settings: dict[str, Any]) -> Motion:
        """Step through a run."""
        return moved(plan, body)

    def planned(self, task: Task, settings: dict[str, Any]) -> tuple[Plan, tuple[str, ...]]:
        """The plan of a task, and what of the settings it does not honour."""
        return own_or_pushed(task, settings)

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        shipped = preset == "as-shipped"
        step = dt or (self.shipped_dt if shipped else TUNED_DT)
        return {"dt": step, "leapfrog": not shipped, **self.words(route, shipped, step)}

    def settled(self, task: Task) -> dict[str, Any]:
        """The settings in force; raises InputError for one that is none, see ``resolve``."""
        settings = resolve(self, task)
        for name in self.choices.keys() & settings.keys():
            choice(f"{self.name} setting {name}", settings[name], self.choices[name])
        return settings

    def simulate(self, task: Task) -> Trajectory:
        settings = self.settled(task)
        plan, ignored = self.planned(task, settings)
        with quiet(logging.getLogger(f"harness.engines.{self.name}")):
            body = self.body(plan, settings)
            try:
                started = time.perf_counter()
                motion = self.motion(plan, body, settings)
                wall = time.perf_counter() - started
            finally:
                body.close()
        return trajectory(self, task, settings, (*ignored, *self.ignored(task, settings)), motion, wall)
