"""Engines that run MuJoCo's models, alone or many at once: what an adapter of one says, and what it is handed.

Nothing can be called within a step of such a program, so that forces are held over it.
"""

import time
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol, TypeAlias

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import HarnessError
from harness.core.scenario import CurveBelt
from harness.core.trajectory import Trajectory
from harness.engines.base import Engine, Task, resolve
from harness.engines.joint_words import GRAVITY
from harness.engines.mujoco.build import spec_of
from harness.engines.mujoco.engine import rest_height
from harness.engines.mujoco.presets import warned
from harness.engines.samples import UNSATURATED, Motion, belt_speed, driving_force, held_at_start, trajectory
from harness.engines.stepping import SINGLE_PRECISION

OF_MODEL = (
    "body_mass",
    "body_subtreemass",
    "body_inertia",
    "body_invweight0",
    "jnt_stiffness",
    "dof_damping",
    "dof_frictionloss",
    "dof_invweight0",
    "dof_solref",
    "dof_solimp",
    "pair_friction",
    "pair_solref",
    "pair_solimp",
    "pair_solreffriction",
)
"""Arrays in which the models of two sliders, or of two settings, differ."""
NEARLY_NONE = 1e-9
"""Friction of a joint that slides without, over that at which it breaks away: none at all would lock it in MJX."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """What a program tells of the moments before each step, shape (n,): position and speed of the joint, its
    acceleration, friction on the left-hand side and its limit; on a floor height and normal force.
    """

    q: FloatArray
    speed: FloatArray
    a: FloatArray
    friction: FloatArray
    limit: FloatArray
    height: FloatArray
    normal: FloatArray


@dataclass(frozen=True, slots=True)
class Held:
    """One task in the numbers that such a program is given.

    model : MjModel without what is only looked at. q, speed : of its joints at the start. push : force of each step, N,
    that of its middle where the integrator has stages. early : what the force of the step's start is above that.
    stuck : whether it starts on break-away friction. frame : speed of the frame that the joint, or the box, lives in,
    m/s: that of the belt, so that its floor rests.
    """

    task: Task
    model: Any
    q: FloatArray
    speed: FloatArray
    push: FloatArray
    early: FloatArray
    stuck: bool
    frame: float

    @property
    def rubs(self) -> bool:
        """Whether the joint has dry friction of its own."""
        return self.task.route == "joint" and self.task.scenario.slider.break_away > 0.0

    def numbers(self, settings: dict[str, Any]) -> dict[str, float]:
        """What a program needs besides the model: levels of friction and weight, N; spring, damper; on the law route
        the inertia over the step that stops the joint within it, kg/s; of a belt's curve 1/v_s, 0 for none, c_2, c_3.
        """
        slider, belt = self.task.scenario.slider, self.task.scenario.action
        curve = (1.0 / belt.v_s, belt.c_2, belt.c_3) if isinstance(belt, CurveBelt) else (0.0, 0.0, 0.0)
        return {
            "f_k": max(slider.f_k, NEARLY_NONE * slider.break_away),
            "f_s": slider.break_away,
            "weight": slider.m * GRAVITY,
            "spring": slider.k if self.task.restoring == "spring" else 0.0,
            "damper": slider.c,
            "metric": slider.m / settings["dt"] + (0.0 if settings["integrator"] == "RK4" else slider.c),
            **dict(zip(("falling", "c_2", "c_3"), curve, strict=True)),
        }

    def motion(self, found: Recorded, dt: float, sticks_below: float = UNSATURATED) -> Motion:
        """In the frame of the laboratory. sticks_below : see harness.engines.stepping.Stepped."""
        task, slider = self.task, self.task.scenario.slider
        t: FloatArray = np.arange(found.q.size, dtype=np.float64) * dt
        x, v = found.q + self.frame * t, found.speed + self.frame
        x[0], v[0] = task.scenario.x0, task.scenario.v0
        floor = task.route == "contact"
        limit = found.limit * (found.normal / (slider.m * GRAVITY) if floor else 1.0)
        slides = np.abs(found.friction) >= sticks_below * limit
        a = found.a + np.where(slides, self.early / slider.m, 0.0)
        friction = found.friction + np.where(slides, 0.0, self.early)
        limit = limit * sticks_below / UNSATURATED
        lifted = (found.height, found.normal) if floor else (None, None)
        return Motion(x, v, a, driving_force(task, t), friction, limit, *lifted)


def held(task: Task, settings: dict[str, Any]) -> Held:
    """The task for such a program; settings : all that MuJoCo has."""
    slider, scenario, dt = task.scenario.slider, task.scenario, float(settings["dt"])
    stuck = held_at_start(task, dt)
    frame = belt_speed(task)
    # the floor of the frame that the box lives in rests
    spec = spec_of(replace(task, scenario=replace(scenario, action=None)), settings, slider.break_away)
    for seen in (*spec.tendons, *spec.sensors, *(one for one in spec.geoms if one.name not in ("box", "floor"))):
        spec.delete(seen)
    spec.nuserdata = 0
    model = spec.compile()
    q, speed = np.zeros(model.nq), np.zeros(model.nv)
    q[0], speed[0] = scenario.x0, scenario.v0 - frame
    if task.route == "contact":
        with warned():
            q[1] = rest_height(model)
    # a word of MuJoCo's own about runs that diverge
    model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    t: FloatArray = np.arange(task.steps(dt) + 1, dtype=np.float64) * dt
    start = _push(task, t, frame)
    middle = _push(task, t + 0.5 * dt, frame) if settings["integrator"] == "RK4" else start
    return Held(task, model, q, speed, middle, start - middle, stuck, frame)


def _push(task: Task, t: FloatArray, frame: float) -> FloatArray:
    """Force of times t; in the moving frame the spring's end moves backwards."""
    slider = task.scenario.slider
    k = slider.k if task.restoring == "spring" else 0.0
    force: FloatArray = driving_force(task, t) - frame * (k * t + slider.c)
    return force


Ready: TypeAlias = tuple[Held, dict[str, Any]]
"""A task and its settings."""
SINGLE_STICKS = 1.0 - 1e-5
"""UNSATURATED in single precision."""


class Runs(Protocol):
    """Tasks that are compiled and ready to run."""

    def run(self) -> list[Recorded]:
        """What each recorded."""


class AtOnce(Engine):
    """An engine within whose steps nothing can be called, and that takes as many sliders as there are."""

    calls: ClassVar[bool] = False
    curves: ClassVar[bool] = True
    batches: ClassVar[bool] = True

    @abstractmethod
    def check(self, settings: dict[str, Any]) -> None:
        """Raise InputError for a value that does not exist."""

    @abstractmethod
    def of_mujoco(self, settings: dict[str, Any]) -> dict[str, Any]:
        """All settings that MuJoCo has."""

    @abstractmethod
    def single(self, settings: dict[str, Any]) -> bool:
        """Whether numbers are in single precision."""

    @abstractmethod
    def unused(self, task: Task, settings: dict[str, Any]) -> tuple[str, ...]:
        """Settings without effect, one sentence each."""

    @abstractmethod
    def alike(self, ready: Ready) -> tuple[Any, ...]:
        """What must be the same for tasks that run at once."""

    @abstractmethod
    def ready(self, group: Sequence[Ready]) -> Runs:
        """Tasks that are alike, compiled. Raises NoDeviceError for a device that is not here."""

    def sticks_below(self, settings: dict[str, Any]) -> float:
        """See harness.engines.stepping.Stepped."""
        return SINGLE_STICKS if self.single(settings) else UNSATURATED

    def simulate(self, task: Task) -> Trajectory:
        (found,) = self.simulate_all([task])
        if isinstance(found, HarnessError):
            raise found
        return found

    def simulate_all(self, tasks: Sequence[Task]) -> list[Trajectory | HarnessError]:
        found: dict[int, Trajectory | HarnessError] = {}
        groups: dict[tuple[Any, ...], dict[int, Ready]] = {}
        for i, task in enumerate(tasks):
            try:
                settings = resolve(self, task)
                self.check(settings)
                ready = held(task, self.of_mujoco(settings)), settings
                groups.setdefault(self.alike(ready), {})[i] = ready
            except HarnessError as error:
                found[i] = error
        for group in groups.values():
            found |= dict(zip(group, self._together(list(group.values())), strict=True))
        return [found[i] for i in range(len(tasks))]

    def _together(self, group: Sequence[Ready]) -> list[Trajectory | HarnessError]:
        try:
            runs = self.ready(group)
        except HarnessError as error:
            return [error] * len(group)
        started = time.perf_counter()
        recorded = runs.run()
        wall = (time.perf_counter() - started) / len(group)
        return [self._told(*ready, one, wall) for ready, one in zip(group, recorded, strict=True)]

    def _told(
        self, ready: Held, settings: dict[str, Any], recorded: Recorded, wall: float
    ) -> Trajectory | HarnessError:
        ignored = self.unused(ready.task, settings)
        if self.single(settings):
            ignored = (*ignored, SINGLE_PRECISION)
        try:
            motion = ready.motion(recorded, float(settings["dt"]), self.sticks_below(settings))
            return trajectory(self, ready.task, settings, ignored, motion, wall)
        except HarnessError as error:
            return error
