"""Engine adapters against the barest loop that steps the same model and keeps x, v, a."""

from collections.abc import Callable
from contextlib import closing
from typing import Any

import mujoco
import numpy as np

from benchmarks.registry import Pair, benchmark
from harness.core.quiet import quiet
from harness.core.scenario import FREE_DECAY
from harness.engines.base import Engine, Preset, Task, resolve
from harness.engines.mujoco import MujocoEngine
from harness.engines.mujoco.build import compile_model
from harness.engines.pybullet import SLIDE, PybulletBody, PybulletEngine, log


def _whole(engine: Engine, task: Task) -> Callable[[], object]:
    return lambda: engine.simulate(task)


def _bare_mujoco(task: Task) -> Callable[[], object]:
    engine = MujocoEngine()
    settings = resolve(engine, task)
    steps = task.steps(settings["dt"])

    def loop() -> object:
        model = compile_model(task, settings, task.scenario.slider.f_k)
        data = mujoco.MjData(model)
        data.qpos[0] = task.scenario.x0
        x, v, a = np.empty((3, steps))
        step, q, qd, qdd = mujoco.mj_step, data.qpos, data.qvel, data.qacc
        for i in range(steps):
            step(model, data)
            x[i], v[i], a[i] = q[0], qd[0], qdd[0]
        return x, v, a

    return loop


def _mujoco(preset: Preset, dt: float) -> Pair:
    task = Task(FREE_DECAY, "joint", preset, dt)
    return Pair(_whole(MujocoEngine(), task), _bare_mujoco(task))


_MUJOCO = "the paper's decay over 3 s at 1e-4 s, joint route, model built inside the clock on both sides"


@benchmark(
    "engines.mujoco", peer="a bare mj_step loop that stores x, v, a", timed=f"as shipped (Euler), {_MUJOCO}", target=1.3
)
def mujoco_shipped() -> Pair:
    return _mujoco("as-shipped", 1e-4)


@benchmark(
    "engines.mujoco-tuned", peer="a bare mj_step loop that stores x, v, a", timed=f"tuned (RK4), {_MUJOCO}", target=1.3
)
def mujoco_tuned() -> Pair:
    return _mujoco("tuned", 1e-4)


def _bare_pybullet(task: Task) -> Callable[[], object]:
    import pybullet

    engine = PybulletEngine()
    settings = resolve(engine, task)
    plan, _ = engine.planned(task, settings)
    slider = task.scenario.slider

    def loop() -> object:
        with quiet(log), closing(PybulletBody(plan, settings)) as opened:
            opened.limit(slider.f_k)
            body, client = opened.body, opened.client
            push, step, read = pybullet.setJointMotorControl2, pybullet.stepSimulation, pybullet.getJointState
            torque, stiffness, dt = pybullet.TORQUE_CONTROL, slider.k, settings["dt"]
            x, v, a = np.empty((3, plan.steps))
            state: Any = (task.scenario.x0, task.scenario.v0)
            for i in range(plan.steps):
                before = state[1]
                x[i], v[i] = state[0], before
                push(body, SLIDE, torque, force=-stiffness * state[0], physicsClientId=client)
                step(physicsClientId=client)
                state = read(body, SLIDE, physicsClientId=client)
                a[i] = (state[1] - before) / dt
        return x, v, a

    return loop


def _pybullet(preset: Preset, dt: float) -> Pair:
    task = Task(FREE_DECAY, "joint", preset, dt)
    return Pair(_whole(PybulletEngine(), task), _bare_pybullet(task))


_PYBULLET = "the paper's decay over 3 s at 1e-4 s, joint route, world opened inside the clock on both sides"


@benchmark(
    "engines.pybullet",
    peer="a bare loop with the same calls that stores x, v, a",
    timed=f"tuned, {_PYBULLET}",
    target=1.2,
)
def pybullet_tuned() -> Pair:
    return _pybullet("tuned", 1e-4)
