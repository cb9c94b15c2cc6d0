"""A body with six freedoms in MuJoCo: on a slope, between two fingers, rolling or spinning on a floor."""

import math
from typing import Any

import mujoco
import numpy as np

from harness.core.errors import SimulationError
from harness.core.scenario import Body
from harness.engines.base import Task
from harness.engines.joint_words import GRAVITY
from harness.engines.mujoco.watched import Watch, watched
from harness.engines.samples import Motion

_FINGER = 0.5
"""Half thickness of a finger over the body's size."""
_FINGER_DAMPING = 5.0
"""N s/m."""
_SPINS, _ROLLS = 5, 4


def text_of(task: Task, settings: dict[str, Any]) -> str:
    """The scene as MJCF; the contact's softness and the options are the settings'."""
    body, slider = _body(task), task.scenario.slider
    size, mass = body.size, slider.m
    friction = f"{body.mu!r} {body.mu_t!r} {body.mu_r!r}"
    sides = {"box": f"{size} {size} {size}", "cylinder": f"{size} {size}", "sphere": f"{size}"}[body.shape]
    names = ("iterations", "ls_iterations", "tolerance", "noslip_iterations", "noslip_tolerance", "impratio")
    options = " ".join(f'{name}="{settings[name]!r}"' for name in names)
    options += f' integrator="{settings["integrator"]}" solver="{settings["solver"]}" cone="{settings["cone"]}"'
    soft = " ".join(
        f'{name}="{" ".join(map(repr, settings[name]))}"' for name in ("solref", "solimp")
    )  # fmt: skip
    said = f'condim="{body.condim}" friction="{friction}" {soft}'
    others, along = ["floor"], 0.0
    around = '<geom name="floor" type="plane" size="100 100 1"/>'
    if body.place == "grip":
        others = ["left", "right"]
        around = "".join(_finger(name, sign, size) for name, sign in (("left", -1.0), ("right", 1.0)))
    elif body.place == "slope":
        along = body.load * body.mu * GRAVITY
    pairs = "".join(
        f'<pair geom1="body" geom2="{other}" condim="{body.condim}"'
        f' friction="{body.mu!r} {body.mu!r} {body.mu_t!r} {body.mu_r!r} {body.mu_r!r}" {soft}/>'
        for other in others
    )
    return f"""<mujoco><option timestep="{settings["dt"]!r}" gravity="{along!r} 0 -{GRAVITY}" {options}/>
      <default><geom {"" if body.pair else said}/></default>
      <worldbody>{around}<body name="body" pos="0 0 {0.0 if body.place == "grip" else size}"><freejoint/>
        <geom name="body" type="{body.shape}" size="{sides}" mass="{mass!r}"/></body></worldbody>
      <contact>{pairs if body.pair else ""}</contact>
      <keyframe><key {_start(task)}/></keyframe></mujoco>"""


def _body(task: Task) -> Body:
    assert isinstance(task.scenario.action, Body)
    return task.scenario.action


def _finger(name: str, sign: float, size: float) -> str:
    thick = _FINGER * size
    return (
        f'<body pos="{sign * (size + thick)} 0 0"><joint name="{name}" type="slide" axis="{-sign} 0 0"'
        f' damping="{_FINGER_DAMPING}"/><geom name="{name}" type="box" size="{thick} {size} {size}" mass="0.1"/></body>'
    )


def _start(task: Task) -> str:
    """The keyframe: the body rolls without sliding, or spins, at the speed of the scenario."""
    body, v0 = _body(task), task.scenario.v0
    if body.place == "grip":
        return 'qpos="0 0 0 0 0 1 0 0 0"'
    speeds = [0.0] * 6
    speeds[_SPINS if body.spins else _ROLLS] = v0 / body.size
    speeds[0] = 0.0 if body.spins else v0
    return f'qpos="0 0 {body.size} 1 0 0 0" qvel="{" ".join(map(repr, speeds))}"'


def body_motion(task: Task, settings: dict[str, Any]) -> Motion:
    """The run of a body. Raises SimulationError for one that diverges."""
    body, mass, dt = _body(task), task.scenario.slider.m, settings["dt"]
    try:
        model = mujoco.MjModel.from_xml_string(text_of(task, settings))
    except ValueError as error:
        raise SimulationError(f"mujoco: {error}") from None
    normal, way = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    if body.place == "grip":
        normal, way = way, -normal
        # what presses the fingers together; a constant force needs no actuator
        model.qpos_spring[:2] = 1.0
        model.jnt_stiffness[:2] = 0.5 * mass * GRAVITY / (body.mu * body.load)
    steps = task.steps(dt) + 1
    seen = watched(model, Watch(model.body("body").id, 0, frozenset(), normal, 0, steps * dt))
    if seen.diverged is not None:
        raise SimulationError(f"mujoco: the run diverged at t = {seen.diverged * dt:g} s (dt = {dt:g} s)")
    x = (seen.path - seen.path[0]) @ way
    v = np.diff(x, append=2.0 * x[-1] - x[-2]) / dt
    if body.spins:
        v = body.size * seen.turning @ normal
        x = np.concatenate([[0.0], np.cumsum(0.5 * dt * (v[1:] + v[:-1]))])
    v[0] = task.scenario.v0
    a = np.gradient(v, dt)
    lift = (seen.path - seen.path[0]) @ normal
    push = mass * (GRAVITY if body.place == "grip" else body.load * body.mu * GRAVITY if body.place == "slope" else 0.0)
    n, limit = x.size - 1, math.inf if body.place == "floor" else body.mu * mass * GRAVITY
    friction = push - mass * a[:n]
    return Motion(x[:n], v[:n], a[:n], np.full(n, push), friction, np.full(n, limit), lift[:n])
