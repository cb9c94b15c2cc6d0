"""Settings as the text somebody pastes into their own model or program."""

from collections.abc import Mapping
from typing import Any

from harness.engines.base import Route

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


_OPTION = (
    "integrator",
    "solver",
    "iterations",
    "tolerance",
    "ls_iterations",
    "noslip_iterations",
    "noslip_tolerance",
    "cone",
    "impratio",
)
_PRECISION = {64: ('jax.config.update("jax_enable_x64", True)  # before the model is put on the device',)}
_JOINT = {"solreffriction": "solreffriction", "solimpfriction": "solimpfriction"}
_PAIR = {"solref": "solref", "solimp": "solimp", "solreffriction": "solreffriction"}
_LINK = ("linearDamping", "angularDamping", "maxJointVelocity", "frictionAnchor")


def paste(engine: str, route: Route, settings: Settings, changed: Settings) -> str:
    """What to paste for these changes; settings : all that are in force, "dt" among them."""
    if engine in ("mujoco", "mjx", "warp"):
        return "\n".join([*_PRECISION.get(changed.get("precision", 0), ()), _mujoco(route, settings, changed)])
    if engine == "pybullet":
        return _pybullet(settings, changed)
    if engine in WRITERS:
        return "\n".join([*WRITERS[engine](settings["dt"], changed), *_leapfrog(changed)])
    lines = [f"{name} = {value!r}" for name, value in changed.items() if name != "leapfrog"]
    return "\n".join([f"# time step {settings['dt']:.10g} s", *lines, *_leapfrog(changed)])


def _mujoco(route: Route, settings: Settings, changed: Settings) -> str:
    option = " ".join(f'{name}="{_text(changed[name])}"' for name in _OPTION if name in changed)
    lines = [f'<option timestep="{settings["dt"]:.10g}"{" " + option if option else ""}/>']
    names = _PAIR if route == "contact" else _JOINT
    inside = " ".join(f'{xml}="{_text(changed[name])}"' for name, xml in names.items() if name in changed)
    if inside and route == "contact":
        lines += ["<!-- in contact: a pair takes the place of what the two geoms say -->", f"<pair {inside}/>"]
    elif inside:
        lines += ["<!-- on the joint that has frictionloss -->", f"<joint {inside}/>"]
    return "\n".join(lines)


def _pybullet(settings: Settings, changed: Settings) -> str:
    world = {"fixedTimeStep": settings["dt"]} | {
        name: value for name, value in changed.items() if name not in (*_LINK, "leapfrog")
    }
    lines = [f"p.setPhysicsEngineParameter({_arguments(world)})"]
    link = {name: value for name, value in changed.items() if name in _LINK}
    if link:
        lines += [
            "for link in range(-1, p.getNumJoints(body)):",
            f"    p.changeDynamics(body, link, {_arguments(link)})",
        ]
    return "\n".join([*lines, *_leapfrog(changed)])


def _leapfrog(changed: Settings) -> list[str]:
    if not changed.get("leapfrog"):
        return []
    return [
        "# read the step as the leapfrog it is, with a0 the acceleration at the start:",
        "#   start with v0 - a0*dt/2; scale every force, friction limit and damping by m/(m + c*dt/2);",
        "#   the speed of a sample is the mean of the speeds before and after the step",
    ]


def _arguments(values: Settings) -> str:
    return ", ".join(f"{name}={_python(value)}" for name, value in values.items())


def _python(value: Any) -> str:
    return f"{value:.10g}" if isinstance(value, float) else repr(int(value))


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return " ".join(_text(number) for number in value)
    return f"{value:.10g}" if isinstance(value, float) else str(value)
