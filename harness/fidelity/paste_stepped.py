"""Settings of the engines that are stepped from outside, as the calls or the stage that make them."""

from collections.abc import Mapping
from typing import Any

Settings = Mapping[str, Any]

PUSHED = "# no spring and damper in the joint: before every step push with -k*x - c*v"
_SCENE = {
    "solverType": 'uniform token physxScene:solverType = "{}"',
    "enableExternalForcesEveryIteration": "bool physxScene:enableExternalForcesEveryIteration = {:d}",
}
_ARTICULATION = {
    name: f"int physxArticulation:{name} = {{}}"
    for name in ("solverPositionIterationCount", "solverVelocityIterationCount")
}


def rapier(dt: float, changed: Settings) -> list[str]:
    """Attributes of the world's integration parameters."""
    lines = [f"world.integration_parameters.dt = {dt:.10g}"]
    for name, value in changed.items():
        if name == "friction_model":
            lines.append(f"world.integration_parameters.{name} = rapier3d.FrictionModel.{value}")
        elif name not in ("own_spring", "leapfrog"):
            lines.append(f"world.integration_parameters.{name} = {value!r}")
    return [*lines, *_pushed(changed)]


def drake(dt: float, changed: Settings) -> list[str]:
    """Calls on the plant, in their order."""
    lines = [f"plant, scene_graph = AddMultibodyPlantSceneGraph(builder, {dt:.10g})"]
    if "contact_approximation" in changed:
        approximation = f"DiscreteContactApproximation.{changed['contact_approximation']}"
        lines.append(f"plant.set_discrete_contact_approximation({approximation})")
    if "stiction_tolerance" in changed:
        lines += ["plant.Finalize()", f"plant.set_stiction_tolerance({changed['stiction_tolerance']:.10g})"]
    return lines


def physx(dt: float, changed: Settings) -> list[str]:
    """Attributes of a stage."""
    lines = [f"# physx.step_sync({dt:.10g})"]
    for where, words in (
        ("the PhysicsScene, with PhysxSceneAPI", _SCENE),
        ("the root of the articulation, with PhysxArticulationAPI", _ARTICULATION),
    ):
        inside = [text.format(changed[name]) for name, text in words.items() if name in changed]
        lines += [f"# in {where}", *inside] if inside else []
    return [*lines, *_pushed(changed)]


def newton(dt: float, changed: Settings) -> list[str]:
    """The solver, and what is given to the joint."""
    lines = [f"# solver.step(state_in, state_out, control, None, {dt:.10g})"]
    if "integrator" in changed:
        lines.append(f"solver = newton.solvers.SolverMuJoCo(model, integrator={changed['integrator']!r})")
    words = {f"mujoco:{name}": [changed[name]] for name in ("solreffriction", "solimpfriction") if name in changed}
    if words:
        lines += [
            "newton.solvers.SolverMuJoCo.register_custom_attributes(builder)  # before the joint",
            f"words = {words!r}",
            "# builder.add_joint_prismatic(..., friction=f_k, custom_attributes=words)",
        ]
    return lines


def _pushed(changed: Settings) -> list[str]:
    return [] if changed.get("own_spring", True) else [PUSHED]


WRITERS = {"rapier": rapier, "drake": drake, "physx": physx, "newton": newton}
