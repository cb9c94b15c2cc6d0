"""One joint of a robot, diagnosed from a log of its joints: the others stand still, and its own equation is known."""

import logging
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np

from harness.app.diagnose.joint_case import ALL, JointCase, unfitted
from harness.app.diagnose.joint_words import breaking, doubted, losses, named, with_forward_run
from harness.app.diagnose.one import deliver
from harness.app.diagnose.options import DiagnoseOptions, RobotOptions, Zero
from harness.app.diagnose.result import STEPS, Diagnosed
from harness.app.diagnose.servo import diagnose_servo
from harness.app.diagnose.whole_arm import diagnose_arm
from harness.app.shared.progress import SILENT, Progress
from harness.core.arrays import FloatArray
from harness.core.errors import TRY, InputError, SimulationError
from harness.core.robot import JointLog
from harness.diagnosis.kinds.known import kind_of
from harness.engines.friction_file import friction_file
from harness.engines.model_files import FRICTION
from harness.io.logs.read import read_joint_log
from harness.io.logs.tables import NO_POSITION
from harness.io.options import ReadOptions
from harness.io.recording import read_recording
from harness.io.units import parse_unit
from harness.model.model import Restoring
from harness.results.diagnosis import DiagnosisResult
from harness.robot.arm import Arm, load_arm
from harness.robot.match.compared import Compared, compare
from harness.robot.recording import Coupling, OneJoint, coupling, one_joint, slips
from harness.robot.smooth import moving
from harness.robot.whole_arm.differentiate import long_enough

LOGGER = logging.getLogger(__name__)


def diagnose_joint(
    path: Path,
    asked: RobotOptions,
    options: DiagnoseOptions,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
    label: str | None = None,
) -> DiagnosisResult:
    """Diagnose a joint of a log, and leave what ``diagnose`` leaves, with a copy of the robot's model.

    Raises InputError, SimulationError, StoreError.
    """
    progress("reading", 0, STEPS)
    arm = load_arm(asked.file, asked.gravity)
    gains = _gains(asked, arm.joints)
    log = _read(path, arm.joints, asked, gains, options.reading)
    log = log if label is None else replace(log, file=label)
    if log.goal and not log.effort:
        return diagnose_servo([(path, log.file)], options, out, progress, command)
    log, guessed = _with_currents(path, arm, log, asked, options.reading)
    joint, every = _joint(arm, log, asked)
    if not every:
        _check_kind(arm, log, joint)
    found = coupling(arm, log, joint)
    if found.moving and joint not in log.effort:
        said = f"no effort of it is logged, and {', '.join(found.moving)} move{'s' * (len(found.moving) == 1)} too"
        accepted = "a log with its effort, or one in which the others stand still"
        raise InputError(f"{log.file}: {joint}", said, accepted)
    one = None
    if found.mode == "whole-arm" or (every and log.effort):
        long_enough(log)
    else:
        for name, value in (("--payload", asked.payload), ("--sensor", asked.sensor)):
            if value is not None:
                raise InputError(
                    name, "given, but one joint alone moves", "it goes with logs in which the whole arm moves"
                )
        one = one_joint(log, found.reduced)
    compared = _compared(arm, log, gains, guessed)
    case = JointCase(arm, log, joint, compared, asked, options, out, progress, command)
    if not case.compared.fits(joint) and not (every and any(map(case.compared.fits, log.effort))):
        return unfitted(case, found)
    if every and one is None:
        case = replace(case, joint=ALL)
    if one is None:
        return diagnose_arm(case)
    # what the model says of the joint, in the terms of any recording
    restoring = Restoring(one.restoring)
    zero: Zero | None = None if restoring is Restoring.NONE else "free"
    plain = replace(options, robot=None, mass=one.inertia, restoring=restoring, zero=zero, guarded=True)
    try:
        return deliver(one.recording, plain, out, case.name, progress, command, _finish(case, found, one))
    except (InputError, SimulationError):
        # what slides too shortly to be fitted may break away clearly all the same
        slipping = slips(log, found.reduced)
        broken = None if slipping is None else breaking(slipping, None)
        if broken is None:
            raise
        return unfitted(case, found, broken)


def _gains(asked: RobotOptions, joints: Sequence[str]) -> dict[str, float]:
    """What the log's torque is multiplied by, by joint."""
    gain = asked.gain
    if isinstance(gain, tuple):
        if len(gain) != len(joints):
            found = f"{len(gain)} numbers, and the model has {len(joints)} joints"
            raise InputError("--gain", found, f"one each of {', '.join(joints)}, or NAME=NUMBER for each")
        return dict(zip(joints, gain, strict=True))
    return {} if gain is None else dict(gain) if isinstance(gain, Mapping) else dict.fromkeys(joints, gain)


_FIELD = {"x": "position", "v": "velocity", "u": "effort"}


def _read(
    path: Path, joints: Sequence[str], asked: RobotOptions, gains: Mapping[str, float], reading: ReadOptions
) -> JointLog:
    """Read a log; joints : those of the model, in its order. Raises InputError naming what is wrong, and where; with
    columns to paste, where one joint is meant and the table reads as one motion.
    """
    try:
        return _as_asked(path, joints, asked, gains, reading)
    except InputError as error:
        joint = asked.joint if asked.joint in joints else joints[0] if len(joints) == 1 else None
        if reading.columns is not None or joint is None or NO_POSITION not in error.found:
            raise
        with suppress(InputError):
            found = read_recording(path, reading).columns
            named = {"t": "t"} | {channel: f"{joint}.{field}" for channel, field in _FIELD.items()}
            text = ",".join(f"{named[c]}={product}" for c, product in found.items() if c in named)
            _as_asked(path, joints, asked, gains, replace(reading, columns=text))
            error = InputError(error.where, error.found, f'{TRY}--columns "{text}"')
        raise error from None


def _as_asked(
    path: Path, joints: Sequence[str], asked: RobotOptions, gains: Mapping[str, float], reading: ReadOptions
) -> JointLog:
    return read_joint_log(
        path,
        columns=reading.columns,
        joints=joints,
        gain=gains if isinstance(asked.gain, tuple) else asked.gain,
        angle_unit=asked.angle_unit,
        names=asked.names,
        flip=asked.flip,
        offset=asked.offset,
        join=asked.join,
        calibration=asked.calibration,
        topic=asked.topic,
        skip_rows=reading.skip_rows,
        rate=reading.rate,
        start=reading.start,
        stop=reading.stop,
        drop_nan=reading.drop_nan,
    )


def _with_currents(
    path: Path, arm: Arm, log: JointLog, asked: RobotOptions, reading: ReadOptions
) -> tuple[JointLog, bool]:
    """A log of a whole arm with its currents in place of efforts that it has not, and whether it is that: the model's
    torque tells their gains."""
    if not log.effort and asked.gain is None and len(moving(arm, log)) > 1:
        with suppress(InputError):
            return _as_asked(path, arm.joints, replace(asked, gain=1.0), {}, reading), True
    return log, False


def _compared(arm: Arm, log: JointLog, gains: Mapping[str, float], guessed: bool) -> Compared:
    """The log against its model; guessed : its torques are currents. Raises InputError where gains of these are not
    told."""
    compared = compare(arm, log, gains)
    if guessed and "--gain" not in compared.option:
        raise InputError(log.file, "currents, and no efforts", "--gain, in N m per A at the joint: one, or one a joint")
    return compared


def _joint(arm: Arm, log: JointLog, asked: RobotOptions) -> tuple[str, bool]:
    """The joint that was asked for, or the first that moves, and whether all are meant."""
    if asked.joint is not None and (asked.joint != ALL or ALL in arm.joints):
        return asked.joint, False
    those = moving(arm, log)
    told = [name for name in those if name in log.effort] or those
    if not those:
        raise InputError("--joint", "not given, and none of the joints moves", f"one of {', '.join(arm.joints)}")
    if len(those) > 1 and not log.effort:
        accepted = "efforts, as columns NAME.effort or by --columns, or a log in which one joint moves alone"
        raise InputError(log.file, f"no joint's effort is logged, and {', '.join(those)} move", accepted)
    return told[0], len(those) > 1


def _check_kind(arm: Arm, log: JointLog, joint: str) -> None:
    """Raise InputError for a length of what turns, or an angle of what slides."""
    angle = bool(log.unit) and parse_unit(log.file, "x", log.unit).angular
    if log.unit and angle == arm.slides(joint):
        if angle:
            moves, way = "slides", f"a length; by a pulley of 20 mm: {joint}.position=COLUMN*0.02[m]"
        else:
            moves, way = "turns", f"an angle; of a place 0.4 m from its axis: {joint}.position=COLUMN*2.5[rad]"
        raise InputError(f"{log.file}: {joint}", f"positions in {log.unit}, and it {moves}", f"{way} in --columns")


def _finish(
    case: JointCase, found: Coupling, one: OneJoint
) -> Callable[[Diagnosed, Path], tuple[Diagnosed, dict[str, str]]]:
    """What is said of the joint besides, and the copy of the model, once it is diagnosed."""

    def finish(done: Diagnosed, folder: Path) -> tuple[Diagnosed, dict[str, str]]:
        result, paste, sliding = named(done, case, found, one)
        shown, simulated = case.tried([paste], {case.joint: _left(done, one)}, [0.0])
        effort = case.log.effort
        torque = float(np.std(effort[case.joint])) if case.joint in effort else 0.0
        result = doubted(result, done.result.statement, slips(case.log, found.reduced), sliding, simulated, torque)
        result = with_forward_run(result, simulated)
        result = result.model_copy(update={"settings": {**result.settings, "robot": case.asked.settings()}})
        files = case.copied(
            [paste], folder, lambda name: f"robot_{name}" if (folder / "model" / name).exists() else name
        )
        law = done.outcome.refined.model
        text = friction_file(law, case.joint, one.rest + law.offset)
        (folder / "model" / FRICTION).write_text(text, encoding="utf-8")
        if not files:
            LOGGER.warning("%s: no element of its own has the joint %s", case.asked.file, case.joint)
        return replace(done, result=result, shown=shown), files

    return finish


def _left(done: Diagnosed, one: OneJoint) -> FloatArray:
    """Columns (m, 7) as a page and a trace have them, by nothing at rest: t, q, v, torque left by the base and by the
    refined model, and friction as each of them has it."""
    outcome = done.outcome
    before = done.left
    after = kind_of(outcome.problem).left_over(outcome.problem, outcome.refined, outcome.scales)
    torque = np.interp(before.t, after.t, after.force) * outcome.refined.model.m
    base = outcome.base.model
    rest, v = before.force * base.m, before.at_v
    t, _, lost = losses(outcome)
    raw = rest + base.c * v + base.f_k * np.sign(v)
    friction = np.interp(before.t, t, lost) if t.size else raw
    rows = np.column_stack((before.t, before.at_x + one.rest, v, rest, torque, raw, friction))
    return np.asarray(rows[np.all(np.isfinite(rows), axis=1)])
