"""DART (dartpy): one prismatic joint with its native Coulomb friction, and native or pushed spring and damper."""

import logging
import time
from typing import Any, ClassVar, final

import dartpy

from harness.core.quiet import quiet
from harness.core.registered import version
from harness.core.trajectory import Trajectory
from harness.engines.base import TUNED_DT, Engine, Preset, Route, Task, resolve
from harness.engines.samples import trajectory
from harness.engines.stepping import Native, Plan, Stepped, stepped_through

SHIPPED_DT = 1e-3
"""DART's own step, s."""

_log = logging.getLogger("harness.engines.dart")


@final
class DartBody(Stepped):
    """A world with one skeleton of one joint and no gravity."""

    def __init__(self, plan: Plan) -> None:
        slider, native = plan.task.scenario.slider, plan.native
        self._dt = plan.dt
        self._world = dartpy.simulation.World()
        self._world.setTimeStep(plan.dt)
        self._world.setGravity([0.0, 0.0, 0.0])
        self._skeleton = dartpy.dynamics.Skeleton("slider")
        self._joint, body = self._skeleton.createPrismaticJointAndBodyNodePair()
        self._joint.setAxis([1.0, 0.0, 0.0])
        body.setMass(slider.m)
        spring = native.spring and plan.task.restoring == "spring"
        self._joint.setSpringStiffness(0, slider.k if spring else 0.0)
        self._joint.setDampingCoefficient(0, slider.c if native.damping else 0.0)
        self._joint.setCoulombFriction(0, 0.0)
        self._joint.setPosition(0, plan.task.scenario.x0)
        self._joint.setVelocity(0, plan.first_speed)
        self._world.addSkeleton(self._skeleton)

    def limit(self, force: float) -> None:
        """See Stepped.limit."""
        self._joint.setCoulombFriction(0, force)

    def step(self, push: float) -> tuple[float, float, float]:
        """See Stepped.step; a force lasts one step."""
        self._joint.setForce(0, push)
        self._world.step()
        return self._joint.getPosition(0), self._joint.getVelocity(0), -float(self._skeleton.getConstraintForces()[0])

    def floor(self) -> tuple[float, float]:
        """See Stepped.floor."""
        return 0.0, 0.0


@final
class DartEngine(Engine):
    """DART on one prismatic joint (joint and law routes)."""

    name: ClassVar[str] = "dart"
    routes: ClassVar[tuple[Route, ...]] = ("joint", "law")

    def version(self) -> str:
        """Version of the dartpy package."""
        return version("dartpy")

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        """Settings of a preset; see Engine.presets.

        leapfrog : spring and damper are pushed with from outside, which makes the step the leapfrog of
        harness.engines.stepping.Plan; without it they are the joint's own, which DART takes at the end of the step.
        """
        shipped = preset == "as-shipped"
        return {"dt": dt or (SHIPPED_DT if shipped else TUNED_DT), "leapfrog": not shipped}

    def simulate(self, task: Task) -> Trajectory:
        """Run a task; see Engine.simulate."""
        settings = resolve(self, task)
        own = not settings["leapfrog"]
        plan = Plan(task, settings, Native(spring=own, damping=own, implicit=own))
        with quiet(_log):
            body = DartBody(plan)
            started = time.perf_counter()
            motion = stepped_through(plan, body)
            wall = time.perf_counter() - started
        return trajectory(self, task, settings, (), motion, wall)
