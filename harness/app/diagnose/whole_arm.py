"""A joint of an arm that moves as a whole: what its torque says of its friction, and of the model."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from harness.app.diagnose.joint_case import ALL, JointCase
from harness.app.diagnose.joint_words import of_curve, stands_for, surely, with_forward_run
from harness.app.shared.leaving import FILES as ALWAYS
from harness.app.shared.leaving import leave, leaving
from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.quantity import Quantity
from harness.diagnosis.grading.likely import Likely, probability, ranked, said, with_unseen
from harness.model.model import Model, Restoring
from harness.results.common import Where
from harness.results.diagnosis import DiagnosisResult, FitResult, MechanismResult
from harness.results.robot import ArmResult, EntryResult, JointResult
from harness.robot.paste import JointPaste
from harness.robot.reduction import reduced
from harness.robot.whole_arm.result import Entry, JointFriction, WholeArm, with_joint
from harness.robot.whole_arm.rules import EXPLAINED
from harness.robot.whole_arm.whole import whole_arm
from harness.show.report.robot import arm_page
from harness.show.report.scenes import arm_scene

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
    """Diagnose a joint of an arm that moves as a whole, or all, and leave result, page, trace and a copy of the model.

    Raises InputError, StoreError.
    """
    arm, log, asked = case.arm, case.log, case.asked
    with leaving(f"diagnose-{case.name}", case.out) as output:
        case.progress("torque of the whole arm", 1, 4)
        left_out = {one.joint for one in case.compared.matches if one.wrong}
        followed = [name for name in log.effort if name not in left_out] if left_out else None
        found = whole_arm(
            log, arm, joints=followed, payload=asked.payload, sensor=asked.sensor, gain_known=asked.gain is not None
        )
        told = _told(case, found)
        case.progress("writing trace and report", 3, 4)
        # the line through friction; nothing that is not surely above none
        step = float(arm.model.opt.timestep)
        pastes = [
            JointPaste(
                one.joint, surely(one.line[0]), surely(one.line[1]), float(arm.armature[arm.index(one.joint)]), step
            )
            for one in told
        ]
        files = FILES | case.copied(pastes, output.work)
        names = {kind: output.at(file) for kind, file in files.items()}
        result = (_of_all if case.joint == ALL else _of_one)(case, found, told, pastes, names)
        left = {
            one.joint: np.column_stack([getattr(one.left, field.name) for field in fields(one.left)])
            for one in found.joints
            if one.left is not None
        }
        shown, simulated = case.tried(pastes, left, [one.offset.value or 0.0 for one in told])
        result = with_forward_run(result, simulated)
        _write_left(output / FILES["residual_torque"], {one.joint: left[one.joint][:, :5] for one in told})
        columns = ("t", "q", "v", "before", "after")
        curves = {name: dict(zip(columns, own.T, strict=False)) for name, own in left.items()}
        leave(output, result, arm_page(result, shown), arm_scene(result, shown), curves)
    return result


def _write_left(path: Path, left: Mapping[str, FloatArray]) -> None:
    """Torque left of one joint, or of several with their number behind."""
    header = "t,q,v,before,after"
    rows = list(left.values())
    if len(rows) > 1:
        header = f"{header},joint"
        rows = [np.column_stack((own, np.full(len(own), float(j + 1)))) for j, own in enumerate(rows)]
    np.savetxt(path, np.vstack(rows), "%.9g", ",", header=header, comments="")


def _told(case: JointCase, found: WholeArm) -> list[JointFriction]:
    """The joint that was asked for, or all that move. Raises InputError where there is none."""
    known = [one for one in found.joints if one.coulomb.value is not None]
    if case.joint == ALL:
        return known
    where = f"{case.log.file}: {case.joint}"
    if case.joint not in [one.joint for one in found.joints]:
        raise InputError(where, "no effort of it is logged", f"{', '.join(o.joint for o in found.joints)}")
    if case.joint not in [one.joint for one in known]:
        plan = f"try: harness plan --robot {shlex.quote(case.arm.file)}"
        those = f"try: --joint {known[0].joint}" if known else plan
        raise InputError(where, "it does not move to and fro enough", those)
    return [found.joint(case.joint)]


def _arms(found: WholeArm) -> ArmResult:
    every = [_entry(effect, "friction", found.likely) for one in found.joints for effect in one.effects]
    every += [_entry(error, "model", found.likely) for error in found.model]
    joints = [_joint(one) for one in found.joints]
    return ArmResult.taken_from(found, joints=joints, found=every, lowpass_hz=found.lowpass, rate_hz=found.rate)


def _of_one(
    case: JointCase, found: WholeArm, told: Sequence[JointFriction], pastes: Sequence[JointPaste], files: dict[str, str]
) -> DiagnosisResult:
    (joint,), (paste,), arms = told, pastes, _arms(found)
    own = sorted((one for one in arms.found if one.joint in (joint.joint, None)), key=lambda one: -one.share)
    inertia = _inertia(case, joint.joint)
    squares = [{} if rms is None else {"u": rms} for rms in joint.held_out or (None, None)]
    refined = joint.coulomb, joint.viscous, joint.offset
    more = _about(case, found, own)
    return case.result(
        Model(inertia, paste.c, 0.0, paste.f_k, restoring=Restoring.NONE),
        verdict=_verdict([joint], own),
        statement=f"The whole arm moves. {_statement(joint, own)}{_how_likely(found, own)}",
        baseline=_fit(_numbers(joint.base or refined, inertia), squares[0]),
        refined=_fit(_numbers(refined, inertia), squares[1]),
        curve=joint.curve,
        holdout={"spans_s": [], "baseline_rmse": squares[0], "refined_rmse": squares[1]},
        robot=case.robot(
            paste,
            mode="whole-arm",
            reduction=None,
            confounded=found.confounded,
            identifiable=found.identifiable,
            arm=arms,
        ),
        files=files,
        **more,
    )


def _of_all(
    case: JointCase, found: WholeArm, told: Sequence[JointFriction], pastes: Sequence[JointPaste], files: dict[str, str]
) -> DiagnosisResult:
    """Of every joint; parameters have the joint's name before theirs."""
    arms, inertias = _arms(found), {one.joint: _inertia(case, one.joint) for one in told}
    own = sorted(arms.found, key=lambda one: -one.share)
    of_arm = [one for one in own if one.joint is None]
    each = [_in_short(one, [e for e in own if e.joint == one.joint]) for one in told]
    more, lead = _about(case, found, own), pastes[0]

    def fit(base: bool) -> FitResult:
        numbers: dict[str, Quantity] = {}
        for one in told:
            refined = one.coulomb, one.viscous, one.offset
            mine = _numbers((one.base or refined) if base else refined, inertias[one.joint])
            numbers |= {f"{one.joint}.{name}": value for name, value in mine.items()}
        return _fit(numbers, {})

    return case.result(
        Model(inertias[lead.joint], lead.c, 0.0, lead.f_k, restoring=Restoring.NONE),
        verdict=_verdict(told, own),
        statement=" ".join(("The whole arm moves.", *each, *(one.statement for one in of_arm)))
        + _how_likely(found, own),
        baseline=fit(base=True),
        refined=fit(base=False),
        holdout={"spans_s": [], "baseline_rmse": {}, "refined_rmse": {}},
        robot=case.robot(
            *pastes,
            mode="whole-arm",
            reduction=None,
            confounded=found.confounded,
            identifiable=found.identifiable,
            arm=arms,
        ),
        files=files,
        **more,
    )


def _inertia(case: JointCase, joint: str) -> float:
    """About a joint's axis at the middle of the motion."""
    middle = {n: float(np.mean(case.log.position[n])) for n in case.arm.joints if n in case.log.position}
    return reduced(case.arm, joint, middle).moved


def _about(case: JointCase, found: WholeArm, own: Sequence[EntryResult]) -> dict[str, Any]:
    """What results of one and of all say alike."""
    likely = found.likely if found.entries else with_unseen(found.likely)
    return {
        "mechanisms": [_mechanism(one, found.seconds) for one in own],
        "posterior": [{"names": h.names, "probability": h.probability} for h in ranked(likely)],
        "rules": found.rules,
        "model_left_out": [_NO_MODEL.format(name=one.name) for one in own if one.family != "model"],
        "warnings": [*case.arm.notes, *found.notes],
    }


def _entry(one: Entry, family: str, likely: Likely) -> EntryResult:
    return EntryResult.taken_from(
        one,
        family=family,
        partner=one.partner or one.pair,
        grade=one.grade.value,
        parameters=dict(one.parameters),
        probability=probability(likely, one.label),
    )


def _verdict(told: Sequence[JointFriction], own: Sequence[EntryResult]) -> str:
    """By the grade of what takes most off; where that takes little, by whether more than the torque's noise is left, of
    which the base alone leaves more where anything is named.
    """
    if own and own[0].grade in _VERDICTS:
        return _VERDICTS[own[0].grade]
    quiet = all(one.remainder is not None and one.remainder <= EXPLAINED.value for one in told)
    return "unexplained" if not quiet else "missing_physics" if own else "adequate"


def _mechanism(one: EntryResult, seconds: float) -> MechanismResult:
    return MechanismResult.taken_from(
        one,
        delta_bic=one.bic,
        where=Where(time_s=[[0.0, seconds]], regime="throughout", condition="", share=None),
        # what no log can part is as good
        alternatives=[{"name": one.partner, "delta_bic": 0.0}] if one.partner else [],
    )


def _numbers(found: Sequence[Quantity], inertia: float) -> dict[str, Quantity]:
    f_k, c, offset = found
    unit = "kg" if "rad" not in c.unit else "kg m^2"
    return {"inertia": Quantity(inertia, None, unit, _GIVEN), "c": c, "f_k": f_k, "offset": offset}


def _fit(parameters: Mapping[str, Quantity], rmse: dict[str, float]) -> FitResult:
    return FitResult.model_validate({"parameters": parameters, "rmse": rmse, "chi2_per_point": None})


def _how_likely(found: WholeArm, own: Sequence[EntryResult]) -> str:
    """That what is named is missing, or that nothing is in all of the arm."""
    if own:
        labels = (with_joint(one.name, one.joint) for one in own)
        return f" Missing: {', '.join(f'{label} ({said(probability(found.likely, label))})' for label in labels)}."
    if found.entries:
        return " No other effect of it is found."
    return f" No other effect is found in all of the arm ({said(with_unseen(found.likely).get((), 0.0))})."


def _in_short(joint: JointFriction, own: Sequence[EntryResult]) -> str:
    """The same where every joint has a sentence, and a table the numbers."""
    curved = joint.curve
    friction = f"friction is {joint.line[0]} and {joint.line[1]}." if curved is None else of_curve(curved)
    return " ".join((f"{joint.joint}: {friction[:1].lower()}{friction[1:]}", *(one.statement for one in own)))


def _statement(joint: JointFriction, own: Sequence[EntryResult]) -> str:
    """Friction, and what is found beside it, the largest share first."""
    more = [one.statement for one in own]
    line = stands_for(*joint.line, [effect.name for effect in joint.effects])
    over_speed = [] if joint.curve is None else [of_curve(joint.curve)]
    return " ".join((joint.statement, *over_speed, *more)) + line


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
