"""A user's own model of one joint, MJCF or URDF: as a slider, and as its own engine simulates it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import mujoco
from numpy.polynomial import Polynomial

from harness.core.errors import InputError
from harness.engines.base import Settings
from harness.engines.joint_words import FAR, dead_zone, stops, term_of
from harness.engines.mujoco.presets import INTEGRATORS, SOLVERS, STIFF
from harness.engines.registry import load
from harness.engines.simulator import EngineSimulator
from harness.model import term as elements
from harness.model.model import Model, ModelTerm, Restoring
from harness.model.term import Zone
from harness.robot.arm import Arm, load_arm
from harness.robot.reduction import Reduced, reduced

_SUFFIXES = (".xml", ".mjcf", ".urdf")
_DRAG = elements.Polynomial(damping=(0.0, 1.0, 0.0))
_BENDS = (elements.Polynomial((0.0, 1.0, 0.0)), elements.Polynomial((0.0, 0.0, 1.0)))
_ONE = "a model of one joint (of a robot's: --robot FILE --joint NAME)"


def words(arm: Arm, joint: str) -> dict[str, Any]:
    """Settings of MuJoCo as the model's file has them, in the names of harness.engines.mujoco."""
    option, at = arm.model.opt, arm.index(joint)

    def named(member: Any, known: tuple[str, ...]) -> str:
        """The word of the settings for a member of an enumeration of MuJoCo's, such as mjINT_EULER."""
        return next(one for one in known if one.upper() == member.name.rpartition("_")[2])

    return {
        "integrator": named(mujoco.mjtIntegrator(int(option.integrator)), INTEGRATORS),
        "solver": named(mujoco.mjtSolver(int(option.solver)), SOLVERS),
        "iterations": int(option.iterations),
        "tolerance": float(option.tolerance),
        "ls_iterations": int(option.ls_iterations),
        "noslip_iterations": int(option.noslip_iterations),
        "noslip_tolerance": float(option.noslip_tolerance),
        "solreffriction": tuple(map(float, arm.model.dof_solref[at])),
        "solimpfriction": tuple(map(float, arm.model.dof_solimp[at])),
    }


def looseness(arm: Arm, joint: str, moved: float) -> float:
    """By how much the file's friction is softer in the whole arm than in a model of the joint alone with this inertia.

    MuJoCo takes a joint's inertia for that with every other joint free, at the reference.
    """
    return float(arm.model.dof_invweight0[arm.index(joint)]) * moved


def loosened(settings: Mapping[str, Any], by: float) -> dict[str, Any]:
    """MuJoCo's settings with which a joint alone is as soft as these make it in the whole arm; by : its looseness.

    The regularisation is (1 - d)/d of the inverse inertia that MuJoCo takes for the joint's, d the impedance at rest.
    """
    found = dict(settings)
    if "solimpfriction" in found:
        d, *others = found["solimpfriction"]
        found["solimpfriction"] = (min(d / (d + by * (1.0 - d)), STIFF), *others)
    return found


@dataclass(frozen=True, slots=True)
class OwnModel:
    """slider : what the joint is, let go nowhere; its friction, damping and spring are the file's. engine : MuJoCo for
    an MJCF, PyBullet for a URDF. settings : of the engine, as the file has them. dt : its step, s. rest : position in
    the file from which the slider's x is measured, where nothing pulls it, m or rad. limits : of the joint's range, of
    x, m or rad; the slider has no such stops. turns : a hinge. slack : how far from rest no spring
    pulls, m or rad.
    """

    file: str
    slider: Model
    engine: str
    dt: float
    settings: Settings = field(default_factory=dict)
    rest: float = 0.0
    limits: tuple[float, float] = (-math.inf, math.inf)
    turns: bool = False
    slack: float = 0.0

    @property
    def simulator(self) -> EngineSimulator:
        """The engine as the file has it. Raises SimulationError where it is not installed."""
        return EngineSimulator(load(self.engine), "as-shipped", self.settings)


def is_own(path: Path) -> bool:
    """Whether a file is an MJCF or a URDF, by its name."""
    return path.suffix.lower() in _SUFFIXES


def own_model(path: Path) -> OwnModel:
    """Read a file, as ``load_arm`` does; raises InputError for several joints, and for a spring beside gravity."""
    arm = load_arm(path, polynomials=True)
    if len(arm.joints) > 1:
        raise InputError(str(path), f"{len(arm.joints)} joints: {', '.join(arm.joints)}", _ONE)
    (joint,), where = arm.joints, f"{path}: joint {arm.joints[0]}"
    own = reduced(arm, joint)
    drag, cubic = map(float, arm.drag[0])
    if cubic:
        raise InputError(where, "a damping that grows with the cube of the speed", "damping of one number or two")
    hangs = own.gravity > 0.0 and not own.slides and not own.upright
    spring = _spring(arm, own)
    if hangs and spring.degree() > 0:
        raise InputError(where, "a spring beside gravity", "a joint with one of the two")
    zones, slack = [zone for _, zone in arm.zones], 0.0
    held = Restoring.PENDULUM if hangs else Restoring.SPRING if spring.degree() > 0 else Restoring.NONE
    terms = [term_of(_DRAG, drag)] if drag else []
    k, rest = own.gravity if hangs else 0.0, own.q_eq if hangs else 0.0
    play = next((one for one in zones if one.low > -FAR and one.high < FAR), None)
    if held is Restoring.NONE and play is not None and not own.constant:
        # the only spring has a dead zone: it is slack in the middle of that
        zones.remove(play)
        held, k, rest = Restoring.SPRING, play.stiffness, (play.low + play.high) / 2.0
        slack = (play.high - play.low) / 2.0
        terms.append(dead_zone(k, slack))
        spring = Polynomial([0.0])
    if spring.degree() > 0 and not hangs:
        middle = _slack(where, spring)
        rest, about = own.q_ref + middle, spring(Polynomial([middle, 1.0]))
        k, *bends = map(float, about.coef[1:])
        terms += [term_of(element, value) for element, value in zip(_BENDS, bends, strict=False) if value]
    elif own.slides and own.constant:
        terms.append(term_of(elements.Push(1.0), -own.constant))
    terms += [stop for zone in zones for stop in _stops(where, zone, rest)]
    slider = Model(own.moved, float(arm.damping[0]), k, float(arm.frictionloss[0]), restoring=held, terms=tuple(terms))
    ends = arm.model.jnt_range[0] - rest if arm.model.jnt_limited[0] else (-math.inf, math.inf)
    limits, turns = (float(ends[0]), float(ends[1])), not own.slides
    if path.suffix.lower() == ".urdf":
        engine = load("pybullet")
        step = float(engine.presets("joint", "as-shipped")["dt"])
        return OwnModel(str(path), slider, engine.name, step, rest=rest, limits=limits, turns=turns, slack=slack)
    settings = loosened(words(arm, joint), looseness(arm, joint, own.moved))
    return OwnModel(str(path), slider, "mujoco", float(arm.model.opt.timestep), settings, rest, limits, turns, slack)


def _stops(where: str, zone: Zone, rest: float) -> list[ModelTerm]:
    """A spring with a dead zone as terms of x, from rest. Raises InputError for one that pulls there."""
    if not zone.low < rest < zone.high:
        raise InputError(where, "a tendon's spring that pulls where the joint rests", "springlength with that between")
    return stops(replace(zone, low=zone.low - rest, high=zone.high - rest))


def _spring(arm: Arm, own: Reduced) -> Polynomial:
    """Force of spring and, on a slide, gravity over the distance from where the spring is slack, N or N m."""
    bends = map(float, arm.model.jnt_stiffnesspoly[0])
    return Polynomial([own.constant if own.slides else 0.0, own.spring, *bends]).trim()


def _slack(where: str, spring: Polynomial) -> float:
    """The place nearest to zero to which a spring pulls back. Raises InputError where there is none."""
    slope = spring.deriv()
    real = [float(root.real) for root in spring.roots() if root.imag == 0.0 and slope(root.real) > 0.0]
    if not real:
        raise InputError(where, "a spring that pulls it back to no place", "stiffness above 0 at rest")
    return min(real, key=abs)
