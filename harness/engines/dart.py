"""DART (dartpy): one prismatic joint with its native Coulomb friction, and native or pushed spring and damper."""

from typing import Any, ClassVar, final

import dartpy

from harness.engines.base import Route, Task
from harness.engines.stepping import Native, Plan, Stepped, SteppedEngine


@final
class DartBody(Stepped):
    """A world with one skeleton of one joint and no gravity."""

    def __init__(self, plan: Plan) -> None:
        slider, native = plan.task.scenario.slider, plan.native
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
        self._joint.setCoulombFriction(0, force)

    def step(self, push: float) -> tuple[float, float, float]:
        """See Stepped.step; a force lasts one step."""
        self._joint.setForce(0, push)
        self._world.step()
        return self._joint.getPosition(0), self._joint.getVelocity(0), -float(self._skeleton.getConstraintForces()[0])


@final
class DartEngine(SteppedEngine):
    """DART on one prismatic joint (joint and law routes).

    leapfrog : spring and damper are pushed with from outside, which makes the step the leapfrog of Plan; without it
    they are the joint's own, which DART takes at the end of the step.
    """

    name: ClassVar[str] = "dart"
    package: ClassVar[str] = "dartpy"
    routes: ClassVar[tuple[Route, ...]] = ("joint", "law")
    shipped_dt: ClassVar[float] = 1e-3

    def planned(self, task: Task, settings: dict[str, Any]) -> tuple[Plan, tuple[str, ...]]:
        own = not settings["leapfrog"]
        return Plan(task, settings, Native(spring=own, damping=own, implicit=own)), ()

    def body(self, plan: Plan, settings: dict[str, Any]) -> Stepped:
        return DartBody(plan)
