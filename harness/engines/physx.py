"""PhysX (ovphysx, CPU): friction of an articulation's joint. It always runs in a process of its own.

Its licence is NVIDIA's, nothing of it is in this package; its libraries set the whole process to the CPU, bring threads
and exit handlers along, and ask for a packaging that others here are too new for.
"""

from dataclasses import replace
from importlib.util import find_spec
from typing import Any, ClassVar, final

from harness.core.registered import version
from harness.core.trajectory import Trajectory
from harness.engines.base import TUNED_DT, Engine, Preset, Route, Task, choice, resolve
from harness.engines.elsewhere.remote import HERE, worker

SHIPPED_DT = 1.0 / 60.0
"""PhysX's own step, s."""
SOLVERS = ("TGS", "PGS")
"""Solver types; the first ships."""

for _needed in ("ovphysx", "physx_usd_schemas", "newton_usd_schemas"):
    if find_spec(_needed) is None:
        raise ModuleNotFoundError(f"No module named {_needed!r}")


def presets(route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
    """Settings of a preset; see Engine.presets. own_..., leapfrog : see own_or_pushed; the others are PhysX's.

    own_viscous : damping is viscousFrictionCoefficient in place of the drive's. own_break_away : staticFrictionEffort
    is f_s.
    """
    shipped = preset == "as-shipped"
    return {
        "dt": dt or (SHIPPED_DT if shipped else TUNED_DT),
        "own_spring": shipped,
        "own_viscous": False,
        "own_break_away": True,
        "leapfrog": not shipped,
        "solverType": "TGS" if shipped else "PGS",
        "solverPositionIterationCount": 4,
        "solverVelocityIterationCount": 1,
        "enableExternalForcesEveryIteration": True,
    }


def unused(settings: dict[str, Any]) -> tuple[str, ...]:
    """What PhysX does not honour, one sentence each."""
    lines = ["precision: positions, speeds and forces are single, about seven digits"]
    if settings["solverType"] == "PGS" and not settings["enableExternalForcesEveryIteration"]:
        lines.append("enableExternalForcesEveryIteration: PGS takes a force once a step anyway")
    if settings["solverType"] == "TGS" and settings["own_viscous"]:
        lines.append("friction_force: what is told holds a part of the viscous force, which TGS takes by itself")
    return tuple(lines)


@final
class PhysxEngine(Engine):
    """PhysX on one prismatic joint of an articulation (joint and law routes), in a process of its own."""

    name: ClassVar[str] = "physx"
    routes: ClassVar[tuple[Route, ...]] = ("joint", "law")

    def version(self) -> str:
        """Version of the ovphysx package."""
        return version("ovphysx")

    def presets(self, route: Route, preset: Preset, dt: float | None = None) -> dict[str, Any]:
        """See ``presets`` of this file."""
        return presets(route, preset, dt)

    def simulate(self, task: Task) -> Trajectory:
        """Run a task; see Engine.simulate. Raises SimulationError too when the process dies."""
        settings = resolve(self, task)
        choice("physx setting solverType", settings["solverType"], SOLVERS)
        motion: Trajectory = worker(HERE, "harness.engines.physx_world:PhysxHere").ask("simulate", task)
        return replace(motion)  # read-only again
