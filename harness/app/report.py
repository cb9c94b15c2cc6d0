"""A page made again from its trace.rrd alone."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

from pydantic import ValidationError

from harness.app import compare
from harness.app.identify import result_of
from harness.app.identify_together import result_of_together
from harness.app.run.case import case_of_json
from harness.app.run.run import measured
from harness.app.view import find_trace
from harness.core.errors import InputError, StoreError
from harness.results.common import Swing
from harness.results.compare import CompareResult
from harness.results.diagnosis import DiagnosisResult, read_diagnosis
from harness.results.identify import FailedIdentify, IdentifyResult, RepeatedIdentifyResult
from harness.results.run import JointRunResult, RunResult
from harness.results.scene import SceneResult
from harness.show.blocks import Page
from harness.show.report.diagnosis import diagnosis_page
from harness.show.report.identify import identify_page
from harness.show.report.identify_together import repeated_page
from harness.show.report.own_scene import own_scene_page
from harness.show.report.page import write_report
from harness.show.report.robot import arm_page, joint_page
from harness.show.report.run import run_page
from harness.show.stored import HELD, LEFT, MOTION, SWING, StoredTrace, read_trace, unpacked

PAGE = "report.html"
Shown: TypeAlias = (
    RunResult | IdentifyResult | RepeatedIdentifyResult | DiagnosisResult | CompareResult | JointRunResult | SceneResult
)


def rebuild(place: Path, out: Path | None = None) -> tuple[Shown, Path]:
    """Make a page again, estimates and metrics recomputed from the stored samples; nothing else is needed.

    place : output folder or .rrd. out : the page, a new file; None for report.html in the folder, or beside the .rrd
    under its name. Returns the result and the page. Raises InputError, StoreError.
    """
    trace = find_trace(place)
    page = out or (place / PAGE if place.is_dir() else trace.with_suffix(".html"))
    if out is not None and out.exists():
        raise StoreError(f"--out {out}: it exists; expected a new file")
    stored = read_trace(trace)
    try:
        data = stored.properties["result"]
        again = _AGAIN[data["schema"]]
    except (KeyError, TypeError):
        raise InputError(str(trace), "holds no result", _ACCEPTED) from None
    try:
        result, shown = again(stored, data)
        write_report(page, shown)
    except (ValidationError, LookupError, TypeError, StopIteration):
        raise InputError(str(trace), "holds a result of another version, or not all of it", _ACCEPTED) from None
    return result, page


_ACCEPTED = "a trace written by harness run, identify, compare or diagnose"


def _run(stored: StoredTrace, data: Any) -> tuple[RunResult, Page]:
    result = RunResult.model_validate(data)
    case = case_of_json(stored.properties["scenario"])
    again = iter([measured(trajectory, case) for trajectory in stored.trajectories])
    traces = [kept if kept.error is not None else next(again) for kept in result.traces]
    result = result.model_copy(update={"traces": traces, "conclusions": case.conclusions(traces)})
    return result, run_page(result, stored.trajectories)


def _identify(stored: StoredTrace, data: Any) -> tuple[IdentifyResult, Page]:
    kept, recording = IdentifyResult.model_validate(data), stored.recordings[0]
    result, motion = result_of(recording, kept.command, kept.files, _restoring(kept))
    result = result.model_copy(update={"machine": kept.machine})
    return result, identify_page(result, recording, motion)


def _restoring(kept: IdentifyResult) -> Swing:
    """What is told about the restoring force; what runs down is told by its motion."""
    return "spring" if kept.restoring == "none" else kept.restoring


def _identify_together(stored: StoredTrace, data: Any) -> tuple[RepeatedIdentifyResult, Page]:
    kept = RepeatedIdentifyResult.model_validate(data)
    recordings = iter(stored.recordings)
    given = [one if isinstance(one, FailedIdentify) else next(recordings) for one in kept.recordings]
    swing = _restoring(kept.found[0])
    result, _ = result_of_together(given, kept.command, kept.files, swing, conditions=kept.conditions)
    # each is as it was written: with the machine that it was estimated on
    each = [
        again.model_copy(update={"machine": old.machine})
        if isinstance(again, IdentifyResult) and isinstance(old, IdentifyResult)
        else again
        for again, old in zip(result.recordings, kept.recordings, strict=True)
    ]
    result = result.model_copy(update={"machine": kept.machine, "recordings": each})
    return result, repeated_page(result)


def _diagnosis(stored: StoredTrace, data: Any) -> tuple[DiagnosisResult, Page]:
    """A diagnosis is kept as it was found: fits are not made again."""
    result = read_diagnosis(data)
    shown = None if result.robot is None else unpacked(stored.robot[LEFT], stored.robot[MOTION])
    if result.robot is not None and shown is not None and result.robot.mode == "whole-arm":
        return result, arm_page(result, shown)
    return result, diagnosis_page(result, stored.recordings[0], stored.trajectories, shown)


def _joint(stored: StoredTrace, data: Any) -> tuple[JointRunResult, Page]:
    result = JointRunResult.model_validate(data)
    return result, joint_page(result, stored.robot[HELD], stored.robot[SWING])


def _scene(stored: StoredTrace, data: Any) -> tuple[SceneResult, Page]:
    result = SceneResult.model_validate(data)
    return result, own_scene_page(result, stored.robot[HELD])


_AGAIN: dict[str, Callable[[StoredTrace, Any], tuple[Shown, Page]]] = {
    "harness.diagnosis/1": _diagnosis,
    "harness.diagnosis/2": _diagnosis,
    "harness.run/1": _run,
    "harness.identify/1": _identify,
    "harness.identify/2": _identify_together,
    "harness.joint/1": _joint,
    "harness.scene/1": _scene,
    "harness.compare/1": compare.again,
    "harness.compare/2": compare.again,
}
