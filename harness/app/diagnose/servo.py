"""A joint under its servo, diagnosed from logs of its goals and positions."""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from harness.app.diagnose.joint_case import without_motion
from harness.app.diagnose.options import DiagnoseOptions, RobotOptions, ServoOptions
from harness.app.shared.leaving import FILES, leave, leaving
from harness.app.shared.progress import SILENT, Progress
from harness.core.arrays import FloatArray
from harness.core.errors import InputError, SimulationError, short_names
from harness.core.quantity import Quantity
from harness.core.robot import JointLog
from harness.diagnosis.grading.likely import Likely, probability, ranked, said, with_unseen
from harness.io.logs.read import read_joint_log
from harness.io.options import ReadOptions
from harness.model.model import Model, Restoring
from harness.results.common import P
from harness.results.diagnosis import DiagnosisResult
from harness.results.robot import PasteResult, RobotResult, ServoResult, SimulatedResult
from harness.robot.arm import Arm, load_arm
from harness.robot.servo.engines import Simulated, in_mujoco, in_pybullet
from harness.robot.servo.fit import ServoFit, floor
from harness.robot.servo.logged import run_of, servo_joint
from harness.robot.servo.paste import ServoPaste, bam, pasted
from harness.robot.servo.plant import Run
from harness.robot.servo.presets import Preset, preset
from harness.robot.servo.search import TERMS, Step, Term
from harness.robot.servo.servo import Servo, identified
from harness.robot.servo.told import confounded, dry_friction, quantities, unit_of, verdicts
from harness.show.report.servo import servo_page

_STEP = 0.002
"""s: of a model that nobody gives."""
_MAIN = 0.8
"""Error of what was held out, after over before, from which on a term is no main one, nor claimed beside another."""
_ENGINES = {"mujoco": in_mujoco, "pybullet": in_pybullet}


@dataclass(frozen=True, slots=True)
class ServoCase:
    """Logs of a joint, and what is known of it."""

    logs: tuple[JointLog, ...]
    joint: str
    runs: tuple[Run, ...]
    preset: Preset | None
    arm: Arm | None
    options: DiagnoseOptions


def read_servo_log(
    path: Path,
    reading: ReadOptions,
    robot: RobotOptions | None,
    joints: Sequence[str] | None,
    angle_unit: str | None = None,
) -> JointLog:
    """A log of joints with what a servo's has beside positions; angle_unit : without a robot. Raises InputError."""
    more: dict[str, Any] = {"angle_unit": angle_unit}
    if robot is not None:
        named = ("angle_unit", "names", "flip", "offset", "calibration", "topic")
        more = {name: getattr(robot, name) for name in named}
    return read_joint_log(
        path,
        columns=reading.columns,
        joints=joints,
        skip_rows=reading.skip_rows,
        rate=reading.rate,
        start=reading.start,
        stop=reading.stop,
        drop_nan=reading.drop_nan,
        **more,
    )


def follows_goals(path: Path, options: DiagnoseOptions) -> bool:
    """Whether a file is a log of joints whose goals are logged and whose torque is not."""
    with suppress(InputError):
        # names of the model's joints do not matter here, and which part of the file it is does
        robot = options.robot and RobotOptions(options.robot.file, topic=options.robot.topic)
        log = read_servo_log(path, options.reading, robot, None)
        return not log.effort and bool(servo_joint(log, None))
    return False


def diagnose_servo(
    named: Sequence[tuple[Path, str]],
    options: DiagnoseOptions,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
) -> DiagnosisResult:
    """Diagnose logs of a joint under its servo, and leave result and page in a folder.

    named : path and label of each. Raises InputError, SimulationError, StoreError.
    """
    progress("reading", 0, 3)
    case = _case(named, options)
    progress("free runs of the servo", 1, 3)
    servo = identified(case.runs, case.preset, case.arm is not None)
    with leaving(f"diagnose-{case.joint}", out) as output:
        progress("engines", 2, 3)
        words, simulated = _engines(case, servo)
        result = _result(case, servo, words, [one for one, _ in simulated], command)
        result = result.model_copy(update={"files": {k: output.at(FILES[k]) for k in ("result", "report", "log")}})
        fits = servo.sayable, servo.best
        shown = [(run.t, run.goal, run.q, _shown(fits[0], run), _shown(fits[1], run)) for run in servo.best.logs.runs]
        engines = [one for _, one in simulated if one is not None]
        curves = {
            log.file: dict(zip(("t", "goal", "x", "x before", "x after"), columns, strict=True))
            for log, columns in zip(case.logs, shown, strict=True)
        }
        leave(output, result, servo_page(result, shown, [(one.engine, one.q) for one in engines]), curves=curves)
    return result


def _case(named: Sequence[tuple[Path, str]], options: DiagnoseOptions) -> ServoCase:
    asked, robot = options.servo or ServoOptions(), options.robot
    arm = None if robot is None else load_arm(robot.file, robot.gravity)
    joints = None if arm is None else arm.joints
    logs = [
        replace(read_servo_log(path, options.reading, robot, joints, asked.angle_unit), file=label)
        for path, label in named
    ]
    try:
        joint = servo_joint(logs[0], None if robot is None else robot.joint)
    except InputError:
        if asked.name is not None or asked.angle_unit is None:
            raise
        whose = "it goes with --robot FILE, or a servo's goals and positions; else a unit is its column's in --columns"
        raise InputError("--angle-unit", "given with neither a robot nor a servo", whose) from None
    for log in logs[1:]:
        servo_joint(log, joint)
    if arm is not None:
        arm.index(joint)
    known = None if asked.name is None else preset(asked.name)
    gains = asked.gains
    if len(gains) not in (0, 1, len(logs)):
        raise InputError("--servo", f"{len(gains)} gains for {len(logs)} logs", "one, or one a log")
    each = gains if len(gains) == len(logs) else (gains or (None,)) * len(logs)
    runs = tuple(run_of(log, joint, known, gain, arm) for log, gain in zip(logs, each, strict=True))
    return ServoCase(tuple(logs), joint, runs, known, arm, options)


def _understood(case: ServoCase) -> list[str]:
    """What was read and taken."""
    log, run = case.logs[0], case.runs[0]
    others = [name for name in log.goal if name != case.joint]
    said = [f"Goal and position of {case.joint}" + (f" ({', '.join(others)} are logged too)" if others else "")]
    said[0] += f": {len(case.runs)} log{'s' * (len(case.runs) > 1)}, {sum(r.t.size for r in case.runs)} samples."
    if case.preset is not None:
        said.append(f"The servo is taken for a {case.preset.name}: {case.preset.source}.")
        gains = ", ".join(f"{gain:g}" for gain in sorted({one.kp for one in case.runs}))
        said.append(
            f"Its own gain is {gains}, its supply {'logged' if case.joint in log.voltage else f'{run.volts[0]:g} V'}."
        )
    if case.arm is None:
        said.append("No model gives inertia and gravity: a pull as sine and cosine of the angle is fitted beside.")
    elif np.ptp(run.load[:, 0]) > 0.0:
        said.append("The other joints move: their weight is followed, what their accelerations do to this one is not.")
    return said


def _engines(case: ServoCase, servo: Servo) -> tuple[ServoPaste | None, list[tuple[SimulatedResult, Simulated | None]]]:
    """What is pasted, and what engines make of it in the first log; nothing without a scale and a model."""
    if servo.known.scale == "inertia":
        return None, []
    run = case.runs[0]
    step = _STEP if case.arm is None else float(case.arm.model.opt.timestep)
    words = pasted(servo.sayable, case.joint, float(np.median(run.volts)), run.kp, step)
    if case.arm is None:
        return words, []
    zero = servo.sayable.values.get("zero", 0.0)
    before = _own_words(case, words)
    found: list[tuple[SimulatedResult, Simulated | None]] = []
    for name in [engine for engine in _ENGINES if engine in case.options.engines]:
        try:
            after = _ENGINES[name](run, words, zero)
            own = {} if before is None else {"x": _rms(_ENGINES[name](run, before, 0.0).q - run.q)}
        except SimulationError as error:
            about = {"engine": name, "windows": 0, "window_s": None, "before": {}, "after": {}, "error": str(error)}
            found.append((SimulatedResult.model_validate(about), None))
            continue
        about = {"engine": name, "version": after.version, "dt_s": after.dt, "windows": 1, "window_s": None}
        rms = {"before": own, "after": {"x": _rms(after.q - run.q)}}
        found.append((SimulatedResult.model_validate(about | rms), after))
    return words, found


def _own_words(case: ServoCase, words: ServoPaste) -> ServoPaste | None:
    """The joint and position actuator that the user's model has; None without one."""
    arm = case.arm
    assert arm is not None
    at, model = arm.index(case.joint), arm.model
    for i in range(model.nu):
        kp = float(model.actuator_gainprm[i, 0])
        if int(model.actuator_trnid[i, 0]) == at and kp > 0.0 and float(model.actuator_biasprm[i, 1]) == -kp:
            c = float(arm.damping[at]) - float(model.actuator_biasprm[i, 2])
            most = float(model.actuator_forcerange[i, 1]) if model.actuator_forcelimited[i] else math.inf
            joint = replace(words.joint, f_k=float(arm.frictionloss[at]), c=c, armature=float(arm.armature[at]))
            return ServoPaste(joint, kp, most, 0.0)
    return None


def _rms(left: FloatArray) -> float:
    return math.sqrt(float(np.mean(left**2)))


def _shown(found: ServoFit, run: Run) -> FloatArray:
    """A free run of a whole log."""
    return run.simulated({**found.logs.known, **found.values}, [(0, run.t.size)])


def _result(
    case: ServoCase, servo: Servo, words: ServoPaste | None, simulated: Sequence[SimulatedResult], command: str
) -> DiagnosisResult:
    found, best, base, scale = servo.found, servo.best, servo.sayable, servo.known.scale
    least, volts, run = floor(case.runs), float(np.median(case.runs[0].volts)), case.runs[0]
    before, after = quantities(base, scale), quantities(best, scale)
    said, lost = bam(best, case.preset, volts) if scale != "inertia" else ({}, [])
    values = {**best.logs.known, **best.values}
    stall = values["stall"] * volts
    torque = unit_of("most", scale)
    error = best.errors.get("stall", math.inf)
    stiff = values["gain"] * run.kp
    total, pull = (
        Quantity(stall * x, error * volts * x, unit)
        if math.isfinite(error)
        else Quantity(stall * x, None, unit, "given")
        for x, unit in ((1.0, torque), (stiff, torque.replace("N m", "N m/rad")))
    )
    names = short_names([one.file for one in case.runs])
    fitted = [
        {"of": names[one.file], "before": 1e3 * _mae(b), "after": 1e3 * _mae(a)}
        for one, b, a in zip(case.runs, base.logs.split(base.residual), best.logs.split(best.residual), strict=True)
    ]
    out = [
        {"of": name, "before": 1e3 * b.mae, "after": 1e3 * a.mae}
        for name, b, a in zip(found.blocks, found.before, found.after, strict=True)
    ]
    own = ServoResult.model_validate(
        {
            "servo": case.preset and case.preset.name,
            "source": "" if case.preset is None else case.preset.source,
            "scale": scale,
            "understood": _understood(case),
            "base": {name: P.of(q) for name, q in before.items()},
            "parameters": {name: P.of(q) for name, q in after.items()},
            "stall": P.of(total),
            "stiffness": P.of(pull),
            "terms": [_term(step, best, scale) for step in found.steps],
            "fitted": fitted,
            "held_out": out,
            "floor_mrad": 1e3 * least,
            "confounded": confounded(servo, case.runs),
            "identifiable": [{"parameter": n, "verdict": v, "why": w} for n, v, w in verdicts(best)],
            "bam": said,
            "not_in_bam": lost,
        }
    )
    clean = best.at_noise
    grades = [_grade(found.steps, i, clean) for i in range(len(found.steps))]
    named = any(grade != "minor" for grade in grades)
    verdict = ("missing_physics" if clean else "main_effect") if named else "adequate" if clean else "unexplained"
    ties = _ties(found.steps) if "one-of" in grades else []
    if ties:
        verdict = "one_of"
    likely = found.likely if named else with_unseen(found.likely)
    span = [[0.0, float(run.t[-1] - run.t[0])]]
    held = [{"x": _mean_square(one)} if one else {} for one in (found.before, found.after)]
    inertia = float(np.mean(run.load[:, 0])) if servo.known.loaded else 0.0
    whole = max(inertia + values["armature"], 1e-9)
    paste = PasteResult(mjcf="", urdf="") if words is None else PasteResult(mjcf=words.mjcf, urdf=words.urdf)
    c = max(values["c"] + values["brake"], 0.0)
    return without_motion(
        case.logs[0],
        case.joint,
        Model(whole, c, 0.0, values["f_k"], restoring=Restoring.NONE),
        settings=case.options.settings(),
        command=command,
        verdict=verdict,
        statement=_how_likely(likely, found.steps, ties) + _statement(own, best, least, grades),
        baseline={"parameters": before, "rmse": {"x": base.rms}, "chi2_per_point": None},
        refined={"parameters": after, "rmse": {"x": best.rms}, "chi2_per_point": None},
        mechanisms=[
            {**one, "probability": probability(likely, one["name"])}
            for one in (
                *(_mechanism(s, best, scale, span, grade) for s, grade in zip(found.steps, grades, strict=True)),
                *(_tied(term, gain, span) for term, gain in ties),
            )
        ],
        posterior=[{"names": h.names, "probability": h.probability} for h in ranked(likely)],
        rules=[],
        holdout={"spans_s": [], "baseline_rmse": held[0], "refined_rmse": held[1]},
        evidence=[{"name": name, "delta_bic": gain} for name, gain in found.tried.items()],
        robot=RobotResult.model_validate(
            {
                "file": "" if case.options.robot is None else str(case.options.robot.file.absolute()),
                "joint": case.joint,
                "mode": "servo",
                "reduction": None,
                "confounded": [],
                "paste": paste,
                "simulated": list(simulated),
                "servo": own,
            }
        ),
        model_left_out=[f"no word of MJCF or URDF: {one.term.said}" for one in found.steps]
        + [f"a delay of goals of {1e3 * values['delay']:.3g} ms: put it into your loop"] * (values["delay"] > 1e-3),
        warnings=[] if case.arm is None else list(case.arm.notes),
        files={},
    )


def _mae(left: FloatArray) -> float:
    return float(np.mean(np.abs(left)))


def _mean_square(parts: Sequence[ServoFit]) -> float:
    return math.sqrt(float(np.mean([one.rms**2 for one in parts])))


def _term(step: Step, best: ServoFit, scale: str) -> Mapping[str, Any]:
    numbers = quantities(best, scale)
    own = step.term.numbers(step.found)
    new = {name: P.of(number) for name, number in numbers.items() if name in own}
    return {
        "name": step.term.name,
        "said": step.term.said,
        "evidence": step.gain,
        "parameters": new,
        "held_out_mrad": [1e3 * x for x in step.held_out if math.isfinite(x)],
        "rivals": dict(step.rivals),
    }


def _ties(steps: Sequence[Step]) -> list[tuple[Term, float]]:
    """Terms that would do in place of the one that is needed most, with their evidence, the best first."""
    if not steps:
        return []
    first, taken = steps[0], {step.term.name for step in steps}
    near = sorted((worse, name) for name, worse in first.rivals.items() if name not in taken)
    return [(next(term for term in TERMS if term.name == name), first.gain - worse) for worse, name in near]


def _how_likely(likely: Likely, steps: Sequence[Step], ties: Sequence[tuple[Term, float]]) -> str:
    """That its terms are missing, or that nothing is; the beginning of the sentence that says what the servo does."""
    if not steps:
        return f"No missing term is shown ({said(likely.get((), 0.0))}): the servo"
    missing = ", ".join(f"{s.term.name} ({said(probability(likely, s.term.name))})" for s in steps)
    tied = f"; not ruled out in place of {steps[0].term.name}: {', '.join(t.name for t, _ in ties)}" if ties else ""
    return f"Missing: {missing}{tied}. The servo"


def _grade(steps: Sequence[Step], place: int, clean: bool) -> str:
    """Of a term by its place, the most needed first; clean : whether all leave no more than the sensor."""
    before, after = steps[place].held_out
    much = not math.isfinite(before) or after < _MAIN * before
    if place == 0 and _ties(steps):
        return "one-of"
    if clean:
        return "explains" if place == 0 or much else "minor"
    return "main" if place == 0 and much else "minor"


def _tied(term: Term, gain: float, span: list[list[float]]) -> Mapping[str, Any]:
    where = {"time_s": span, "regime": "throughout", "condition": "", "share": None}
    said = f"{term.said.capitalize()}: not ruled out."
    about = {"name": term.name, "family": "servo", "statement": said, "parameters": {}, "grade": "one-of"}
    return {**about, "delta_bic": gain, "where": where, "alternatives": []}


def _mechanism(step: Step, best: ServoFit, scale: str, span: list[list[float]], grade: str) -> Mapping[str, Any]:
    told = _term(step, best, scale)
    near = sorted(step.rivals.items(), key=lambda one: one[1])[:3]
    return {
        "name": step.term.name,
        "family": "servo",
        "statement": f"{step.term.said.capitalize()}.",
        "parameters": told["parameters"],
        "grade": grade,
        "delta_bic": step.gain,
        "where": {"time_s": span, "regime": "throughout", "condition": "", "share": None},
        "alternatives": [{"name": name, "delta_bic": worse} for name, worse in near],
    }


def _statement(own: ServoResult, best: ServoFit, least: float, grades: Sequence[str]) -> str:
    """What it does, its friction, what free runs miss; grades : of its terms, of which minor ones are not said."""
    numbers = own.parameters

    def said(name: str) -> str:
        p = numbers[name]
        return str(Quantity(p.value, p.stderr, p.unit, p.why))

    stiff = Quantity(own.stiffness.value, own.stiffness.stderr, own.stiffness.unit, own.stiffness.why)
    late = numbers["delay"]
    old = Quantity(1e3 * best.values["delay"], late.stderr and 1e3 * late.stderr, "ms", late.why)
    text = f" pulls with {stiff} towards goals {old} old; damping "
    if "brake" in best.values and "c" in best.values:
        text += f"{said('c')} and {said('brake')} while it drives"
    else:
        one = numbers["c" if "c" in best.values else "brake"]
        both = sum(numbers[name].value or 0.0 for name in ("brake", "c"))
        text += str(Quantity(both, one.stderr, one.unit, one.why))
    text += f", dry friction {said('f_k')}"
    for more in dry_friction(best.values):
        text += f" and {more}"
    graded = zip(own.terms, grades, strict=True)
    others = [term.said for term, grade in graded if "friction" not in term.said and grade != "minor"]
    text += f"; besides, {' and '.join(others)}." if others else "."
    before, after = (float(np.mean([getattr(one, side) for one in own.fitted])) for side in ("before", "after"))
    text += f" Free runs miss the positions by {after:.3g} mrad in the mean"
    text += f" ({before:.3g} by torque, damping and Coulomb friction alone" if own.terms else " ("
    text += f"{'; ' if own.terms else ''}noise and steps of the sensor: {1e3 * least:.2g} mrad rms)."
    if own.scale == "inertia":
        text += " Torques are ratios to all the inertia that turns: neither gravity nor a data sheet gives their scale."
    return text
