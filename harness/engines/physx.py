"""PhysX (ovphysx, CPU): friction of an articulation's joint. It always runs in a process of its own.

Its licence is NVIDIA's, nothing of it is in this package; its libraries set the whole process to the CPU, bring threads
and exit handlers along, and ask for a packaging that others here are too new for.
"""

from collections.abc import Mapping
from dataclasses import replace
from importlib.util import find_spec
from typing import Any, ClassVar

from harness.core.trajectory import Trajectory
from harness.engines.base import Route, Task
from harness.engines.elsewhere.remote import HERE, worker
from harness.engines.stepping import SINGLE_PRECISION, Plan, Stepped, SteppedEngine

for _needed in ("ovphysx", "physx_usd_schemas", "newton_usd_schemas"):
    if find_spec(_needed) is None:
        raise ModuleNotFoundError(f"No module named {_needed!r}")


class PhysxEngine(SteppedEngine):
    """PhysX on one prismatic joint of an articulation (joint and law routes), in a process of its own."""

    name: ClassVar[str] = "physx"
    package: ClassVar[str] = "ovphysx"
    routes: ClassVar[tuple[Route, ...]] = ("joint", "law")
    shipped_dt: ClassVar[float] = 1.0 / 60.0
    choices: ClassVar[Mapping[str, tuple[str, ...]]] = {"solverType": ("TGS", "PGS")}

    def words(self, route: Route, shipped: bool, dt: float) -> dict[str, Any]:
        """See SteppedEngine.words. own_... : see own_or_pushed; the others are PhysX's.

        own_viscous : damping is viscousFrictionCoefficient in place of the drive's. own_break_away :
        staticFrictionEffort is f_s.
        """
        return {
            "own_spring": shipped,
            "own_viscous": False,
            "own_break_away": True,
            "solverType": "TGS" if shipped else "PGS",
            "solverPositionIterationCount": 4,
            "solverVelocityIterationCount": 1,
            "enableExternalForcesEveryIteration": True,
        }

    def body(self, plan: Plan, settings: dict[str, Any]) -> Stepped:
        """In the process of harness.engines.physx_world alone."""
        raise NotImplementedError

    def ignored(self, task: Task, settings: dict[str, Any]) -> tuple[str, ...]:
        lines = [SINGLE_PRECISION]
        if settings["solverType"] == "PGS" and not settings["enableExternalForcesEveryIteration"]:
            lines.append("enableExternalForcesEveryIteration: PGS takes a force once a step anyway")
        if settings["solverType"] == "TGS" and settings["own_viscous"]:
            lines.append("friction_force: what it reports holds a part of the viscous force, which TGS takes by itself")
        return tuple(lines)

    def simulate(self, task: Task) -> Trajectory:
        """See Engine.simulate. Raises SimulationError too when the process dies."""
        self.settled(task)
        motion: Trajectory = worker(HERE, "harness.engines.physx_world:PhysxHere").ask("simulate", task)
        return replace(motion)  # read-only again
