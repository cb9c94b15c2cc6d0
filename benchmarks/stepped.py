"""Adapters of the engines that are stepped from outside, against the barest loop of the same calls."""

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np

from benchmarks.registry import Pair, benchmark
from harness.core.errors import SimulationError
from harness.core.quiet import quiet
from harness.core.scenario import FREE_DECAY
from harness.engines import registry
from harness.engines.base import Engine, Task, resolve
from harness.engines.pybullet import log
from harness.fidelity.kind import suite


def _whole(engine: Engine, task: Task) -> Callable[[], object]:
    return lambda: engine.simulate(task)


def _bare_rapier(task: Task) -> Callable[[], object]:
    from harness.engines.rapier import RapierEngine, RapierJoint
    from harness.engines.stepping import own_or_pushed

    settings = resolve(RapierEngine(), task)
    plan, _ = own_or_pushed(task, settings)
    slider = task.scenario.slider

    def loop() -> object:
        body = RapierJoint(plan, settings)
        body.limit(slider.f_k)
        box, joint, step = body._body, body._joint, body._world.step
        x, v, a = np.empty((3, plan.steps))
        q, speed = task.scenario.x0, task.scenario.v0
        for i in range(plan.steps):
            before = speed
            x[i], v[i] = q, before
            box.reset_forces(True)
            box.add_force((-slider.k * q - slider.c * before, 0.0, 0.0), True)
            step()
            q, speed = joint.generalized_position()[-1], joint.generalized_velocity()[-1]
            a[i] = (speed - before) / settings["dt"]
        return x, v, a

    return loop


def _bare_drake(task: Task) -> Callable[[], object]:
    from harness.engines.drake import DrakeBody, DrakeEngine
    from harness.engines.stepping import Native, Plan

    settings = resolve(DrakeEngine(), task)
    plan = Plan(task, settings, Native(spring=False, damping=False))
    slider = task.scenario.slider

    def loop() -> object:
        body = DrakeBody(plan, settings)
        body.limit(slider.f_k)
        context, slide, push, dt = body._context, body._slide, body._push, settings["dt"]
        advance, touching, taken = body._simulator.AdvanceTo, body._touching, body._steps
        x, v, a, f = np.empty((4, plan.steps))
        q, speed = task.scenario.x0, task.scenario.v0
        for i in range(plan.steps):
            before = speed
            x[i], v[i] = q, before
            push.GetMutableData().get_mutable_value().SetAtIndex(0, -slider.k * q - slider.c * before)
            advance((taken + i + 1) * dt)
            found = touching.Eval(context)
            f[i] = found.point_pair_contact_info(0).contact_force()[0] if found.num_point_pair_contacts() else 0.0
            q, speed = slide.get_translation(context), slide.get_translation_rate(context)
            a[i] = (speed - before) / dt
        return x, v, a, f

    return loop


def _bare_physx(task: Task) -> Callable[[], object]:
    """Beside the engine in this process: what a process of its own costs is in the row."""
    import warnings

    from harness.engines.physx_world import PhysxBody, PhysxHere
    from harness.engines.stepping import own_or_pushed

    settings = resolve(PhysxHere(), task)
    plan, _ = own_or_pushed(task, settings)
    slider = task.scenario.slider

    def loop() -> object:
        with quiet(log), warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            body = PhysxBody(plan, settings)
            body.limit(slider.f_k)
            x, v, a = np.empty((3, plan.steps))
            q, speed, dt = body._q, body._v, settings["dt"]
            for i in range(plan.steps):
                before = x[i], v[i] = q.item(), speed.item()
                body._f[0, 0] = -slider.k * before[0] - slider.c * before[1]
                body._force.write(body._f)
                body._physics.step_sync(dt)
                body._position.read(q)
                body._speed.read(speed)
                a[i] = (speed.item() - before[1]) / dt
            body.close()
        return x, v, a

    return loop


_MADE = "tuned, {0} over 3 s at 1e-3 s, {1} route, world made inside the clock on both sides"
_LOOP = "a bare loop with the same calls that stores x, v, a"


@benchmark("engines.rapier", peer=_LOOP, timed=_MADE.format("the paper's decay", "joint"), target=1.2)
def rapier_tuned() -> Pair:
    from harness.engines.rapier import RapierEngine

    task = Task(FREE_DECAY, "joint", "tuned", 1e-3)
    return Pair(_whole(RapierEngine(), task), _bare_rapier(task))


@benchmark("engines.drake", peer=f"{_LOOP} and friction", timed=_MADE.format("a tenth of it", "contact"), target=1.2)
def drake_tuned() -> Pair:
    from harness.engines.drake import DrakeEngine

    task = Task(suite("contact")["free-decay"], "contact", "tuned", 1e-3)
    return Pair(_whole(DrakeEngine(), task), _bare_drake(task))


@benchmark("engines.physx", peer=_LOOP, timed=_MADE.format("the paper's decay", "joint"), target=1.2)
def physx_tuned() -> Pair:
    from harness.engines.physx import PhysxEngine

    task = Task(FREE_DECAY, "joint", "tuned", 1e-3)
    return Pair(_whole(PhysxEngine(), task), _bare_physx(task))


def _bare_newton(python: str) -> Callable[[], object]:
    """In a process of its own too, which is told to run by a line."""
    program = Path(__file__).with_name("_newton_loop.py")
    pipe = subprocess.PIPE
    other = subprocess.Popen([python, str(program)], stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, text=True)
    assert other.stdin is not None
    assert other.stdout is not None
    asked, answered = other.stdin, other.stdout

    def loop() -> object:
        asked.write("run\n")
        asked.flush()
        while (line := answered.readline()) != "done\n":
            if not line:
                raise SimulationError(f"{python}: the bare loop ended with code {other.wait()}")
        return line

    return loop


@benchmark(
    "engines.newton",
    peer=f"{_LOOP}, in a process of its own too",
    timed=_MADE.format("the paper's decay", "joint") + ", in the interpreter HARNESS_NEWTON_PYTHON",
    target=1.2,
)
def newton_tuned() -> Pair:
    python = os.environ.get("HARNESS_NEWTON_PYTHON", "")
    if not python:
        raise SimulationError("HARNESS_NEWTON_PYTHON names no interpreter that has newton")
    task = Task(FREE_DECAY, "joint", "tuned", 1e-3)
    return Pair(_whole(registry.load(f"newton@{python}"), task), _bare_newton(python))
