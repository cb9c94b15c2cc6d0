"""MuJoCo: the whole run in compiled code (rollout), acceleration from a sensor, friction from Newton's second law."""

import threading
import time
from typing import Any, ClassVar, final

import mujoco
import numpy as np
from mujoco.rollout import rollout

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.scenario import Body
from harness.core.trajectory import Trajectory
from harness.engines.base import Engine, Preset, Route, Task, resolve
from harness.engines.joint_words import GRAVITY, JOINT, Kinds, coefficient
from harness.engines.mujoco import presets as table
from harness.engines.mujoco.bodies import body_motion
from harness.engines.mujoco.build import Forces, compile_model
from harness.engines.mujoco.presets import warned
from harness.engines.samples import UNSATURATED, Motion, newton_friction, trajectory

_DEEPEST = 0.1
"""m; a floor softer than this is no floor."""


def rest_height(model: Any) -> float:
    """Height (m, below 0) of the joint "lift" at which the contact carries the box at rest without acceleration.

    A run that started at height 0 would begin with a fall, and with friction that falls short and then overshoots.
    Raises SimulationError when the contact carries the box nowhere.
    """
    data = mujoco.MjData(model)
    lift = model.joint("lift").qposadr[0]

    def rising(height: float) -> float:
        mujoco.mj_resetData(model, data)
        data.qpos[lift] = height
        mujoco.mj_forward(model, data)
        return float(data.qacc[model.joint("lift").dofadr[0]])

    shallow, deep = -1e-12, -1e-9
    while rising(deep) < 0.0:
        shallow, deep = deep, 2.0 * deep
        if deep < -_DEEPEST:
            raise SimulationError("mujoco: the contact is too soft to carry the box")
    # imported when it is needed: it brings half of its library along
    from scipy.optimize import brentq

    return float(brentq(rising, shallow, deep, xtol=1e-15, rtol=1e-12)) if rising(shallow) < 0.0 else shallow


_STATE = mujoco.mjtState.mjSTATE_FULLPHYSICS
# callbacks of MuJoCo belong to the process, not to a model
_lock = threading.Lock()


@final
class MujocoEngine(Engine):
    """MuJoCo on one slide joint (joint and law routes) or a box that slides and lifts (contact route)."""

    name: ClassVar[str] = "mujoco"
    package: ClassVar[str] = "mujoco"
    native: ClassVar[Kinds] = JOINT
    bodies: ClassVar[bool] = True

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        return table.presets(route, preset, dt)

    def simulate(self, task: Task) -> Trajectory:
        settings = resolve(self, task)
        table.check(settings)
        ignored = table.unused(settings, self.presets(task.route, "as-shipped", task.dt), task.route)
        if isinstance(task.scenario.action, Body):
            started = time.perf_counter()
            with _lock, warned():
                motion = body_motion(task, settings)
            return trajectory(self, task, settings, ignored, motion, time.perf_counter() - started)
        with _lock:
            forces = Forces(task, settings)
            model = compile_model(task, settings, forces.first_limit)
            data = mujoco.MjData(model)
            data.qpos[0] = task.scenario.x0
            data.qvel[0] = task.scenario.v0 - forces.frame
            if task.route == "contact":
                data.qpos[1] = rest_height(model)
            data.userdata[:] = forces.words
            started = time.perf_counter()
            # one step more than asked for: a step's sensors speak of the state before it
            steps = task.steps(settings["dt"]) + 1
            previous = mujoco.get_mjcb_passive()
            with warned() as warnings:
                try:
                    if forces.needed:
                        install(data)
                    if task.route == "contact" and forces.switches:
                        states, sensors = _switching(model, data, steps, task, forces)
                    else:
                        states, sensors = _rolled_out(model, data, steps)
                finally:
                    mujoco.set_mjcb_passive(previous)
            if any(data.warning[kind].number for kind in _UNSOUND):
                raise SimulationError(f"mujoco: the run diverged ({' '.join(warnings[:1])})")
            motion = _motion(task, settings, forces, states, sensors)
            wall = time.perf_counter() - started
        return trajectory(self, task, settings, ignored, motion, wall)


_UNSOUND = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
"""What MuJoCo warns of where a state is not finite or too large to be true."""


def install(data: Any) -> None:
    """Make MuJoCo call the compiled function at every stage; the caller takes it away again."""
    from harness.engines.mujoco.callback import offsets, passive, verify

    verify(data, offsets())
    mujoco.set_mjcb_passive(passive())


def _start(model: Any, data: Any) -> FloatArray:
    state = np.empty(mujoco.mj_stateSize(model, _STATE))
    mujoco.mj_getState(model, data, state, _STATE)
    return state


def _rolled_out(model: Any, data: Any, steps: int) -> tuple[FloatArray, FloatArray]:
    """States (time, positions, speeds) before each of ``steps`` steps, and sensors of the same moments."""
    start = _start(model, data)
    after, sensors = rollout(model, data, start[np.newaxis], nstep=steps)
    states = np.vstack([start, after[0, :-1]])
    return states, sensors[0]


def _switching(model: Any, data: Any, steps: int, task: Task, forces: Forces) -> tuple[FloatArray, FloatArray]:
    """As _rolled_out, but with the coefficient of friction set step by step: f_s while the contact sticks, else f_k, or
    by the level of a law.

    Sticking is told from the friction force of the step before, which Newton's second law gives, not from a speed.
    """
    slider, law = task.scenario.slider, task.law
    level, (state, params) = (None, ((), ())) if law is None else (law.level, law.own())
    ratio = slider.break_away / slider.f_k if slider.f_k > 0.0 else 1.0
    mu_k, mu_s = coefficient(slider), coefficient(slider, slider.break_away)
    friction = model.pair_friction
    states = np.empty((steps, mujoco.mj_stateSize(model, _STATE)))
    sensors = np.empty((steps, model.nsensordata))
    stuck = forces.first_limit == slider.break_away
    for step in range(steps):
        mujoco.mj_getState(model, data, states[step], _STATE)
        if level is not None:
            mu_k = coefficient(slider, level(states[step, 0], states[step, 1], states[step, 3], state, params))
            mu_s = ratio * mu_k
        mu = mu_s if stuck else mu_k
        friction[0, :2] = mu
        mujoco.mj_step(model, data)
        sensors[step] = data.sensordata
        normal = slider.m * sensors[step, 2]
        q, qd, a = states[step, 1], states[step, 3], sensors[step, 0]
        tangential = forces.applied[step] - slider.m * a - slider.c * qd - slider.k * q
        forces.limits[step] = mu * slider.m * GRAVITY
        stuck = abs(tangential) < UNSATURATED * mu * normal
    return states, sensors


def _motion(task: Task, settings: dict[str, Any], forces: Forces, states: FloatArray, sensors: FloatArray) -> Motion:
    slider, dt = task.scenario.slider, settings["dt"]
    positions = 2 if task.route == "contact" else 1
    t = dt * np.arange(len(states))
    x = states[:, 1] + forces.frame * t
    v = states[:, 1 + positions] + forces.frame
    a = sensors[:, 0].copy()
    if settings["integrator"] == "discrete":
        # qacc is (v+ - v)/dt = (f - c v - k (x + dt v))/(m + dt c + dt^2 k); what acts on the state itself is in f
        k = slider.k if task.restoring == "spring" else 0.0
        relative = v - forces.frame
        a = ((slider.m + dt * slider.c + dt * dt * k) * a + dt * k * relative) / slider.m
    friction = newton_friction(task, x, v, a, forces.applied)
    if task.route != "contact":
        return Motion(x, v, a, forces.applied, friction, forces.limits)
    normal = slider.m * sensors[:, 2]
    limit = forces.limits / (slider.m * GRAVITY) * normal
    return Motion(x, v, a, forces.applied, friction, limit, states[:, 2].copy(), normal)
