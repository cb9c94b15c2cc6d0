"""PhysX itself, for the process that harness.engines.physx starts."""

import tempfile
import warnings
from importlib.util import find_spec
from pathlib import Path
from typing import Any, final

import numpy as np
import ovphysx
import ovstage
from ovphysx.types import GlobalConfigKey, TensorType

from harness.core.trajectory import Trajectory
from harness.engines.base import Task
from harness.engines.physx import PhysxEngine
from harness.engines.stepping import Momentum, Plan, Stepped, SteppedEngine

# joint friction counts inside an articulation only; a block of this format on one line is read as something else
_STAGE = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    kilogramsPerUnit = 1
    upAxis = "Z"
)
def Xform "World"
{{
    def PhysicsScene "scene" (
        prepend apiSchemas = ["PhysxSceneAPI"]
    )
    {{
        vector3f physics:gravityDirection = (0, 0, -1)
        float physics:gravityMagnitude = 0
        uniform token physxScene:solverType = "{solverType}"
        uniform token physxScene:broadphaseType = "MBP"
        bool physxScene:enableGPUDynamics = 0
        bool physxScene:enableExternalForcesEveryIteration = {enableExternalForcesEveryIteration:d}
    }}
    def Xform "slider" (
        prepend apiSchemas = ["PhysicsArticulationRootAPI", "PhysxArticulationAPI"]
    )
    {{
        int physxArticulation:solverPositionIterationCount = {solverPositionIterationCount}
        int physxArticulation:solverVelocityIterationCount = {solverVelocityIterationCount}
        float physxArticulation:sleepThreshold = 0
        float physxArticulation:stabilizationThreshold = 0
        def Xform "rail" (
            prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]
        )
        {{
            float physics:mass = 1
            float3 physics:diagonalInertia = (1, 1, 1)
        }}
        def Xform "box" (
            prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI", "PhysxRigidBodyAPI"]
        )
        {{
            float physics:mass = {m!r}
            float3 physics:diagonalInertia = (1, 1, 1)
            float physxRigidBody:linearDamping = 0
            float physxRigidBody:angularDamping = 0
        }}
        def PhysicsFixedJoint "root"
        {{
            rel physics:body1 = </World/slider/rail>
        }}
        def PhysicsPrismaticJoint "slide" (
            prepend apiSchemas = ["PhysxJointAxisAPI:linear", "PhysicsDriveAPI:linear"]
        )
        {{
            rel physics:body0 = </World/slider/rail>
            rel physics:body1 = </World/slider/box>
            uniform token physics:axis = "X"
            float drive:linear:physics:stiffness = {k!r}
            float drive:linear:physics:damping = {c!r}
        }}
    }}
}}
"""


def _begin() -> None:
    """What holds for the whole process: no GPU, no threads (a step of one slider waits for them), the schemas."""
    ovphysx.PhysX.set_cpu_mode(True)
    ovphysx.set_global_config(GlobalConfigKey.NUM_THREADS, 0)
    found = find_spec("physx_usd_schemas")
    assert found is not None
    assert found.submodule_search_locations is not None
    package = Path(next(iter(found.submodule_search_locations)))
    roots = [str(file.parent) for file in sorted(package.glob("*/resources/plugInfo.json"))]
    ovstage.population.register_usd_schemas([*roots, str(ovphysx.newton_schema_root())])


@final
class PhysxBody(Stepped):
    """An articulation of one prismatic joint in a stage of its own; close it when done."""

    def __init__(self, plan: Plan, settings: dict[str, Any]) -> None:
        slider, native = plan.task.scenario.slider, plan.native
        k = slider.k if native.spring and plan.task.restoring == "spring" else 0.0
        c = slider.c if native.damping else 0.0
        self._viscous = c if settings["own_viscous"] else 0.0
        slides, away = slider.f_k > 0.0, native.break_away
        self._ratio = slider.break_away / slider.f_k if away and slides else 1.0
        self._excess = plan.scale * slider.break_away if away and not slides else 0.0
        tgs = settings["solverType"] == "TGS"
        parts = max(1, settings["solverPositionIterationCount"]) if tgs else 1
        # then TGS takes forces, and what a joint rubs, once: in the first of its sub-steps
        first = tgs and not settings["enableExternalForcesEveryIteration"]
        self._momentum = Momentum(slider.m, c, k, plan.dt, parts, last=tgs, first=first)
        self._dt, self._limit = plan.dt, 0.0
        self._physics = ovphysx.PhysX()
        self._stage = ovstage.Stage("slider")
        with tempfile.TemporaryDirectory(prefix="friction-harness-") as folder:
            file = Path(folder) / "slider.usda"
            file.write_text(_STAGE.format(m=slider.m, k=k, c=c - self._viscous, **settings), encoding="utf-8")
            ovstage.population.open_usd(self._stage, str(file), ordinal=1, domains=ovstage.PopulationDomain.ALL)
        self._stage.advance_write_floor(ordinal=1).wait()
        self._physics.wait_task(self._physics.attach_ovstage(self._stage, read_ordinal=1))
        self._position, self._speed, self._force, self._friction = (
            self._physics.create_tensor_binding("/World/slider", tensor_type=kind)
            for kind in (
                TensorType.ARTICULATION_DOF_POSITION,
                TensorType.ARTICULATION_DOF_VELOCITY,
                TensorType.ARTICULATION_DOF_ACTUATION_FORCE,
                TensorType.ARTICULATION_DOF_FRICTION_PROPERTIES,
            )
        )
        self._q = np.array([[plan.task.scenario.x0]], dtype=np.float32)
        self._v = np.array([[plan.first_speed]], dtype=np.float32)
        self._f = np.zeros((1, 1), dtype=np.float32)
        self._position.write(self._q)
        self._speed.write(self._v)

    def limit(self, force: float) -> None:
        """See Stepped.limit; static, dynamic and viscous friction of the joint."""
        # refused when it is below the other by a rounding
        static = max(force, force * self._ratio + self._excess)
        self._friction.write(np.array([[[static, force, self._viscous]]], dtype=np.float32))
        self._limit = force

    def step(self, push: float) -> tuple[float, float, float]:
        """See Stepped.step; a force lasts one step."""
        q, v = self._q.item(), self._v.item()
        self._f[0, 0] = push
        self._force.write(self._f)
        self._physics.step_sync(self._dt)
        self._position.read(self._q)
        self._speed.read(self._v)
        after = self._v.item()
        return self._q.item(), after, self._momentum.friction(q, v, after, push, self._limit)

    def close(self) -> None:
        for binding in (self._position, self._speed, self._force, self._friction):
            binding.destroy()
        self._physics.wait_task(self._physics.detach_ovstage())
        self._stage.destroy()
        self._physics.destroy()


@final
class PhysxHere(PhysxEngine):
    """PhysX in this process, which should have nothing else to do."""

    def __init__(self) -> None:
        _begin()

    def body(self, plan: Plan, settings: dict[str, Any]) -> Stepped:
        return PhysxBody(plan, settings)

    def simulate(self, task: Task) -> Trajectory:
        with warnings.catch_warnings():
            # 0.7 calls its tensor bindings deprecated; they are there, and one call each
            warnings.simplefilter("ignore", DeprecationWarning)
            return SteppedEngine.simulate(self, task)
