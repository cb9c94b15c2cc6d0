"""A joint of a robot's model, as the model has it, in MuJoCo and PyBullet: what they make of its friction and servo.

In numbers, in sentences and as a table.
"""

import logging
import math
from dataclasses import dataclass, replace
from pathlib import Path

from harness.app.run.joint_servo import itself_in, servo_scores
from harness.app.shared.leaving import FILES, curves_of, leave, leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.parts import only_joint, reduction_of
from harness.app.shared.progress import SILENT, Progress
from harness.core.errors import InputError, SimulationError
from harness.core.scenario import Hold, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Source, Trajectory
from harness.core.wording import capitalised
from harness.engines import registry
from harness.engines.base import PRESETS, Preset, Settings, Task
from harness.fidelity.metrics import reversal_lead_s
from harness.fidelity.scenarios.hold import creep_m_s
from harness.results.robot import PasteResult
from harness.results.run import AsItIsResult, JointRunResult, JointScore, ServoCure
from harness.robot.arm import Arm, load_arm
from harness.robot.as_it_is import as_it_is
from harness.robot.own_model import words
from harness.robot.paste import JointPaste, copies, elsewhere
from harness.robot.pictured import moved
from harness.robot.reduction import Reduced, reduced
from harness.show.report.robot import joint_page
from harness.show.report.scenes import joint_scene

LOGGER = logging.getLogger(__name__)
MUJOCO = "mujoco"
_HELD_FOR = 0.5
"""s."""
_SPRING = 4.0
"""Times dry friction a rad or m: the least spring under which a release of 1 turns round."""
_SWINGS = 2.0
"""Periods in which reversals are looked at."""


@dataclass(frozen=True, slots=True)
class Played:
    """A score, and the motions that it is of: held under the load, and swinging; None where they could not be run."""

    score: JointScore
    held: Trajectory | None
    swing: Trajectory | None


def played(
    arm: Arm, own: Reduced, f_k: float, load: float, softness: float, name: str, preset: Preset, dt: float
) -> Played:
    """Creep and lead in one engine; MuJoCo as shipped has the words of the model's file at its own step.

    softness : of MuJoCo's friction in the whole model, over that of the joint alone.
    """
    as_written = name == MUJOCO and preset == "as-shipped"
    settings: Settings = words(arm, own.joint) if as_written else {}
    step = float(arm.model.opt.timestep) if as_written else (dt if preset == "tuned" else None)
    soft = softness if name == MUJOCO else 1.0
    creep = lead = why = None
    held = swung = None
    try:
        engine = registry.load(name)
        loose = Slider(own.moved, 0.0, _SPRING * f_k, f_k)
        hold = Scenario("hold", loose, 0.0, 0.0, _HELD_FOR, Hold(load))
        alone = engine.simulate(Task(hold, "joint", preset, step, settings, restoring="none"))
        # the model of the joint alone holds it more firmly than the whole arm's
        held = replace(alone, x=soft * alone.x, v=soft * alone.v, a=soft * alone.a)
        creep = creep_m_s(held)
        sprung = replace(loose, k=max(own.gravity, loose.k))
        swing = Scenario("free-decay", sprung, 1.0, 0.0, _SWINGS * 2.0 * math.pi / sprung.omega_n)
        swung = engine.simulate(Task(swing, "joint", preset, step, settings))
        lead = reversal_lead_s(swung, sprung)
    except SimulationError as error:
        LOGGER.warning("%s %s: %s", name, preset, error)
        why = str(error)
    used = Source(name, preset, dt=step) if held is None else held.source
    score = JointScore.taken_from(
        used, engine=name, preset=preset, dt_s=used.dt, creep=creep, reversal_lead_s=lead, error=why
    )
    return Played(score, held, swung)


@dataclass(frozen=True, slots=True)
class JointRun:
    """What to run.

    file, joint : of a robot's model. gravity : m/s^2, None for the model's own. engines : names, empty for the usual
    ones, MuJoCo and PyBullet. presets : as-shipped or tuned, empty for both. dt : step of the tuned preset, s, None for
    the model's own.

    Raises InputError for an engine or a preset that does not exist, and for dt not above 0.
    """

    file: Path
    joint: str | None
    gravity: tuple[float, float, float] | None = None
    engines: tuple[str, ...] = ()
    presets: tuple[str, ...] = ()
    dt: float | None = None

    def __post_init__(self) -> None:
        registry.check_asked(self.engines, self.presets, self.dt)

    @property
    def plan(self) -> list[tuple[str, Preset]]:
        return registry.runs(self.engines or registry.usual(), self.presets or PRESETS)


def run_joint(
    asked: JointRun, out: Path | None = None, progress: Progress = SILENT, command: str = ""
) -> JointRunResult:
    """Run, and leave result.json, report.html, a copy of the model with what to paste, and the log in a folder.

    Raises InputError for a model or a joint that cannot be used, StoreError.
    """
    arm = load_arm(asked.file, asked.gravity)
    joint = asked.joint or only_joint(arm)
    own = reduced(arm, joint)
    if own.ratios:
        found = f"it moves {', '.join(own.ratios)} by a ratio, and the others are held here"
        raise InputError(f"{arm.file}: joint {joint}", found, "a joint that moves by itself")
    with leaving(f"run-{joint}", out) as output:
        result, motions = _computed(arm, own, asked, progress, command)
        named = dict(FILES)
        (output / "model").mkdir()
        for name, text in copies(asked.file, _paste(arm, own)).items():
            (output / "model" / name).write_text(text, encoding="utf-8")
            named[f"robot_{'urdf' if name.endswith('.urdf') else 'mjcf'}"] = f"model/{name}"
        result = result.model_copy(update={"files": {name: output.at(file) for name, file in named.items()}})
        held = [one.held for one in motions if one.held is not None]
        swings = [one.swing for one in motions if one.swing is not None]
        curves = curves_of(
            {
                f"{kind}, {one.source.label}": one
                for kind, those in (("held", held), ("swings", swings))
                for one in those
            }
        )
        robot = moved(asked.file, arm, joint, swings[0] if swings else None)
        leave(output, result, joint_page(result, held, swings), joint_scene(result, held, swings, robot), curves)
    return result


def _paste(arm: Arm, own: Reduced) -> JointPaste:
    """The model's own friction, with what makes it stiff."""
    i = arm.index(own.joint)
    dt = float(arm.model.opt.timestep)
    return JointPaste(own.joint, float(arm.frictionloss[i]), float(arm.damping[i]), own.armature, dt)


def _computed(
    arm: Arm, own: Reduced, asked: JointRun, progress: Progress, command: str
) -> tuple[JointRunResult, list[Played]]:
    step = float(arm.model.opt.timestep)
    paste, itself = _paste(arm, own), as_it_is(asked.file, own.joint, asked.gravity)
    friction, tuned = max(paste.f_k, itself.friction), asked.dt or step
    motions: list[Played] = []
    if itself.load is not None:
        for done, (name, preset) in enumerate(asked.plan):
            progress(f"{name} {preset}", done, len(asked.plan))
            motions.append(played(arm, own, friction, itself.load, itself.softness, name, preset, tuned))
    scores = [one.score for one in motions]
    result = JointRunResult(
        file=str(asked.file.absolute()),
        joint=own.joint,
        slides=own.slides,
        step_s=step,
        reduction=reduction_of(arm, own),
        load=itself.load,
        scores=scores,
        as_it_is=itself_in(itself, asked.file, own, asked.gravity, asked.plan, scores, tuned),
        servo=servo_scores(itself),
        paste=PasteResult(mjcf=paste.mjcf, urdf=paste.urdf, **elsewhere([paste], arm.slides)),
        conclusions=[],
        command=command,
        machine=this_machine(),
        files={},
    )
    return result.model_copy(update={"conclusions": [*conclusions(result), *arm.notes]}), motions


_COMPENSATED = 0.99
"""Of gravity's torque, below which what is left is told."""
_NOTHING = 1e-12
"""m/s or rad/s, below which a solver's rounding is no creep."""
_SOFT_S = 0.2
"""s, ten of MuJoCo's time constants as shipped: what softness may cost until a joint has stopped."""


def conclusions(result: JointRunResult) -> list[str]:
    """What the engines make of the joint, a sentence each."""
    own, torque = result.reduction, "N" if result.slides else "N m"
    said = [capitalised(own.said)]
    itself = result.as_it_is[0] if result.as_it_is else None
    gravity = own.gravity if itself is None else itself.gravity
    friction = own.frictionloss if itself is None else max(itself.friction, itself.switched_off)
    bears = max(friction, 0.0 if itself is None else itself.break_away)
    if result.load is None:
        said.append(
            f"The model gives {result.joint} no dry friction: there is nothing to hold it, and nothing to score."
        )
    elif bears <= gravity:
        said.append(
            f"Dry friction ({friction:.4g} {torque}) is below gravity's {gravity:.4g} {torque}; creep is measured under"
            f" {result.load:.4g} {torque}, nearly all that friction bears."
        )
    else:
        said.append(f"Creep is measured under {result.load:.4g} {torque}; a real joint does not move.")
    if gravity < _COMPENSATED * own.gravity:
        said.append(f"Your file compensates gravity's {own.gravity:.4g} {torque} but for {gravity:.4g} {torque}.")
    said += [sentence for one in result.as_it_is for sentence in _itself(result, one)]
    for score in result.scores:
        if score.error is not None:
            said.append(f"{score.engine} {score.preset} could not be run: {score.error}.")
            continue
        creep = "-" if score.creep is None else _speed(result, score.creep)
        lead = "-" if score.reversal_lead_s is None else f"{score.reversal_lead_s * 1e3:.3g} ms"
        said.append(
            f"{score.engine} {score.preset}, step {1e3 * (score.dt_s or 0.0):.3g} ms: {result.joint} creeps at"
            f" {creep}, and friction reverses {lead} before the velocity."
        )
    return said + _servo(result)


def _itself(result: JointRunResult, one: AsItIsResult) -> list[str]:
    """What the user's file does when an engine steps it."""
    torque, speed = ("N", "m/s") if result.slides else ("N m", "rad/s")
    who = f"Your file itself in {one.engine}" + (f" {one.preset}" if one.engine != "mujoco" else "")
    said = []
    if one.switched_off > 0.0:
        said.append(
            f"Your file has dry friction of {one.switched_off:.4g} {torque} and switches it off"
            ' (<flag frictionloss="disable"/>): nothing holds the joint.'
        )
    said += [f"In your file {note}." for note in one.notes]
    if one.diverges_after is not None:
        ratio = one.dt_s * one.damping / (result.reduction.inertia + result.reduction.armature)
        limit = "" if ratio == 0.0 else f" (h c/m = {ratio:.3g}; a damping that is explicit bears less than 2)"
        said.append(f"{who}, step {1e3 * one.dt_s:.3g} ms: its own damping diverges{limit}.")
    elif one.creep is not None:
        falls = " it falls, at" if one.friction == 0.0 else f" {result.joint} creeps at"
        said.append(f"{who}, step {1e3 * one.dt_s:.3g} ms, the other joints held:{falls} {_speed(result, one.creep)}.")
    if one.differs is not None:
        said.append(one.differs)
    stop = one.stop
    if stop is not None and (stop.time_s is None or stop.time_s > stop.exact_time_s + _SOFT_S):
        took = "more than 4 s" if stop.time_s is None or stop.travel is None else (
            f"{stop.time_s:.3g} s and {_place(result, stop.travel)}"
        )  # fmt: skip
        exact = f"{stop.exact_time_s:.2g} s and {_place(result, stop.exact_travel)}"
        said.append(
            f"Let go at {stop.speed:.3g} {speed} without a load it takes {took} to stop, where Coulomb's law takes"
            f' {exact}: noslip makes friction push on beside joint damping; noslip_iterations="0" mends it.'
        )
    return said


def _servo(result: JointRunResult) -> list[str]:
    servo = result.servo
    if servo is None:
        return []
    torque, angle = ("N", "m") if result.slides else ("N m", "rad")
    said = []
    if servo.zeta is None:
        begins = f"Its actuator and the joint's damping brake with {servo.damping:.4g} {torque} s/{angle}"
    else:
        begins = f"Its servo of {servo.stiffness:.4g} {torque}/{angle} has zeta {servo.zeta:.3g}"
    said.append(f"{begins}; at a step of {1e3 * servo.step_s:.3g} ms it acts as:")
    for one in servo.scores:
        if not one.stable:
            acts = "it diverges"
        elif one.false_damping is None:
            acts = "it is stable, and reverses at every step"
        elif one.zeta is None:
            acts = f"{one.false_damping:+.3g} false damping"
        else:
            acts = f"zeta {one.zeta:.3g} ({one.false_damping:+.3g} false damping)"
        said.append(f"{one.who}: {acts}.")
    if servo.cure is not None:
        after = "" if servo.diverges_after is None else f" (your file itself: after {servo.diverges_after} steps)"
        said.append(f"The servo diverges in your file{after}. One of these mends it: {_cures(servo.cure, result)}.")
    return said


def _cures(cure: ServoCure, result: JointRunResult) -> str:
    torque, angle, mass = ("N", "m", "kg") if result.slides else ("N m", "rad", "kg m^2")
    found = []
    if cure.kp is not None:
        found.append(f"kp at most {cure.kp:.4g} at this damping")
    elif cure.stiffness is not None:
        found.append(f"a stiffness of at most {cure.stiffness:.4g} {torque}/{angle} at this damping")
    if cure.damping is not None:
        found.append(f"a damping of the servo of at most {cure.damping:.4g} {torque} s/{angle}")
    if cure.step_s is not None:
        found.append(f"a step of at most {1e3 * cure.step_s:.3g} ms")
    if cure.armature is not None:
        found.append(f"an armature that is larger by {cure.armature:.3g} {mass}")
    if cure.integrators:
        found.append(f"the integrator {' or '.join(cure.integrators)}")
    return "; ".join(found)


def _speed(result: JointRunResult, v: float) -> str:
    v = v if abs(v) > _NOTHING else 0.0
    return f"{v * 1e3:.3g} mm/s" if result.slides else f"{math.degrees(v):.3g} deg/s"


def _place(result: JointRunResult, x: float) -> str:
    return f"{x * 1e3:.3g} mm" if result.slides else f"{math.degrees(x):.3g} deg"
