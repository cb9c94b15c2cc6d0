"""What the command does, for programs: load, identify, compare, diagnose, simulate, run, log; with its results.

``import harness`` gives the same names. A recording is a ``Recording`` or the path of one, which is read as ``load``
reads it without options; nothing is written unless ``out`` names a folder.
"""

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.robot import JointLog
from harness.core.trajectory import Trajectory
from harness.model.model import Model, ModelTerm
from harness.model.registry import TERMS
from harness.model.term import Slot, Term
from harness.results.common import ModelDocument, MotionResult
from harness.results.compare import ChangeResult, CompareResult, ModelsResult
from harness.results.diagnosis import DiagnosisResult
from harness.results.identify import IdentifyResult, RepeatedIdentifyResult
from harness.results.plan import PlanResult
from harness.results.prove import ProofCheck, ProofResult
from harness.results.robot import LogResult
from harness.results.run import JointRunResult, RunResult
from harness.results.scene import SceneResult
from harness.results.sweep import DiffResult, RegressResult, SweepResult, TuneResult
from harness.results.words import WordsResult
from harness.suites import File, diff, kept, prove, regress, run, run_joint, run_scene, sweep, tune, verify_proof, words

__all__ = [
    "TERMS",
    "CompareResult",
    "DiagnosisResult",
    "DiffResult",
    "IdentifyResult",
    "JointLog",
    "JointRunResult",
    "LogResult",
    "Model",
    "ModelDocument",
    "ModelTerm",
    "ModelsResult",
    "MotionResult",
    "PlanResult",
    "ProofCheck",
    "ProofResult",
    "Recording",
    "RegressResult",
    "RepeatedIdentifyResult",
    "RunResult",
    "SceneResult",
    "Slot",
    "SweepResult",
    "Term",
    "Trajectory",
    "TuneResult",
    "WordsResult",
    "change",
    "compare",
    "compare_models",
    "diagnose",
    "diagnose_joint",
    "diagnose_servo",
    "diff",
    "identify",
    "load",
    "load_log",
    "log",
    "motion",
    "plan",
    "prove",
    "regress",
    "run",
    "run_joint",
    "run_scene",
    "simulate",
    "sweep",
    "tune",
    "verify_proof",
    "words",
]

GivenModel: TypeAlias = Model | ModelDocument | Mapping[str, Any] | File


def load(
    path: File,
    *,
    columns: str | None = None,
    skip_rows: int = 0,
    rate: float | None = None,
    start: float | None = None,
    stop: float | None = None,
    drop_nan: bool = False,
    run: int | None = None,
    trace: str | None = None,
) -> Recording:
    """Read a recording of any accepted format, in SI units.

    columns : as --columns, "t=t,x=qm[mm]". skip_rows : lines before the header. rate : Hz, where no column gives the
    time. start, stop : s, the part to keep. drop_nan : skip rows in which a channel has no value. run : which of a
    file that holds several. trace : which one of a .rrd. Raises InputError naming what is wrong, and where.
    """
    from harness.app.shared.reading import ReadOptions, read

    return read(Path(path), ReadOptions(columns, skip_rows, rate, start, stop, drop_nan, run=run), trace)


# a str is also a sequence of them: it is one file
@overload
def identify(  # type: ignore[overload-overlap]
    recording: Recording | File, *, restoring: Literal["spring", "pendulum"] = "spring", out: File | None = None
) -> IdentifyResult: ...


@overload
def identify(
    recording: Sequence[Recording | File],
    *,
    restoring: Literal["spring", "pendulum"] = "spring",
    conditions: File | Mapping[str, Mapping[str, float]] | None = None,
    out: File | None = None,
) -> RepeatedIdentifyResult: ...


def identify(
    recording: Recording | File | Sequence[Recording | File],
    *,
    restoring: Literal["spring", "pendulum"] = "spring",
    conditions: File | Mapping[str, Mapping[str, float]] | None = None,
    out: File | None = None,
) -> IdentifyResult | RepeatedIdentifyResult:
    """The estimators on a recording of a free decay: omega_n (rad/s), zeta, x_k (m), with standard errors.

    recording : several are of one machine: each by itself, and what all say (``result.together``). restoring : what
    pulls back; a pendulum is read as the spring that it would be. conditions : of several, as ``diagnose`` takes them.
    out : folder for result, report and trace, as the command leaves them. Raises InputError with the reason when the
    recording cannot be read, is driven, or shows no free decay; StoreError when ``out`` cannot be written.
    """
    from harness.app import identify as room

    known = _conditions(conditions, recording)
    if isinstance(recording, Recording | str | PathLike):
        found = _recording(recording)
        if out is None:
            return room.result_of(found, restoring=restoring)[0]
        return room.deliver(found, Path(out), restoring=restoring)
    from harness.app import identify_together as several

    given = [_recording(one) for one in recording]
    if out is None:
        return several.result_of_together(given, restoring=restoring, conditions=known)[0]
    return several.deliver_together(given, Path(out), restoring=restoring, conditions=known)


def motion(recording: Recording | File, *, restoring: str | None = None) -> MotionResult:
    """What kind of motion a recording holds, before any fit: a free decay, a run-down, driven, steps, at rest, ...

    restoring : what pulls it back (spring, pendulum, none), where that is known. Raises InputError when it cannot be
    read.
    """
    from harness.app.log import motion

    return motion(_recording(recording), restoring)


def compare(
    sim: Recording | File, real: Recording | File, *, shift: float | None = None, out: File | None = None
) -> CompareResult:
    """Two traces of any origin: where they differ, and how, before any model is fitted.

    shift : s, added to the times of ``sim``; None to find it, 0 for one clock. out : folder for result, report and
    trace, as the command leaves them. Raises InputError when one cannot be read or the two have nothing in common,
    StoreError when ``out`` cannot be written.
    """
    from harness.app.compare import deliver, result_of

    traces = _recording(sim), _recording(real)
    return result_of(*traces, shift=shift)[0] if out is None else deliver(*traces, Path(out), shift=shift)


def diagnose(
    recording: Recording | File | Sequence[Recording | File],
    *,
    model: GivenModel | None = None,
    sim: Recording | File | None = None,
    validate: Recording | File | None = None,
    mass: float | None = None,
    horizon: float | None = None,
    restoring: str | None = None,
    zero: str | None = None,
    engines: Sequence[str] | None = None,
    preset: str | None = None,
    dt: float | None = None,
    covariates: Sequence[str] | None = None,
    budget: float | None = None,
    conditions: File | Mapping[str, Mapping[str, float]] | None = None,
    out: File | None = None,
) -> DiagnosisResult:
    """Find which physics viscous and Coulomb friction miss in a recording, and the model that has it.

    recording : several of one machine are diagnosed together, as --together does: one set of physics, and of each a
    start, a zero and a noise (``result.own``). model : the simulation as you have it. sim : a trace of it. validate :
    another recording, on which both models are
    tried. mass : kg. horizon : s, windows of a driven recording. restoring : "spring", "pendulum" or "none". zero :
    "spring" or "free"; both are chosen at the base fit where nobody says. engines : in which the fit is shown; () for
    none, None for MuJoCo and PyBullet. preset : "as-shipped" or "tuned". dt : their step, s. covariates : columns of a
    driven recording that act too, "P" or "P:force", ":friction", ":damping". budget : s of a usual processor that
    trying laws may cost, counted in work; then the best so far is given (``result.bounded``). conditions : of several,
    numbers by name for each file's name, or a CSV that has them; each parameter's trend over them is then told
    (``result.together``). out : folder for report,
    trace and models, as the command leaves them.

    Raises InputError for a recording or an option that cannot be used, SimulationError when no model could be
    simulated, StoreError when ``out`` cannot be written.
    """
    from harness.app.diagnose.one import answer, deliver
    from harness.app.diagnose.options import DiagnoseOptions
    from harness.app.run.case import model_of
    from harness.app.shared.reading import ReadOptions

    options = DiagnoseOptions.chosen(
        ReadOptions(),
        restoring,
        zero,
        engines,
        preset,
        model=Path(model) if isinstance(model, str | PathLike) else None if model is None else model_of(model),
        sim=None if sim is None else _recording(sim),
        validate=None
        if validate is None
        else _recording(validate, tuple(c.partition(":")[0] for c in covariates or ())),
        mass=mass,
        horizon=horizon,
        dt=dt,
        covariates=covariates or (),
        budget=budget,
        conditions=_conditions(conditions, recording),
    )
    if not isinstance(recording, Recording | str | PathLike):
        several = [_recording(one) for one in recording]
        return answer(several, options) if out is None else deliver(several, options, Path(out), "together")
    found = _recording(recording, options.reading.covariates)
    return answer(found, options) if out is None else deliver(found, options, Path(out))


def change(
    before: Sequence[Recording | File],
    after: Sequence[Recording | File],
    *,
    mass: float | None = None,
    restoring: str | None = None,
    zero: str | None = None,
    covariates: Sequence[str] | None = None,
    budget: float | None = None,
    out: File | None = None,
) -> ChangeResult:
    """What changed of a machine between two conditions, by how much, and what did not.

    before, after : recordings of each, one or more; repeats say by how much the machine differs from itself. What a
    model of viscous and dry friction misses in either is named first and then read in both. Other arguments as
    ``diagnose`` has them. out : folder for result and report, as the command leaves them.

    Raises InputError for recordings that are not of one machine or an option that cannot be used, SimulationError when
    no model could be simulated, StoreError when ``out`` cannot be written.
    """
    from harness.app.diagnose.change import deliver, result_of
    from harness.app.diagnose.options import DiagnoseOptions
    from harness.app.shared.reading import ReadOptions

    options = DiagnoseOptions.chosen(
        ReadOptions(), restoring, zero, (), covariates=covariates or (), mass=mass, budget=budget
    )
    earlier, later = ([_recording(one, options.reading.covariates) for one in group] for group in (before, after))
    return result_of(earlier, later, options) if out is None else deliver(earlier, later, options, Path(out))


def compare_models(
    recording: Recording | File,
    models: Mapping[str, Sequence[str]],
    *,
    mass: float | None = None,
    horizon: float | None = None,
    restoring: str | None = None,
    zero: str | None = None,
) -> ModelsResult:
    """Models of your choice fitted to one recording and ranked: chi-square, BIC, weight, a row each.

    models : by name, the terms of the catalogue beside viscous and Coulomb friction: {"base": [], "drag":
    ["quadratic-drag"]}. The rest as in ``diagnose``. Raises InputError for a term that there is not and for a recording
    that cannot be used, SimulationError.
    """
    from harness.app.diagnose.models import compare_models as computed
    from harness.app.diagnose.options import DiagnoseOptions
    from harness.app.shared.reading import ReadOptions

    options = DiagnoseOptions.chosen(ReadOptions(), restoring, zero, (), mass=mass, horizon=horizon)
    return computed(_recording(recording), models, options)


def simulate(model: GivenModel, t: ArrayLike) -> Trajectory:
    """The motion of a model in the compiled reference.

    model : a ``Model``, one as a result holds it (``result.refined_model``), its plain data, or a model.json. t : (n,),
    s, increasing; before its release a model is held where that begins. Raises InputError for what is no model, and for
    times before the beginning of one that moves there already, SimulationError when it cannot be followed.
    """
    from harness.app.run.case import motion_of

    return motion_of(model, np.asarray(t, dtype=np.float64))


def diagnose_joint(
    log: File,
    robot: File,
    joint: str | None = None,
    *,
    gain: float | Sequence[float] | Mapping[str, float] | None = None,
    gravity: tuple[float, float, float] | None = None,
    payload: float | None = None,
    sensor: str | None = None,
    names: Mapping[str, str] | None = None,
    flip: Sequence[str] = (),
    offset: Mapping[str, float] | None = None,
    angle_unit: str | None = None,
    join: Sequence[File] = (),
    calibration: File | None = None,
    topic: str | None = None,
    rate: float | None = None,
    engines: Sequence[str] | None = None,
    out: File | None = None,
) -> DiagnosisResult:
    """Friction of one joint of a robot, from its log and its model, as ``harness diagnose LOG --robot FILE`` does.

    log : a table, a LeRobot data set or a bag, as ``load_log`` reads it. robot : MJCF or URDF. joint : of both, None
    for the only one that moves. gain : of a log in amperes, N m per A at the joint, for all, one each in the model's
    order, or by joint. gravity : m/s^2 in the frame of the base, None for the model's own. payload : kg, and sensor,
    "link" or "motor" : what is known where the whole arm moves. names : of the log's joints, or of a field
    ("elbow.effort"), the model's; {"a_joint{i}": "b_joint{i}"} of all of that shape, {"*": "*"} in their order. flip :
    joints that turn the other way. offset : rad or m by joint, added to its position. angle_unit : of positions. join,
    calibration, topic, rate : as in ``load_log``. engines : as in ``diagnose``. out : folder for report, trace and
    models, as the command leaves them.

    Raises InputError, SimulationError, StoreError.
    """
    from harness.app.diagnose.joint import diagnose_joint as computed
    from harness.app.diagnose.options import DiagnoseOptions, RobotOptions
    from harness.app.shared.reading import ReadOptions

    asked = RobotOptions.chosen(
        Path(robot),
        joint=joint,
        gain=gain if gain is None or isinstance(gain, float | int | Mapping) else tuple(gain),
        gravity=gravity,
        payload=payload,
        sensor=sensor,
        names=names or {},
        flip=tuple(flip),
        offset=offset or {},
        angle_unit=angle_unit,
        join=tuple(map(Path, join)),
        calibration=None if calibration is None else Path(calibration),
        topic=topic,
    )
    assert asked is not None
    options = DiagnoseOptions.chosen(ReadOptions(rate=rate), engines=engines, robot=asked)
    return kept(out, "joint", lambda folder: computed(Path(log), asked, options, folder))


def diagnose_servo(
    logs: File | Sequence[File],
    *,
    servo: str | None = None,
    robot: File | None = None,
    joint: str | None = None,
    columns: str | None = None,
    angle_unit: str | None = None,
    names: Mapping[str, str] | None = None,
    flip: Sequence[str] = (),
    offset: Mapping[str, float] | None = None,
    skip_rows: int = 0,
    rate: float | None = None,
    start: float | None = None,
    stop: float | None = None,
    drop_nan: bool = False,
    engines: Sequence[str] | None = None,
    out: File | None = None,
) -> DiagnosisResult:
    """A joint under its servo, from logs of its goals and positions, as ``harness diagnose LOG --servo NAME`` does.

    logs : one, or several of one servo. servo : as --servo, "sts3215:16", a gain each where they differ. robot, joint,
    angle_unit, names, flip, offset : as in ``diagnose_joint``; joint and the last three with a robot alone. columns and
    the rest : as in ``load_log``. engines, out : as in ``diagnose``. Raises InputError, SimulationError, StoreError.
    """
    from harness.app.diagnose.options import DiagnoseOptions, RobotOptions, ServoOptions
    from harness.app.diagnose.servo import diagnose_servo as computed
    from harness.app.shared.reading import ReadOptions

    files = [logs] if isinstance(logs, str | PathLike) else list(logs)
    asked = RobotOptions.chosen(
        None if robot is None else Path(robot),
        joint=joint,
        names=names or {},
        flip=tuple(flip),
        offset=offset or {},
        angle_unit=None if robot is None else angle_unit,
    )
    reading = ReadOptions(columns, skip_rows, rate, start, stop, drop_nan)
    of_servo = ServoOptions.chosen(servo, angle_unit if robot is None else None)
    options = DiagnoseOptions.chosen(reading, engines=engines, robot=asked, servo=of_servo)
    named = [(Path(file), str(file)) for file in files]
    return kept(out, "servo", lambda folder: computed(named, options, folder))


def plan(
    robot: File,
    joints: Sequence[str] = (),
    *,
    seconds: float = 20.0,
    rate: float = 250.0,
    speed: float | None = None,
    torque: float | None = None,
    out: File | None = None,
) -> PlanResult:
    """A motion within the limits of a robot's positions, speeds and torques by which friction has the least errors.

    robot : MJCF or URDF. joints : those that move; all where none is named. seconds : long. rate : Hz of the CSV.
    speed : rad/s or m/s, torque : N m or N, of every joint in place of the model's limits. out : as in ``run``; the
    motion is in files there. Raises InputError, StoreError.
    """
    from harness.app.plan import plan as computed

    return kept(out, "plan", lambda folder: computed(Path(robot), joints, seconds, rate, speed, torque, folder))


def log(
    file: File,
    *,
    columns: str | None = None,
    topic: str | None = None,
    gain: float | Mapping[str, float] | None = None,
    angle_unit: str | None = None,
    skip_rows: int = 0,
    rate: float | None = None,
    start: float | None = None,
    stop: float | None = None,
    drop_nan: bool = False,
    join: Sequence[File] | None = None,
    calibration: File | None = None,
) -> LogResult:
    """What a log of a robot's joints holds: topics, joints, fields, units, rates, gaps, and what is odd about it.

    file : a table, a LeRobot data set, a bag of ROS 1 or 2. The options are those of ``load_log``. Raises InputError
    for a file that holds no joints.
    """
    from harness.app.log import LogOptions
    from harness.app.log import log as answer

    files = tuple(map(Path, join or ()))
    options = LogOptions(
        columns,
        skip_rows,
        rate,
        start,
        stop,
        drop_nan,
        topic=topic,
        angle_unit=angle_unit,
        join=files,
        calibration=None if calibration is None else Path(calibration),
    )
    return answer(Path(file), options, gain)


def load_log(
    path: File,
    *,
    columns: str | None = None,
    joints: Sequence[str] | None = None,
    topic: str | None = None,
    gain: float | Mapping[str, float] | None = None,
    angle_unit: str | None = None,
    skip_rows: int = 0,
    rate: float | None = None,
    start: float | None = None,
    stop: float | None = None,
    drop_nan: bool = False,
    join: Sequence[File] = (),
    calibration: File | None = None,
) -> JointLog:
    """Read a log of a robot's joints, in SI units.

    columns : "t=t,elbow.position=q3[deg],elbow.effort=7.1*cur3[N*m]" where names say nothing. joints : those of the
    model, in its order: chosen by name, and the names where a log has none. topic : of a bag, or the episode of a data
    set. gain : N m per A at the joint, one for all or by joint. angle_unit : of positions that say none. skip_rows :
    lines before the header. rate : Hz, where no column gives the time. start, stop : s, the part to keep. drop_nan :
    skip rows in which a joint has no value. join : further files of the log, each with a signal of all joints.
    calibration : LeRobot's file, where positions are -100 to 100 of each joint's range.

    Raises InputError naming what is wrong, and where.
    """
    from harness.app.log import read

    return read(
        Path(path),
        columns=columns,
        joints=joints,
        topic=topic,
        gain=gain,
        angle_unit=angle_unit,
        skip_rows=skip_rows,
        rate=rate,
        start=start,
        stop=stop,
        drop_nan=drop_nan,
        join=tuple(map(Path, join)),
        calibration=None if calibration is None else Path(calibration),
    )


def _recording(given: Recording | File, covariates: tuple[str, ...] = ()) -> Recording:
    from harness.app.shared.reading import ReadOptions, read

    return given if isinstance(given, Recording) else read(Path(given), ReadOptions(covariates=covariates))


def _conditions(
    given: File | Mapping[str, Mapping[str, float]] | None, recording: Recording | File | Sequence[Recording | File]
) -> Mapping[str, Mapping[str, float]]:
    """Numbers by file name; raises InputError where they are given beside one recording."""
    from harness.app.diagnose.conditions import read_conditions

    if given is not None and isinstance(recording, Recording | str | PathLike):
        raise InputError("conditions", "given with one recording", "several")
    return read_conditions(Path(given)) if isinstance(given, str | PathLike) else given or {}
