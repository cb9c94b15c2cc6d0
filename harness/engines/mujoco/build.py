"""From a Task to a compiled MjModel with every setting in it."""

from typing import Any

import mujoco

from harness.core.errors import SimulationError
from harness.engines import models
from harness.engines.actions import belt_speed
from harness.engines.base import Task
from harness.engines.joint_words import JointWords
from harness.engines.mujoco.callback import SLOTS
from harness.engines.weight import GRAVITY, coefficient

_INTEGRATOR = {
    "Euler": mujoco.mjtIntegrator.mjINT_EULER,
    "RK4": mujoco.mjtIntegrator.mjINT_RK4,
    "implicit": mujoco.mjtIntegrator.mjINT_IMPLICIT,
    "implicitfast": mujoco.mjtIntegrator.mjINT_IMPLICITFAST,
    "discrete": getattr(mujoco.mjtIntegrator, "mjINT_DISCRETE", None),  # newer ones have it
}
_SOLVER = {
    "PGS": mujoco.mjtSolver.mjSOL_PGS,
    "CG": mujoco.mjtSolver.mjSOL_CG,
    "Newton": mujoco.mjtSolver.mjSOL_NEWTON,
}
_CONE = {"pyramidal": mujoco.mjtCone.mjCONE_PYRAMIDAL, "elliptic": mujoco.mjtCone.mjCONE_ELLIPTIC}


_kept: dict[str, Any] = {}
"""The last model of a joint by what it was made of: windows of a recording differ in their starts alone."""


def compile_model(task: Task, settings: dict[str, Any], limit: float) -> Any:
    """The model of a task; ``limit`` is the friction limit the model starts with, N.

    A joint's model may be that of the task before, and is not to be changed; a contact's is the caller's own.
    """
    if task.route == "contact":
        return _compiled(task, settings, limit)
    made_of = repr((task.scenario.slider, task.route, task.restoring, task.words, sorted(settings.items()), limit))
    if made_of not in _kept:
        _kept.clear()
        _kept[made_of] = _compiled(task, settings, limit)
    return _kept[made_of]


def _compiled(task: Task, settings: dict[str, Any], limit: float) -> Any:
    contact = task.route == "contact"
    slider = task.scenario.slider
    spec = models.mjcf(slider, "slider_on_floor" if contact else "slider", task.restoring)
    spec.nuserdata = SLOTS
    option = spec.option
    option.timestep = settings["dt"]
    integrator = _INTEGRATOR[settings["integrator"]]
    if integrator is None:
        raise SimulationError(f"mujoco {mujoco.__version__}: no integrator {settings['integrator']}")
    option.integrator = integrator
    option.solver = _SOLVER[settings["solver"]]
    option.cone = _CONE[settings["cone"]]
    for name in ("iterations", "tolerance", "ls_iterations", "noslip_iterations", "noslip_tolerance", "impratio"):
        setattr(option, name, settings[name])
    option.gravity = [0.0, 0.0, -GRAVITY]
    # a diverged run must be reported, not silently restarted
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    if not contact:
        # nothing is there to touch: the same motion to the last bit, a tenth sooner
        option.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    slide = spec.joint("slide")
    if task.words is not None:
        _say(spec, slide, task.words)
    if contact:
        # a pair takes the place of what the two geoms say and can tell friction's softness from the floor's
        pair = spec.add_pair(geomname1="floor", geomname2="box", condim=3)
        mu = coefficient(slider, limit)
        pair.friction = [mu, mu, 0.0, 0.0, 0.0]
        pair.solref, pair.solimp = settings["solref"], settings["solimp"]
        pair.solreffriction = settings["solreffriction"]
        # the surface moves, the geom does not
        if belt := belt_speed(task):
            if not hasattr(spec.geom("floor"), "surfacevel"):
                raise SimulationError(f"mujoco {mujoco.__version__}: no surface of a geom moves (surfacevel)")
            spec.geom("floor").surfacevel = [belt, 0.0, 0.0, 0.0, 0.0, 0.0]
    else:
        slide.frictionloss = limit if task.route == "joint" else 0.0
        slide.solref_friction = settings["solreffriction"]
        slide.solimp_friction = settings["solimpfriction"]
    return spec.compile()


def _say(spec: Any, slide: Any, words: JointWords) -> None:
    """Add polynomials and zones to the joint."""
    if not models.polynomial(slide):
        raise SimulationError(f"mujoco {mujoco.__version__}: a joint's stiffness and damping are one number each")
    slide.stiffness = [own + more for own, more in zip(slide.stiffness, words.stiffness, strict=True)]
    slide.damping = [own + more for own, more in zip(slide.damping, words.damping, strict=True)]
    for name, zone in words.zones:
        tendon = spec.add_tendon(name=name)
        tendon.wrap_joint("slide", 1.0)
        tendon.stiffness = [zone.stiffness, 0.0, 0.0]
        tendon.springlength = [zone.low, zone.high]
