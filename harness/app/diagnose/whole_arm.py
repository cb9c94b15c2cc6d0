"""A joint of an arm that moves as a whole: what its torque says of its friction, and of the model."""

import math
from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from harness.app.diagnose.joint_case import JointCase
from harness.app.diagnose.joint_words import of_curve, stands_for, surely, with_forward_run
from harness.app.shared.leaving import FILES as ALWAYS
from harness.app.shared.leaving import leave, leaving
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.model.model import Model, Restoring
from harness.results.common import Where
from harness.results.diagnosis import DiagnosisResult, FitResult, MechanismResult
from harness.results.robot import ArmResult, EntryResult, JointResult
from harness.robot.paste import JointPaste
from harness.robot.reduction import reduced
from harness.robot.whole_arm.result import Entry, JointFriction, WholeArm
from harness.robot.whole_arm.rules import EXPLAINED
from harness.robot.whole_arm.whole import whole_arm
from harness.show.report.robot import arm_page
from harness.show.report.robot_scene import arm_scene

FILES = {
    "result": ALWAYS["result"],
    "report": ALWAYS["report"],
    "rrd": ALWAYS["rrd"],
    "residual_torque": "residual_torque.csv",
    "log": ALWAYS["log"],
}
_VERDICTS = {"explains": "missing_physics", "main": "main_effect", "one-of": "one_of"}
_GIVEN = "the robot's model gives it, at the middle of the motion"
_NO_MODEL = "no model file holds an arm's joint with more than viscous and Coulomb friction: {name} is in the sentences"


def diagnose_arm(case: JointCase) -> DiagnosisResult:
    """Diagnose a joint of an arm that moves as a whole, and leave result, page, trace and a copy of the model.

    Raises InputError, StoreError.
    """
    arm, log, name, asked = case.arm, case.log, case.joint, case.asked
    with leaving(f"diagnose-{case.name}", case.out) as output:
        case.progress("torque of the whole arm", 1, 4)
        left_out = {one.joint for one in case.compared.matches if one.wrong}
        followed = [name for name in log.effort if name not in left_out] if left_out else None
        found = whole_arm(
            log, arm, joints=followed, payload=asked.payload, sensor=asked.sensor, gain_known=asked.gain is not None
        )
        if name not in [one.joint for one in found.joints]:
            there = ", ".join(one.joint for one in found.joints)
            raise InputError(f"{log.file}: {name}", "no effort of it is logged", f"{there} are accepted")
        joint = found.joint(name)
        if joint.coulomb.value is None:
            those = ", ".join(one.joint for one in found.joints if one.coulomb.value is not None)
            raise InputError(f"{log.file}: {name}", "it does not move to and fro enough", f"a joint that does: {those}")
        case.progress("writing trace and report", 3, 4)
        # the line through friction; nothing that is not surely above none
        f_k, c = (surely(q) for q in joint.line)
        paste = JointPaste(name, f_k, c, float(arm.armature[arm.index(name)]), float(arm.model.opt.timestep))
        files = FILES | case.copied(paste, output.work)
        result = _result(case, found, joint, paste, {kind: output.at(file) for kind, file in files.items()})
        left = {
            one.joint: np.column_stack([getattr(one.left, field.name) for field in fields(one.left)])
            for one in found.joints
            if one.left is not None
        }
        shown, simulated = case.tried(paste, left, joint.offset.value or 0.0)
        result = with_forward_run(result, simulated)
        header = "t,q,v,before,after"
        np.savetxt(output / FILES["residual_torque"], left[name][:, :5], "%.9g", ",", header=header, comments="")
        leave(output, result, arm_page(result, shown), arm_scene(result, shown))
    return result


def _result(
    case: JointCase, found: WholeArm, joint: JointFriction, paste: JointPaste, files: dict[str, str]
) -> DiagnosisResult:
    every = [_entry(effect, "friction") for one in found.joints for effect in one.effects]
    every += [_entry(error, "model") for error in found.model]
    own = sorted((one for one in every if one.joint in (joint.joint, None)), key=lambda one: -one.share)
    middle = {n: float(np.mean(case.log.position[n])) for n in case.arm.joints if n in case.log.position}
    inertia = reduced(case.arm, joint.joint, middle).moved
    before, after = joint.held_out or (None, None)
    squares = [{} if rms is None else {"u": rms} for rms in (before, after)]
    refined = joint.coulomb, joint.viscous, joint.offset
    arms = ArmResult.taken_from(
        found, joints=[_joint(one) for one in found.joints], found=every, lowpass_hz=found.lowpass, rate_hz=found.rate
    )
    return case.result(
        Model(inertia, paste.c, 0.0, paste.f_k, restoring=Restoring.NONE),
        verdict=_verdict(joint, own),
        statement=_statement(joint, own),
        baseline=_fit(joint.base or refined, inertia, squares[0]),
        mechanisms=[_mechanism(one, found.seconds, joint.samples) for one in own],
        refined=_fit(refined, inertia, squares[1]),
        curve=joint.curve,
        rules=found.rules,
        holdout={"spans_s": [], "baseline_rmse": squares[0], "refined_rmse": squares[1]},
        robot=case.robot(paste, mode="whole-arm", reduction=None, confounded=found.confounded, arm=arms),
        model_left_out=[_NO_MODEL.format(name=one.name) for one in own if one.family != "model"],
        warnings=[*case.arm.notes, *found.notes],
        files=files,
    )


def _entry(one: Entry, family: str) -> EntryResult:
    return EntryResult.taken_from(
        one, family=family, partner=one.partner or one.pair, grade=one.grade.value, parameters=dict(one.parameters)
    )


def _verdict(joint: JointFriction, own: Sequence[EntryResult]) -> str:
    """By the grade of what takes most off; where nothing is named, by whether more than the torque's noise is left."""
    if own:
        return _VERDICTS.get(own[0].grade, "unexplained")
    return "adequate" if joint.remainder is not None and joint.remainder <= EXPLAINED.value else "unexplained"


def _mechanism(one: EntryResult, seconds: float, samples: int) -> MechanismResult:
    return MechanismResult.taken_from(
        one,
        delta_bic=one.evidence - math.log(samples),
        where=Where(time_s=[[0.0, seconds]], regime="throughout", condition="", share=None),
        # what no log can part is as good
        alternatives=[{"name": one.partner, "delta_bic": 0.0}] if one.partner else [],
    )


def _fit(numbers: Sequence[Quantity], inertia: float, rmse: dict[str, float]) -> FitResult:
    f_k, c, offset = numbers
    unit = "kg" if "rad" not in c.unit else "kg m^2"
    parameters = {"inertia": Quantity(inertia, None, unit, _GIVEN), "c": c, "f_k": f_k, "offset": offset}
    return FitResult.model_validate({"parameters": parameters, "rmse": rmse, "chi2_per_point": None})


def _statement(joint: JointFriction, own: Sequence[EntryResult]) -> str:
    """Friction, and what is found beside it, the largest share first."""
    more = [one.statement for one in own]
    none = [] if more or joint.left is None else ["Nothing is named beside it."]
    line = stands_for(*joint.line, [effect.name for effect in joint.effects])
    over_speed = [] if joint.curve is None else [of_curve(joint.curve)]
    return " ".join((f"The whole arm moves. {joint.statement}", *over_speed, *more, *none)) + line


def _joint(one: JointFriction) -> JointResult:
    before, after = one.held_out or (None, None)
    return JointResult.taken_from(
        one,
        f_k=one.coulomb,
        c=one.viscous,
        held_out_before=before,
        held_out_after=after,
        over_noise=one.remainder,
        guard_s=one.guard,
    )
