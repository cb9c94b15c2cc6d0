"""Newton (its MuJoCo solver, on the CPU) on one prismatic joint.

Its packages ask for another MuJoCo than this program's: it runs as newton@PYTHON, in an environment of its own.
"""

from collections.abc import Mapping
from typing import Any, ClassVar, final

import newton
import numpy as np
import warp

from harness.engines.base import Route, Task
from harness.engines.stepping import SINGLE_PRECISION, Momentum, Plan, Stepped, SteppedEngine

SOLVERS = ("SolverMuJoCo", "SolverFeatherstone", "SolverSemiImplicit", "SolverXPBD", "SolverVBD")
"""Solvers; the first is the one whose joints have dry friction."""


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
        self._model.joint_friction.assign(np.array([force], dtype=np.float32))
        self._solver.notify_model_changed(newton.ModelFlags.JOINT_DOF_PROPERTIES)
        self._limit = force

    def step(self, push: float) -> tuple[float, float, float]:
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


@final
class NewtonEngine(SteppedEngine):
    """Newton on one prismatic joint (joint and law routes); spring and damper are pushed with."""

    name: ClassVar[str] = "newton"
    package: ClassVar[str] = "newton"
    routes: ClassVar[tuple[Route, ...]] = ("joint", "law")
    shipped_dt: ClassVar[float] = 1.0 / 60.0
    choices: ClassVar[Mapping[str, tuple[str, ...]]] = {"solver": SOLVERS}

    def words(self, route: Route, shipped: bool, dt: float) -> dict[str, Any]:
        """See SteppedEngine.words; these are Newton's and MuJoCo's own.

        use_mujoco_cpu : Newton ships with MuJoCo-Warp instead, which gives the same motion to six digits and takes ten
        times as long without a GPU.
        """
        d = 0.9999
        return {
            "solver": SOLVERS[0],
            "use_mujoco_cpu": True,
            "integrator": "euler",
            "solreffriction": (0.02, 1.0) if shipped else (-1.0, -1.9 * d / dt),
            "solimpfriction": (0.9, 0.95, 0.001, 0.5, 2.0) if shipped else (d, d, 0.001, 0.5, 2.0),
        }

    def body(self, plan: Plan, settings: dict[str, Any]) -> Stepped:
        return NewtonBody(plan, settings)

    def ignored(self, task: Task, settings: dict[str, Any]) -> tuple[str, ...]:
        silent = f"friction: {settings['solver']} has none in a joint and does not say so"
        return (SINGLE_PRECISION,) if settings["solver"] == SOLVERS[0] else (SINGLE_PRECISION, silent)
