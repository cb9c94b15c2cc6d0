"""Search of an engine's settings for one joint of a robot, at the robot's own step."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from harness.app.shared.progress import SILENT, Progress
from harness.app.sweep.tune import tune
from harness.core.errors import InputError
from harness.core.scenario import Harmonic
from harness.core.slider import Slider
from harness.fidelity.sliders import Sliders
from harness.fidelity.tune import HELD_OUT, SEARCH, Subject
from harness.results.tune import TunedJoint, TuneResult
from harness.robot.arm import Arm, load_arm
from harness.robot.paste import JointPaste
from harness.robot.reduction import Reduced, reduced
from harness.robot.servo import loosened, looseness, words

MUJOCO, PYBULLET = "mujoco", "pybullet"
SCENARIOS = ("free-decay", "hold-50", "hold-97", "harmonic")
"""What a joint without a law of its own for break-away does; no belt carries it."""
_SPRING = 4.0
"""Times dry friction a rad or m: the least spring under which a release of 1 turns round."""
_DRIVE = 3.0
"""Times dry friction, the size of a harmonic torque, at this share of the natural frequency:"""
_BELOW = 0.7
_BREAK_AWAY = 1.2
_TURN = 1.0
"""rad: the poses of the others that are tried, about the model's reference."""


@dataclass(frozen=True, slots=True)
class TuneJoint:
    """Which joint. file : of a robot's model. gravity : m/s^2, None for its own. dt : s, None for the model's own."""

    file: Path
    joint: str | None
    gravity: tuple[float, float, float] | None = None
    dt: float | None = None


def tune_joint(name: str, asked: TuneJoint, most: float | None = None, progress: Progress = SILENT) -> TuneResult:
    """Search on the joint with the others in some poses, score in others; what ships is the model's file as it is.

    most : as in ``tune``. Raises InputError as ``tune`` does, for a joint that there is not, and for one whose model
    has no dry friction.
    """
    arm = load_arm(asked.file, asked.gravity)
    joint = arm.joints[0] if asked.joint is None and len(arm.joints) == 1 else asked.joint
    if joint is None:
        raise InputError("--joint", "not given", f"a joint of {arm.file} is accepted: {', '.join(arm.joints)}")
    at = arm.index(joint)
    f_k, c = float(arm.frictionloss[at]), float(arm.damping[at])
    if f_k == 0.0:
        accepted = "a joint with frictionloss (MJCF) or friction (URDF) is accepted; harness diagnose --robot finds it"
        raise InputError(f"{asked.file}: joint {joint}", "no dry friction: there is nothing to tune", accepted)
    poses = {number: _posed(arm, joint, number) for number in (*SEARCH, *HELD_OUT)}
    subject = Subject(lambda number: _sliders(poses[number], f_k, c), SCENARIOS)
    if name == MUJOCO:
        soft = looseness(arm, joint, reduced(arm, joint).moved)
        own = {key: value for key, value in words(arm, joint).items() if key != "dt"}
        subject = replace(subject, own=own, given=lambda settings: loosened(settings, soft))
    dt = float(arm.model.opt.timestep) if asked.dt is None else asked.dt
    result = tune(name, "joint", dt, most, progress, subject)
    paste = JointPaste(joint, f_k, c, float(arm.armature[at]), dt)
    robot = TunedJoint(
        file=str(asked.file.absolute()),
        joint=joint,
        inertia=[one.moved for one in poses.values()],
        gravity=[one.gravity for one in poses.values()],
    )
    return result.model_copy(update={"paste": _text(name, result, paste), "robot": robot})


def _posed(arm: Arm, joint: str, number: int) -> Reduced:
    """The joint with the others in a random pose, always the same for the same number."""
    random = np.random.default_rng([31, number])
    others = [other for other in arm.joints if other != joint]
    reference = dict(zip(arm.joints, arm.model.qpos0, strict=True))
    held = {other: float(reference[other] + random.uniform(-_TURN, _TURN)) for other in others if not arm.slides(other)}
    return reduced(arm, joint, held)


def _sliders(own: Reduced, f_k: float, c: float) -> Sliders:
    """The joint as the suite has sliders: gravity's torque, or what turns it round, is the spring."""
    decay = Slider(own.moved, c, max(own.gravity, _SPRING * f_k), f_k)
    driven = replace(decay, c=0.0)
    sticky = replace(driven, f_s=_BREAK_AWAY * f_k)
    drive = Harmonic(_DRIVE * f_k, _BELOW * driven.omega_n)
    return Sliders(decay, 1.0, sticky, (sticky.x_s - sticky.x_k) * sticky.omega_n, driven, drive, drive)


def _text(name: str, result: TuneResult, paste: JointPaste) -> str:
    """What to paste, the joint named."""
    text = result.paste.replace("<joint ", f'<joint name="{paste.joint}" ').replace(
        "on the joint that has frictionloss", "into the joint"
    )
    if name == PYBULLET:
        return "\n".join((text, *paste.calls))
    return text
