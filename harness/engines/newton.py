"""Newton (its MuJoCo solver, on the CPU) on one prismatic joint.

Its packages ask for another MuJoCo than this program's: it runs as newton@PYTHON, in an environment of its own.
"""

import logging
import time
from typing import Any, ClassVar, final

import newton
import numpy as np
import warp

from harness.core.quiet import quiet
from harness.core.registered import version
from harness.core.trajectory import Trajectory
from harness.engines.base import TUNED_DT, Engine, Preset, Route, Task, choice, resolve
from harness.engines.samples import trajectory
from harness.engines.stepping import Momentum, Native, Plan, Stepped, moved

SHIPPED_DT = 1.0 / 60.0
"""Step of Newton's examples, s."""
SOLVERS = ("SolverMuJoCo", "SolverFeatherstone", "SolverSemiImplicit", "SolverXPBD", "SolverVBD")
"""Solvers; the first is the one whose joints have dry friction."""

_log = logging.getLogger("harness.engines.newton")


@final
class NewtonBody(Stepped):
    """A model of one link and one solver of it; states are in single precision."""

    def __init__(self, plan: Plan, settings: dict[str, Any]) -> None:
        slider = plan.task.scenario.slider
        self._momentum = Momentum(slider.m, 0.0, 0.0, plan.dt, 1)
        self._dt, self._limit = plan.dt, 0.0
        self._q, self._speed = plan.task.scenario.x0, plan.first_speed
        kind = getattr(newton.solvers, settings["solver"])
        of_mujoco = settings["solver"] == SOLVERS[0]
        self._by_bodies = settings["solver"] not in SOLVERS[:2]  # they move bodies, not joints
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
        words: dict[str, Any] = {}
        if of_mujoco:
            kind.register_custom_attributes(builder)
            words["custom_attributes"] = {
                # one entry a degree of freedom
                "mujoco:solreffriction": [settings["solreffriction"]],
                "mujoco:solimpfriction": [settings["solimpfriction"]],
            }
        link = builder.add_link(mass=slider.m, inertia=warp.mat33(np.eye(3)))
        rubs = slider.f_k if plan.task.route == "joint" else 0.0
        joint = builder.add_joint_prismatic(-1, link, axis=(1.0, 0.0, 0.0), friction=rubs, **words)
        builder.add_articulation([joint])
        if settings["solver"] == "SolverVBD":
            builder.color()
        builder.joint_q[-1], builder.joint_qd[-1] = self._q, self._speed
        self._model = model = builder.finalize(device="cpu")
        own = {"use_mujoco_cpu": settings["use_mujoco_cpu"], "integrator": settings["integrator"]} if of_mujoco else {}
        self._solver = kind(model, **own)
        self._now, self._next, self._control = model.state(), model.state(), model.control()
        newton.eval_fk(model, model.joint_q, model.joint_qd, self._now)
        self._force = np.zeros(1, dtype=np.float32)

    def limit(self, force: float) -> None:
        """See Stepped.limit."""
        self._model.joint_friction.assign(np.array([force], dtype=np.float32))
        self._solver.notify_model_changed(newton.ModelFlags.JOINT_DOF_PROPERTIES)
        self._limit = force

    def step(self, push: float) -> tuple[float, float, float]:
        """See Stepped.step."""
        q, speed = self._q, self._speed
        self._force[0] = push
        self._control.joint_f.assign(self._force)
        self._now.clear_forces()
        self._solver.step(self._now, self._next, self._control, None, self._dt)
        self._now, self._next = self._next, self._now
        if self._by_bodies:
            newton.eval_ik(self._model, self._now, self._now.joint_q, self._now.joint_qd)
        self._q, self._speed = self._now.joint_q.numpy().item(), self._now.joint_qd.numpy().item()
        return self._q, self._speed, self._momentum.friction(q, speed, self._speed, push, self._limit)

    def floor(self) -> tuple[float, float]:
        """See Stepped.floor."""
        return 0.0, 0.0


@final
class NewtonEngine(Engine):
    """Newton on one prismatic joint (joint and law routes); spring and damper are pushed with."""

    name: ClassVar[str] = "newton"
    routes: ClassVar[tuple[Route, ...]] = ("joint", "law")

    def version(self) -> str:
        """Version of the newton package."""
        return version("newton")

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        """Settings of a preset; see Engine.presets. The words but for dt and leapfrog are Newton's and MuJoCo's own.

        use_mujoco_cpu : Newton ships with MuJoCo-Warp instead, which gives the same motion to six digits and takes ten
        times as long without a GPU.
        """
        shipped = preset == "as-shipped"
        step = dt or (SHIPPED_DT if shipped else TUNED_DT)
        d = 0.9999
        return {
            "dt": step,
            "leapfrog": not shipped,
            "solver": SOLVERS[0],
            "use_mujoco_cpu": True,
            "integrator": "euler",
            "solreffriction": (0.02, 1.0) if shipped else (-1.0, -1.9 * d / step),
            "solimpfriction": (0.9, 0.95, 0.001, 0.5, 2.0) if shipped else (d, d, 0.001, 0.5, 2.0),
        }

    def simulate(self, task: Task) -> Trajectory:
        """Run a task; see Engine.simulate."""
        settings = resolve(self, task)
        choice("newton setting solver", settings["solver"], SOLVERS)
        plan = Plan(task, settings, Native(spring=False, damping=False))
        ignored = ["precision: positions, speeds and forces are single, about seven digits"]
        if settings["solver"] != SOLVERS[0]:
            ignored.append(f"friction: {settings['solver']} has none in a joint and does not say so")
        with quiet(_log):
            body = NewtonBody(plan, settings)
            started = time.perf_counter()
            motion = moved(plan, body)
            wall = time.perf_counter() - started
        return trajectory(self, task, settings, tuple(ignored), motion, wall)
