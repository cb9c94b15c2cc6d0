"""A joint of a robot's model, as the model has it, in MuJoCo and PyBullet: what they make of its friction and servo."""

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from harness.app.run.joint_words import conclusions
from harness.app.shared.deliver import to_json
from harness.app.shared.journal import NAME as LOG
from harness.app.shared.journal import journal
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reduction import reduction_of
from harness.app.shared.showing import write_joint_page
from harness.core.checks import positive
from harness.core.errors import InputError, SimulationError
from harness.core.scenario import Hold, Scenario
from harness.core.slider import Slider
from harness.core.trajectory import Source
from harness.engines import registry
from harness.engines.base import PRESETS, Preset, Settings, Task, choice
from harness.fidelity import laws
from harness.fidelity.metrics.decay import reversal_lead_s
from harness.fidelity.metrics.hold import creep_m_s
from harness.io.store import output_folder
from harness.results.joint import JointRunResult, JointScore, ServoResult, ServoScore
from harness.results.robot import PasteResult
from harness.robot.arm import Arm, load_arm
from harness.robot.paste import JointPaste, copies
from harness.robot.reduction import Reduced, reduced
from harness.robot.servo import looseness, servo_of, words

LOGGER = logging.getLogger(__name__)
MUJOCO = "mujoco"
_MOST_LOAD = 0.97
"""Of dry friction: a heavier load slides."""
_HELD_FOR = 0.5
"""s."""
_SPRING = 4.0
"""Times dry friction a rad or m: the least spring under which a release of 1 turns round."""
_SWINGS = 2.0
"""Periods in which reversals are looked at."""
_SUBSTEPS = 4
"""Of an engine that divides a step, as Rapier and PhysX's TGS ship."""


@dataclass(frozen=True, slots=True)
class JointRun:
    """What to run.

    file, joint : of a robot's model. gravity : m/s^2, None for the model's own. engines : names. presets : as-shipped,
    tuned or both. dt : step of the tuned preset, s, None for the model's own.

    Raises InputError for an engine or a preset that does not exist, and for dt not above 0.
    """

    file: Path
    joint: str | None
    gravity: tuple[float, float, float] | None = None
    engines: tuple[str, ...] = field(default_factory=registry.usual)
    presets: tuple[str, ...] = PRESETS
    dt: float | None = None

    def __post_init__(self) -> None:
        if self.dt is not None:
            positive("--dt", self.dt, "s")
        for preset in self.presets:
            choice("--preset", preset, PRESETS)
        for name in self.engines:
            registry.check(name, "--engine")

    @classmethod
    def chosen(
        cls,
        file: Path,
        joint: str | None,
        gravity: tuple[float, float, float] | None = None,
        engines: Sequence[str] = (),
        preset: str | None = None,
        dt: float | None = None,
    ) -> "JointRun":
        """As somebody chose: no engines means the usual ones, MuJoCo and PyBullet, preset None means both."""
        presets: tuple[str, ...] = PRESETS if preset is None else (preset,)
        return cls(file, joint, gravity, tuple(engines) or registry.usual(), presets, dt)


def run_joint(
    asked: JointRun, out: Path | None = None, progress: Progress = SILENT, command: str = ""
) -> JointRunResult:
    """Run, and leave result.json, report.html, a copy of the model with what to paste, and the log in a folder.

    Raises InputError for a model or a joint that cannot be used, StoreError.
    """
    arm = load_arm(asked.file, asked.gravity)
    joint = arm.joints[0] if asked.joint is None and len(arm.joints) == 1 else asked.joint
    if joint is None:
        raise InputError("--joint", "not given", f"a joint of {arm.file} is accepted: {', '.join(arm.joints)}")
    own = reduced(arm, joint)
    with output_folder(f"run-{joint}", out) as output, journal(output / LOG):
        result = _computed(arm, own, asked, progress, command)
        named = {"result": "result.json", "report": "report.html", "log": LOG}
        (output / "model").mkdir()
        for name, text in copies(asked.file, _paste(arm, own)).items():
            (output / "model" / name).write_text(text, encoding="utf-8")
            named[f"robot_{'urdf' if name.endswith('.urdf') else 'mjcf'}"] = f"model/{name}"
        result = result.model_copy(update={"files": {name: output.at(file) for name, file in named.items()}})
        (output / "result.json").write_text(to_json(result), encoding="utf-8")
        write_joint_page(output / "report.html", result)
        output.commit()
    return result


def _paste(arm: Arm, own: Reduced) -> JointPaste:
    """The model's own friction, with what makes it stiff."""
    i = arm.index(own.joint)
    dt = float(arm.model.opt.timestep)
    return JointPaste(own.joint, float(arm.frictionloss[i]), float(arm.damping[i]), own.armature, dt)


def _computed(arm: Arm, own: Reduced, asked: JointRun, progress: Progress, command: str) -> JointRunResult:
    step = float(arm.model.opt.timestep)
    paste = _paste(arm, own)
    load, scores = _load(own, paste.f_k), []
    if load is not None:
        plan: list[tuple[str, Preset]] = [
            (name, preset) for name in dict.fromkeys(asked.engines) for preset in PRESETS if preset in asked.presets
        ]
        for done, (name, preset) in enumerate(plan):
            progress(f"{name} {preset}", done, len(plan))
            scores.append(_score(arm, own, paste, load, name, preset, asked.dt or step))
    result = JointRunResult(
        file=str(asked.file.absolute()),
        joint=own.joint,
        slides=own.slides,
        step_s=step,
        reduction=reduction_of(arm, own),
        load=load,
        scores=scores,
        servo=_servo(arm, own, step),
        paste=PasteResult(mjcf=paste.mjcf, urdf=paste.urdf),
        conclusions=[],
        command=command,
        machine=this_machine(),
        files={},
    )
    return result.model_copy(update={"conclusions": [*conclusions(result), *arm.notes]})


def _load(own: Reduced, f_k: float) -> float | None:
    """What creep is measured under, N m or N; None without dry friction, where nothing is held."""
    if f_k == 0.0:
        return None
    pulled = own.gravity > 0.0 and not own.upright
    return min(own.gravity, _MOST_LOAD * f_k) if pulled else _MOST_LOAD * f_k


def _score(arm: Arm, own: Reduced, paste: JointPaste, load: float, name: str, preset: Preset, dt: float) -> JointScore:
    """Creep and lead in one engine; MuJoCo as shipped has the words of the model's file at its own step."""
    as_written = name == MUJOCO and preset == "as-shipped"
    settings: Settings = words(arm, own.joint) if as_written else {}
    step = float(arm.model.opt.timestep) if as_written else (dt if preset == "tuned" else None)
    soft = looseness(arm, own.joint, own.moved) if name == MUJOCO else 1.0
    creep = lead = None
    used: Source | None = None
    why = None
    try:
        engine = registry.load(name)
        loose = Slider(own.moved, 0.0, _SPRING * paste.f_k, paste.f_k)
        hold = Scenario("hold", loose, 0.0, 0.0, _HELD_FOR, Hold(load))
        held = engine.simulate(Task(hold, "joint", preset, step, settings, restoring="none"))
        creep, used = soft * creep_m_s(held), held.source
        sprung = replace(loose, k=max(own.gravity, loose.k))
        swing = Scenario("free-decay", sprung, 1.0, 0.0, _SWINGS * 2.0 * math.pi / sprung.omega_n)
        lead = reversal_lead_s(engine.simulate(Task(swing, "joint", preset, step, settings)), sprung)
    except SimulationError as error:
        LOGGER.warning("%s %s: %s", name, preset, error)
        why = str(error)
    return JointScore(
        engine=name,
        preset=preset,
        version="" if used is None else used.version,
        dt_s=step if used is None else used.dt,
        creep=creep,
        reversal_lead_s=lead,
        settings={} if used is None else {k: list(v) if isinstance(v, tuple) else v for k, v in used.settings.items()},
        ignored=[] if used is None else list(used.ignored),
        error=why,
    )


def _servo(arm: Arm, own: Reduced, h: float) -> ServoResult | None:
    """What the step does to the model's servo, by the laws of docs/fidelity.md."""
    servo = servo_of(arm, own.joint)
    if servo is None:
        return None
    m, k = own.moved, servo.stiffness
    joint, kv = float(arm.damping[arm.index(own.joint)]), servo.damping
    c = joint + kv
    integrator = words(arm, own.joint)["integrator"]
    by_mujoco: dict[str, Callable[[], float]] = {
        "Euler": lambda: laws.half_implicit(m, kv, joint, h),
        "RK4": lambda: c,
        "discrete": lambda: laws.implicit(m, c, k, h, 1),
    }
    acts: dict[str, Callable[[], float]] = {
        f"MuJoCo, {integrator}, as the model has it": by_mujoco.get(
            integrator, lambda: laws.half_implicit(m, 0.0, c, h)
        ),
        "a torque held over the step (PyBullet's TORQUE_CONTROL)": lambda: laws.held(m, c, k, h, 1),
        f"a torque held over {_SUBSTEPS} sub-steps (Rapier, PhysX TGS)": lambda: laws.held(m, c, k, h, _SUBSTEPS),
        "the engine's own implicit drive (DART, PhysX PGS)": lambda: laws.implicit(m, c, k, h, 1),
    }
    root = 2.0 * (k * m) ** 0.5
    scores = []
    for who, law in acts.items():
        try:
            acting = law()
        except ValueError:
            scores.append(ServoScore(who=who, false_damping=None, zeta=None))
            continue
        scores.append(ServoScore(who=who, false_damping=acting - c, zeta=acting / root))
    return ServoResult(stiffness=k, damping=c, zeta=c / root, step_s=h, scores=scores)
