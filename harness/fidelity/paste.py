"""Settings as the text somebody pastes into their own model or program."""

from collections.abc import Mapping
from typing import Any

from harness.engines.base import Route
from harness.fidelity.paste_stepped import WRITERS

Settings = Mapping[str, Any]

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
_JOINT = {"solreffriction": "solreffriction", "solimpfriction": "solimpfriction"}
_PAIR = {"solref": "solref", "solimp": "solimp", "solreffriction": "solreffriction"}
_LINK = ("linearDamping", "angularDamping", "maxJointVelocity", "frictionAnchor")


def paste(engine: str, route: Route, settings: Settings, changed: Settings) -> str:
    """What to paste for these changes; settings : all that are in force, "dt" among them."""
    if engine == "mujoco":
        return _mujoco(route, settings, changed)
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
