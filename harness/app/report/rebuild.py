"""A page made again from its trace.rrd alone."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

from pydantic import ValidationError

from harness.app.compare.compare import again as compare_again
from harness.app.diagnose.show import write_arm_page, write_diagnosis_page
from harness.app.identify import result_of
from harness.app.report.view import find_trace
from harness.app.run.case import case_of_json
from harness.app.run.run import measured
from harness.app.shared.showing import write_joint_page, write_recording_page, write_run_page
from harness.core.errors import InputError, StoreError
from harness.results.compare import CompareResult
from harness.results.diagnosis import DiagnosisResult, read_diagnosis
from harness.results.identify import IdentifyResult
from harness.results.run import JointRunResult, RunResult
from harness.show.shown import HELD, LEFT, MOTION, SWING, unpacked
from harness.show.stored import StoredTrace, read_trace

PAGE = "report.html"
Shown: TypeAlias = RunResult | IdentifyResult | DiagnosisResult | CompareResult | JointRunResult


def rebuild(place: Path, out: Path | None = None) -> tuple[Shown, Path]:
    """Make a page again, estimates and metrics recomputed from the stored samples; nothing else is needed.

    place : output folder or .rrd. out : the page, a new file; None for report.html in the folder, or beside the .rrd
    under its name. Returns the result and the page. Raises InputError, StoreError.
    """
    trace = find_trace(place)
    page = out or (place / PAGE if place.is_dir() else trace.with_suffix(".html"))
    if out is not None and out.exists():
        raise StoreError(f"--out {out}: it exists; a new file is accepted")
    stored = read_trace(trace)
    try:
        data = stored.properties["result"]
        again = _AGAIN[data["schema"]]
    except (KeyError, TypeError):
        raise InputError(str(trace), "holds no result", _ACCEPTED) from None
    try:
        return again(stored, data, page), page
    except (ValidationError, LookupError, TypeError, StopIteration):
        raise InputError(str(trace), "holds a result of another version, or not all of it", _ACCEPTED) from None


_ACCEPTED = "a trace written by harness run, identify, compare or diagnose is accepted"


def _run_again(stored: StoredTrace, data: Any, page: Path) -> RunResult:
    result = RunResult.model_validate(data)
    case = case_of_json(stored.properties["scenario"])
    again = iter([measured(trajectory, case) for trajectory in stored.trajectories])
    traces = [kept if kept.error is not None else next(again) for kept in result.traces]
    result = result.model_copy(update={"traces": traces, "conclusions": case.conclusions(traces)})
    write_run_page(page, result, stored.trajectories)
    return result


def _identify_again(stored: StoredTrace, data: Any, page: Path) -> IdentifyResult:
    kept = IdentifyResult.model_validate(data)
    result, base = result_of(stored.recordings[0], kept.command, kept.files, kept.restoring)
    result = result.model_copy(update={"machine": kept.machine})
    write_recording_page(page, result, stored.recordings[0], base.motion)
    return result


def _diagnose_again(stored: StoredTrace, data: Any, page: Path) -> DiagnosisResult:
    """A diagnosis is kept as it was found: fits are not made again."""
    result = read_diagnosis(data)
    shown = unpacked(stored.robot[LEFT], stored.robot[MOTION]) if result.robot is not None else None
    if shown is not None and result.robot is not None and result.robot.mode == "whole-arm":
        write_arm_page(page, result, shown)
    else:
        write_diagnosis_page(page, result, stored.recordings[0], stored.trajectories, shown)
    return result


def _joint_again(stored: StoredTrace, data: Any, page: Path) -> JointRunResult:
    result = JointRunResult.model_validate(data)
    write_joint_page(page, result, stored.robot[HELD], stored.robot[SWING])
    return result


_AGAIN: dict[str, Callable[[StoredTrace, Any, Path], Shown]] = {
    "harness.diagnosis/1": _diagnose_again,
    "harness.diagnosis/2": _diagnose_again,
    "harness.run/1": _run_again,
    "harness.identify/1": _identify_again,
    "harness.joint/1": _joint_again,
    "harness.compare/1": compare_again,
    "harness.compare/2": compare_again,
}
