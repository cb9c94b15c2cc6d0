"""A joint of an arm that moves as a whole: what its torque says of its friction, and of the model."""

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.app.diagnose.joint_doubts import stands_for, surely, with_forward_run
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.robot_options import RobotOptions
from harness.app.diagnose.show import tried, write_arm_page, write_arm_trace
from harness.app.diagnose.unmatched import match_results, recording_info
from harness.app.shared.deliver import to_json
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import NAME as LOG
from harness.app.shared.progress import Progress, journal
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.core.robot.joint_log import JointLog
from harness.io.store import output_folder
from harness.model.document import to_document
from harness.model.model import Model, Restoring
from harness.results.common import ModelDocument, P, Where
from harness.results.diagnosis import (
    AlternativeResult,
    DiagnosisResult,
    FitResult,
    HoldoutResult,
    MechanismResult,
    RuleResult,
)
from harness.results.robot import ArmResult, EntryResult, JointResult, PasteResult, RobotResult
from harness.robot.arm import Arm
from harness.robot.match.compared import Compared, Match
from harness.robot.paste import JointPaste, copies
from harness.robot.reduction import reduced
from harness.robot.whole_arm.result import Entry, JointFriction, WholeArm
from harness.robot.whole_arm.rules import EXPLAINED
from harness.robot.whole_arm.whole import whole_arm

LOGGER = logging.getLogger(__name__)
FILES = {
    "result": "result.json",
    "report": "report.html",
    "rrd": "trace.rrd",
    "residual_torque": "residual_torque.csv",
    "log": LOG,
}
_VERDICTS = {"explains": "missing_physics", "main": "main_effect", "one-of": "one_of"}
_GIVEN = "the robot's model gives it, at the middle of the motion"
_NO_MODEL = "no model file holds an arm's joint with more than viscous and Coulomb friction: {name} is in the sentences"


@dataclass(frozen=True, slots=True)
class Arms:
    """What was asked and what came out. inertia : of the joint at the middle of its motion, kg m^2 or kg."""

    arm: Arm
    log: JointLog
    asked: RobotOptions
    options: DiagnoseOptions
    found: WholeArm
    joint: JointFriction
    inertia: float
    matches: tuple[Match, ...]


def diagnose_arm(
    arm: Arm,
    log: JointLog,
    joint: str,
    compared: Compared,
    asked: RobotOptions,
    options: DiagnoseOptions,
    out: Path | None,
    progress: Progress,
    command: str,
) -> DiagnosisResult:
    """Diagnose a joint of an arm that moves as a whole, and leave result, page, trace and a copy of the model.

    Raises InputError, StoreError.
    """
    name = f"diagnose-{Path(log.file).name.split('.')[0]}-{joint}"
    with output_folder(name, out) as output, journal(output / LOG):
        progress("torque of the whole arm", 1, 4)
        left_out = {one.joint for one in compared.matches if one.wrong}
        followed = [name for name in log.effort if name not in left_out] if left_out else None
        found = whole_arm(
            log, arm, joints=followed, payload=asked.payload, sensor=asked.sensor, gain_known=asked.gain is not None
        )
        if joint not in [one.joint for one in found.joints]:
            there = ", ".join(one.joint for one in found.joints)
            raise InputError(f"{log.file}: {joint}", "no effort of it is logged", f"{there} are accepted")
        if found.joint(joint).coulomb.value is None:
            those = ", ".join(one.joint for one in found.joints if one.coulomb.value is not None)
            raise InputError(
                f"{log.file}: {joint}", "it does not move to and fro enough", f"a joint that does: {those}"
            )
        middle = {n: float(np.mean(log.position[n])) for n in arm.joints if n in log.position}
        arms = Arms(
            arm, log, asked, options, found, found.joint(joint), reduced(arm, joint, middle).moved, compared.matches
        )
        progress("writing trace and report", 3, 4)
        paste = _paste(arms)
        files = dict(FILES)
        (output.work / "model").mkdir(exist_ok=True)
        for file, text in copies(asked.file, paste).items():
            (output.work / "model" / file).write_text(text, encoding="utf-8")
            files[f"robot_{'urdf' if file.endswith('.urdf') else 'mjcf'}"] = f"model/{file}"
        result = _result(arms, paste, command, {kind: output.at(file) for kind, file in files.items()})
        left = _left(found)
        own = tried(arm, log, paste, asked, left, arms.joint.offset.value or 0.0, options.engines)
        result = with_forward_run(result, own.results)
        header = "t,q,v,before,after"
        np.savetxt(output / FILES["residual_torque"], left[joint], "%.9g", ",", header=header, comments="")
        (output / FILES["result"]).write_text(to_json(result), encoding="utf-8")
        write_arm_trace(output / FILES["rrd"], result, own.shown)
        write_arm_page(output / FILES["report"], result, own.shown)
        output.commit()
    return result


def _left(found: WholeArm) -> dict[str, np.ndarray[tuple[int, int], np.dtype[np.float64]]]:
    """By joint, columns t, q, v, torque left by the base and by the model (m, 5)."""
    return {
        one.joint: np.column_stack((one.left.t, one.left.q, one.left.v, one.left.before, one.left.after))
        for one in found.joints
        if one.left is not None
    }


def _paste(arms: Arms) -> JointPaste:
    """The line through friction; nothing that is not surely above none."""
    i = arms.arm.index(arms.joint.joint)
    f_k, c = (surely(q) for q in arms.joint.line or (arms.joint.coulomb, arms.joint.viscous))
    return JointPaste(arms.joint.joint, f_k, c, float(arms.arm.armature[i]), float(arms.arm.model.opt.timestep))


def _entry(one: Entry, family: str) -> EntryResult:
    return EntryResult(
        name=one.name,
        family=family,
        joint=one.joint,
        partner=one.partner or one.pair,
        grade=one.grade.value,
        share=one.share,
        evidence=one.evidence,
        rivals=list(one.rivals),
        parameters={name: P.of(quantity) for name, quantity in one.parameters},
        statement=one.statement,
    )


def _result(arms: Arms, paste: JointPaste, command: str, files: dict[str, str]) -> DiagnosisResult:
    joint, found, log = arms.joint, arms.found, arms.log
    every = [_entry(effect, "friction") for one in found.joints for effect in one.effects]
    every += [_entry(error, "model") for error in found.model]
    own = [one for one in every if one.joint in (joint.joint, None)]
    mechanisms = [_mechanism(one, found.seconds, joint.samples) for one in sorted(own, key=lambda one: -one.share)]
    verdict = _verdict(joint, own)
    before, after = joint.held_out or (None, None)
    base = joint.base or (joint.coulomb, joint.viscous, joint.offset)
    plain = _fit(base, arms, before)
    refined = _fit((joint.coulomb, joint.viscous, joint.offset), arms, after)
    document = ModelDocument.model_validate(to_document(_model(paste, arms.inertia)))
    squares = {} if before is None else {"u": before}
    return DiagnosisResult(
        recording=recording_info(log, joint.joint),
        verdict=verdict,  # type: ignore[arg-type]
        statement=_statement(joint, own),
        baseline=plain,
        where=[],
        mechanisms=mechanisms,
        refined=refined,
        rules=[RuleResult(name=r.name, value=r.value, unit=r.unit, origin=r.origin) for r in found.rules],
        holdout=HoldoutResult(spans_s=[], baseline_rmse=squares, refined_rmse={} if after is None else {"u": after}),
        engines={},
        attribution=None,
        robot=_robot(arms, paste, every),
        evidence=[],
        consistent_channels={},
        next_experiment="",
        residual_map=None,
        baseline_model=document,
        refined_model=document,
        model_left_out=[_NO_MODEL.format(name=m.name) for m in mechanisms if m.family != "model"],
        warnings=[*arms.arm.notes, *found.notes],
        settings={**arms.options.settings(), "robot": arms.asked.settings()},
        command=command,
        machine=this_machine(),
        files=files,
    )


def _verdict(joint: JointFriction, own: Sequence[EntryResult]) -> str:
    """By the grade of what takes most off; where nothing is named, by whether more than the torque's noise is left."""
    if own:
        return _VERDICTS.get(max(own, key=lambda one: one.share).grade, "unexplained")
    return "adequate" if joint.remainder is not None and joint.remainder <= EXPLAINED.value else "unexplained"


def _mechanism(one: EntryResult, seconds: float, samples: int) -> MechanismResult:
    return MechanismResult(
        name=one.name,
        family=one.family,
        statement=one.statement,
        parameters=one.parameters,
        grade=one.grade,  # type: ignore[arg-type]
        share=one.share,
        delta_bic=one.evidence - math.log(samples),
        where=Where(time_s=[[0.0, seconds]], regime="throughout", condition="", share=None),
        # what no log can part is as good
        alternatives=[AlternativeResult(name=one.partner, delta_bic=0.0)] if one.partner else [],
    )


def _fit(numbers: Sequence[Quantity], arms: Arms, rms: float | None) -> FitResult:
    f_k, c, offset = numbers
    unit = "kg" if "rad" not in c.unit else "kg m^2"
    inertia = P(value=arms.inertia, stderr=None, unit=unit, why=_GIVEN)
    return FitResult(
        parameters={"inertia": inertia, "c": P.of(c), "f_k": P.of(f_k), "offset": P.of(offset)},
        rmse={} if rms is None else {"u": rms},
        chi2_per_point=None,
    )


def _model(paste: JointPaste, inertia: float) -> Model:
    return Model(inertia, paste.c, 0.0, paste.f_k, restoring=Restoring.NONE)


def _statement(joint: JointFriction, own: Sequence[EntryResult]) -> str:
    """Friction, and what is found beside it, the largest share first."""
    more = [one.statement for one in sorted(own, key=lambda one: -one.share)]
    none = [] if more or joint.left is None else ["Nothing is named beside it."]
    line = stands_for(*(joint.line or (joint.coulomb, joint.viscous)), [effect.name for effect in joint.effects])
    return " ".join((f"The whole arm moves. {joint.statement}", *more, *none)) + line


def _robot(arms: Arms, paste: JointPaste, every: list[EntryResult]) -> RobotResult:
    found = arms.found
    return RobotResult(
        file=str(arms.asked.file.absolute()),
        joint=arms.joint.joint,
        mode="whole-arm",
        reduction=None,
        confounded=[list(pair) for pair in found.confounded],
        paste=PasteResult(mjcf=paste.mjcf, urdf=paste.urdf),
        match=match_results(arms.matches),
        arm=ArmResult(
            joints=[_joint(one) for one in found.joints],
            found=every,
            lowpass_hz=found.lowpass,
            rate_hz=found.rate,
            seconds=found.seconds,
        ),
    )


def _joint(one: JointFriction) -> JointResult:
    before, after = one.held_out or (None, None)
    return JointResult(
        joint=one.joint,
        f_k=P.of(one.coulomb),
        c=P.of(one.viscous),
        offset=P.of(one.offset),
        held_out_before=before,
        held_out_after=after,
        over_noise=one.remainder,
        guard_s=one.guard,
        samples=one.samples,
        statement=one.statement,
    )
