"""From a Task to a compiled MjModel with every setting in it."""

from typing import Any

import mujoco
import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.scenario import Harmonic, Hold
from harness.engines import models
from harness.engines.base import Task
from harness.engines.forces import ForceLaw
from harness.engines.joint_words import GRAVITY, JointWords, coefficient
from harness.engines.mujoco.callback import SLOTS, Slot
from harness.engines.samples import belt_speed, held_at_start

_STAGES = {"RK4": 4}


class Forces:
    """Words of userdata for one run, and the memory they point to; keep it until the run is over.

    words : float64, shape (SLOTS,). needed : whether the callback has to be installed at all. frame : speed of the
    frame the joint lives in, m/s. switches : whether break-away lies above sliding friction. first_limit : friction
    limit at the start, N. applied, limits : what the callback records, one word a step, shape (steps + 1,).
    """

    def __init__(self, task: Task, settings: dict[str, Any]) -> None:
        slider, law, contact = task.scenario.slider, task.law, task.route == "contact"
        own_level = law is not None and law.level is not None
        count = task.steps(settings["dt"]) + 1
        self._kept: list[FloatArray] = []
        self.applied: FloatArray = np.zeros(count)
        self.limits: FloatArray = np.full(count, slider.f_k)
        # on a belt the joint lives in the frame of the belt, where its friction belongs; the spring's end moves instead
        self.frame = 0.0 if contact else belt_speed(task)
        self.switches = slider.break_away > slider.f_k or (contact and own_level)
        stuck = self.switches and held_at_start(task, settings["dt"])
        self.first_limit = slider.break_away if stuck or slider.f_k == 0.0 else slider.f_k
        if own_level and self.first_limit == 0.0:
            self.first_limit = 1.0  # without any limit the joint has no row of friction to set

        words = np.zeros(SLOTS)
        words[Slot.STAGES], words[Slot.DT] = _STAGES.get(settings["integrator"], 1), settings["dt"]
        words[Slot.FRAME], words[Slot.DAMPING] = self.frame, slider.c
        words[Slot.STIFFNESS] = slider.k if task.restoring == "spring" else 0.0
        words[Slot.PENDULUM] = slider.k if task.restoring == "pendulum" else 0.0
        words[Slot.F_K] = slider.f_k
        words[Slot.RATIO] = slider.break_away / slider.f_k if slider.f_k > 0.0 else 1.0
        words[Slot.EXCESS] = slider.break_away if slider.f_k == 0.0 else 0.0
        words[Slot.SETS_LEVEL] = task.route == "joint" and (self.switches or own_level)
        words[Slot.STUCK] = stuck and not contact
        words[Slot.CLIPPED] = task.route == "law"
        words[Slot.METRIC] = slider.m / settings["dt"] + (0.0 if settings["integrator"] == "RK4" else slider.c)
        words[Slot.APPLIED], words[Slot.LIMITS] = self._keep(self.applied), self._keep(self.limits)
        words[Slot.RECORDS] = count
        self.words = words
        self._drive(task)
        if law is not None:
            self._law(law)
        unforced = task.scenario.action is None and task.drive is None and law is None and self.frame == 0.0
        plain = task.restoring != "pendulum" and not words[Slot.CLIPPED] and not words[Slot.SETS_LEVEL]
        self.needed = not (unforced and plain)

    def _drive(self, task: Task) -> None:
        match task.scenario.action:
            case Harmonic() as action:
                self.words[[Slot.AMPLITUDE, Slot.OMEGA, Slot.PHASE]] = action.amplitude, action.omega, action.phase
            case Hold() as action:
                self.words[Slot.CONSTANT] = action.force
        if task.drive is not None:
            self.words[Slot.DRIVE_N] = task.drive.t.size
            self.words[[Slot.DRIVE_T, Slot.DRIVE_U]] = self._keep(task.drive.t), self._keep(task.drive.u)

    def _law(self, law: ForceLaw) -> None:
        from harness.engines.mujoco.callback import law_address

        state = law.state.copy()
        self.words[Slot.FORCE] = law_address(law.force) if law.force else 0.0
        self.words[Slot.LEVEL] = law_address(law.level) if law.level else 0.0
        self.words[Slot.ADVANCE] = law_address(law.advance, moves=True) if law.advance else 0.0
        self.words[[Slot.STATE, Slot.STATE_N]] = self._keep(state), state.size
        self.words[[Slot.PARAMS, Slot.PARAMS_N]] = self._keep(law.params), law.params.size

    def _keep(self, array: FloatArray) -> float:
        """Address of an array, which is kept alive; exact as a double."""
        self._kept.append(array)
        return float(array.ctypes.data)


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
    return spec_of(task, settings, limit).compile()


def spec_of(task: Task, settings: dict[str, Any], limit: float) -> Any:
    """The MjSpec of a task, which is the caller's own."""
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
    return spec


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
