"""What the estimators, and a fit of viscous and Coulomb friction, say of a recording: harness identify."""

import math
import shlex
from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np

from harness.app.diagnose.files import motion_of
from harness.app.diagnose.options import DiagnoseOptions
from harness.app.diagnose.problem import Prepared, errors_of, prepared
from harness.app.shared.estimates import NOTE, WHOLE, estimated, estimates_of
from harness.app.shared.leaving import FILES, curves_of, leave, leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.over_amplitude import damping_of, write_damping
from harness.app.shared.progress import SILENT, Progress
from harness.app.shared.reading import averaged, read, recording_info, thinned
from harness.core.errors import SimulationError
from harness.core.quantity import Quantity
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.core.wording import capitalised
from harness.diagnosis.fit.rmse import rmse
from harness.diagnosis.fit.standard_errors import base_parameters, unit_of
from harness.diagnosis.moves.classify import classify
from harness.diagnosis.moves.kinds import MotionKind, Moves
from harness.diagnosis.pipeline import fit_base
from harness.diagnosis.prepare.driven import is_driven
from harness.diagnosis.problems.curve import Curve
from harness.diagnosis.residual_tests.structure import Left, left_by
from harness.estimate import slowing
from harness.estimate.result import Estimate, Estimation
from harness.io.options import ReadOptions
from harness.model.model import Restoring
from harness.results.common import MotionResult, P, Swing
from harness.results.diagnosis import FitResult
from harness.results.identify import IdentifyResult, SlowingResult
from harness.show.report.identify import identify_page, recording_scene

_MISSES = 2.0
"""Of the noise, in mean square, that a run-down or a curve of few rows leaves where something is missing."""
_CLEARLY = 5.0
"""Standard errors by which two methods differ, or a number has a sign that it cannot have."""


def _based(
    recording: Recording, ready: Prepared, estimation: Estimation | None, command: str
) -> tuple[FitResult | None, Trajectory | None, tuple[str, ...]]:
    """The base model fitted, its motion from its release on, and what is to be known before the estimates are believed.

    command : the line that estimates. None where the model could not be simulated. Raises InputError where channels are
    not of one motion.
    """
    doubts = () if estimation is None else _impossible(estimation)
    with np.errstate(over="ignore", invalid="ignore"), errors_of(recording):
        try:
            based = fit_base(ready.problem)
            free = recording if recording.steady else recording.cut(recording.t >= based.fit.model.t0)
            whole = based.whole.at_every_sample(free.t, free.channels)
            motion = motion_of("base fit", based.fit.model, whole, based.scales)
        except SimulationError as error:
            return None, None, (f"the base fit failed, so nothing checks these numbers: {error}", *doubts)
    found, problem, omega = based.fit, based.problem, based.scales.omega
    adequate = left_by(found, problem, omega, found) is Left.NOISE
    chi2 = found.chi2 / found.points
    if estimation is None and chi2 > _MISSES:
        adequate = False
    fit = FitResult.taken_from(
        found,
        parameters=base_parameters(found, problem, omega, adequate),
        rmse=rmse(found.shown.y, problem),
        chi2_per_point=chi2,
    )
    missed = () if adequate else (_missed(chi2, _diagnose(command, recording.file)),)
    differ = () if ready.warnings or estimation is None else _disagreeing(estimation)
    return fit, motion, (*ready.warnings, *missed, *differ, *doubts)


def _missed(chi2: float, line: str) -> str:
    return (
        f"residual {math.sqrt(chi2):.3g} times the noise (chi-square per point {chi2:.3g}): these numbers are biased."
        f" Try: {line}"
    )


def _diagnose(command: str, file: str) -> str:
    """The line that diagnoses what a line identifies; outputs are not written over."""
    words = shlex.split(command)
    if "identify" not in words:
        return f"harness diagnose {shlex.quote(file)}"
    words[words.index("identify")] = "diagnose"
    kept = [
        word
        for before, word in zip(["", *words], words, strict=False)
        if not {before, word, word.partition("=")[0]} & {"--out", "--json"}
    ]
    return shlex.join(kept)


def _impossible(estimation: Estimation) -> tuple[str, ...]:
    """Numbers that are clearly negative, which neither damping nor friction is."""
    said = []
    for method, found in estimation.methods.items():
        for name in ("zeta", "x_k"):
            one = getattr(found, name)
            if one.value is not None and one.stderr is not None and one.value < -_CLEARLY * one.stderr:
                errors = -one.value / one.stderr
                said.append(f"{method}: {name} is negative by {errors:.2g} standard errors, which is impossible")
    return tuple(said)


def _disagreeing(estimation: Estimation) -> tuple[str, ...]:
    """Methods of the whole model that differ by more than their errors."""
    first, second = (estimation.methods[name] for name in WHOLE)
    far = {name: _apart(first, second, name) for name in ("x_k", "zeta", "omega_n")}
    name = max(far, key=lambda one: far[one])
    if far[name] <= _CLEARLY:
        return ()
    values = [f"{getattr(one, name).value:.4g}" for one in (first, second)]
    return (
        f"{name} {values[0]} by {' and '.join(WHOLE)} {values[1]} differ by {far[name]:.2g} standard errors:"
        " channels or model are wrong",
    )


def _apart(first: Estimate, second: Estimate, name: str) -> float:
    one, other = getattr(first, name), getattr(second, name)
    if one.value is None or other.value is None:
        return 0.0
    error = math.hypot(one.stderr or 0.0, other.stderr or 0.0)
    return abs(one.value - other.value) / error if error > 0.0 else 0.0


def identify(
    path: Path,
    options: ReadOptions,
    trace: str | None = None,
    out: Path | None = None,
    progress: Progress = SILENT,
    command: str = "",
    restoring: Swing = "spring",
) -> IdentifyResult:
    """Read a recording, estimate, and leave result.json, trace.rrd, report.html and the log in a folder.

    trace : which of the traces of a .rrd. out : new or empty folder, None for reports/NAME-TIME here. command : the
    line that makes it again. restoring : what pulls back.

    Raises InputError with the reason when the recording cannot be read, is driven, or shows no free decay, StoreError
    when the folder cannot be written.
    """
    progress("reading", 0, 3)
    return deliver(read(path, options, trace), out, path.name.split(".")[0], progress, command, restoring)


def deliver(
    recording: Recording,
    out: Path | None = None,
    name: str = "recording",
    progress: Progress = SILENT,
    command: str = "",
    restoring: Swing = "spring",
) -> IdentifyResult:
    """Estimate, and leave everything in a folder, as ``identify`` does. name : of the default folder."""
    with leaving(f"identify-{name}", out) as output:
        progress("estimating", 1, 3)
        files = {name: output.at(file) for name, file in FILES.items()}
        result, motion = result_of(recording, command, files, restoring)
        if result.damping is not None:
            write_damping(output / "damping.csv", result.damping)
            result = result.model_copy(update={"files": {**files, "damping": output.at("damping.csv")}})
        progress("writing trace and report", 2, 3)
        leave(output, result, identify_page(result, thinned(recording), motion), recording_scene(recording, result))
    return result


def result_of(
    recording: Recording, command: str = "", files: Mapping[str, str] | None = None, restoring: Swing = "spring"
) -> tuple[IdentifyResult, Trajectory | None]:
    """The estimates from a recording as a result, with the motion of the base fit that checks them.

    Raises InputError as ``estimated`` does, and where nothing swings or channels are not of one motion.
    """
    moves = classify(recording, Restoring.PENDULUM if restoring == "pendulum" else None)
    if not is_driven(recording):
        moves.refuse(recording.file)
    if moves.kind in (MotionKind.RUN_DOWN, MotionKind.FRICTION_CURVE):
        return _slowed(recording, moves, command, files)
    recording, chosen = moves.part(recording)
    estimation, cleaned = estimated(recording, restoring)
    seen = averaged(cleaned, estimation.edges)
    with np.errstate(over="ignore", invalid="ignore"), errors_of(seen):
        ready = prepared(seen, DiagnoseOptions.chosen(ReadOptions(), restoring, engines=()))
    fit, motion, warnings = _based(seen, ready, estimation, command)
    models = {} if motion is None else {"viscous and Coulomb": motion}
    noted = [*chosen, *([moves.wanted] if moves.wanted else []), *([NOTE] if restoring == "pendulum" else [])]
    result = IdentifyResult(
        recording=recording_info(recording, estimation.noise),
        motion=MotionResult.taken_from(moves, spans_s=moves.spans),
        damping=damping_of(ready.problem, models),
        estimates=estimates_of(estimation),
        sensor_phase_rad=P.of(estimation.sensor_phase),
        restoring=restoring,
        baseline=fit,
        warnings=[*noted, *warnings, *estimation.warnings],
        command=command,
        machine=this_machine(),
        files=dict(files or {}),
    )
    return _drawn(result, recording, motion), motion


def _slowed(
    recording: Recording, moves: Moves, command: str, files: Mapping[str, str] | None
) -> tuple[IdentifyResult, Trajectory | None]:
    """As ``result_of``, of a run-down or a friction curve: dry friction alone, damping alone, both."""
    recording = thinned(recording)
    with np.errstate(over="ignore", invalid="ignore"), errors_of(recording):
        ready = prepared(recording, DiagnoseOptions.chosen(ReadOptions(), None, engines=()))
    problem = ready.problem
    recording = problem.shown_beside(recording)
    fit, motion, warnings = _based(recording, ready, None, command)
    if isinstance(problem, Curve):
        found = slowing.of_curve(problem.v, problem.channels["u"], problem.noise["u"])
    else:
        found = slowing.of_run_down(problem.t, problem.channels, problem.noise)
    units = {"c": unit_of("N s/m", problem), "f_k": unit_of("N", problem)}
    result = IdentifyResult(
        recording=recording_info(recording, problem.noise),
        motion=MotionResult.taken_from(moves, spans_s=moves.spans),
        estimates={},
        slowing={
            method: SlowingResult(
                chi2_per_point=one.chi2,
                **{
                    name: P.of(
                        Quantity(one.values[name], one.errors[name], unit)
                        if name in one.values
                        else Quantity.refused(unit, "taken to be nought")
                    )
                    for name, unit in units.items()
                },
            )
            for method, one in found.items()
        },
        sensor_phase_rad=P.of(Quantity.refused("rad", "needs a swing")),
        restoring="none",
        baseline=fit,
        warnings=[*(f"{capitalised(note)}." for note in ready.notes), *warnings],
        command=command,
        machine=this_machine(),
        files=dict(files or {}),
    )
    return _drawn(result, recording, motion), motion


def _drawn(result: IdentifyResult, recording: Recording, motion: Trajectory | None) -> IdentifyResult:
    """With its page and both motions."""
    recording = thinned(recording)
    curves = curves_of({"recording": recording, **({} if motion is None else {"viscous and Coulomb": motion})})
    return result.drawn(partial(identify_page, recording=recording, fitted=motion), curves)
