"""A page made again from its trace.rrd alone, and traces opened in the viewer."""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeAlias

from pydantic import ValidationError

from harness.app import compare
from harness.app.identify import result_of
from harness.app.run.case import case_of_json
from harness.app.run.run import measured
from harness.core.errors import InputError, StoreError
from harness.results.compare import CompareResult
from harness.results.diagnosis import DiagnosisResult, read_diagnosis
from harness.results.identify import IdentifyResult
from harness.results.run import JointRunResult, RunResult
from harness.results.scene import SceneResult
from harness.show.blocks import Page
from harness.show.report.diagnosis import diagnosis_page
from harness.show.report.identify import identify_page
from harness.show.report.own_scene import own_scene_page
from harness.show.report.page import write_report
from harness.show.report.robot import arm_page, joint_page
from harness.show.report.run import run_page
from harness.show.stored import HELD, LEFT, MOTION, SWING, StoredTrace, read_trace, unpacked

PAGE = "report.html"
Shown: TypeAlias = RunResult | IdentifyResult | DiagnosisResult | CompareResult | JointRunResult | SceneResult


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
    # what runs down is told by its motion
    restoring = "spring" if kept.restoring == "none" else kept.restoring
    result, motion = result_of(recording, kept.command, kept.files, restoring)
    result = result.model_copy(update={"machine": kept.machine})
    return result, identify_page(result, recording, motion)


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
    "harness.joint/1": _joint,
    "harness.scene/1": _scene,
    "harness.compare/1": compare.again,
    "harness.compare/2": compare.again,
}


TRACE = "trace.rrd"


def find_trace(place: Path) -> Path:
    """The .rrd that ``place`` is, or that lies in it.

    Raises InputError when there is none.
    """
    path = place / TRACE if place.is_dir() else place
    if not path.is_file():
        raise InputError(str(path), "no such file", f"an output folder with {TRACE}, or a .rrd")
    if path.suffix.lower() != ".rrd":
        # the page or the result of a run is pointed at where its folder, or the trace beside it, is meant
        near = f"; did you mean {path.with_name(TRACE)}?" if path.with_name(TRACE).is_file() else ""
        raise InputError(str(path), f"a {path.suffix or 'nameless'} file", f"an output folder or a .rrd{near}")
    return path


MOST = 10
"""Traces laid over each other: there are as many colours."""


def view(places: Sequence[Path], web: bool = False) -> int:
    """Open a trace, or several laid over each other, in the rerun viewer and return the viewer's exit code.

    web : in the browser instead of a window. Raises InputError without a trace, a viewer, or a screen, and for traces
    that cannot be laid over each other.
    """
    traces = [find_trace(place) for place in places]
    beside = str(Path(sys.executable).parent)
    program = shutil.which("rerun", path=beside) or shutil.which("rerun")
    if program is None:
        raise InputError("rerun", "not found", "an installed rerun-sdk, whose viewer this is")
    if not web and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise InputError("screen", "neither DISPLAY nor WAYLAND_DISPLAY is set", "try: --web")
    if len(traces) == 1:
        return subprocess.run(viewer_command(program, traces[0], web), check=False).returncode
    with tempfile.TemporaryDirectory() as folder:
        together = Path(folder) / TRACE
        overlay(places, together)
        return subprocess.run(viewer_command(program, together, web), check=False).returncode


def overlay(places: Sequence[Path], target: Path) -> None:
    """Write one .rrd that shows the motions of several traces in the same plots.

    Raises InputError for a place without a trace, for fewer than two and more than ten, for the same one twice, and
    where some slide and others turn; StoreError when it cannot be written.
    """
    traces = [find_trace(place) for place in places]
    if not 2 <= len(traces) <= MOST:
        raise InputError("view", f"{len(traces)} traces", f"2 to {MOST} to be laid over each other")
    whole = [trace.resolve() for trace in traces]
    twice = next((trace for trace in traces if whole.count(trace.resolve()) > 1), None)
    if twice is not None:
        raise InputError(str(twice), "given twice", "traces that are not the same")
    # imported when it is needed: numpy and the viewer's library come along
    from harness.show.report.scenes import named, overlay_scene
    from harness.show.stored import read_trace
    from harness.show.trace import write_trace

    names = named([str(place) for place in places])
    found = {name: read_trace(trace) for name, trace in zip(names, traces, strict=True)}
    write_trace(target, overlay_scene(found))


def viewer_command(program: str, trace: Path, web: bool) -> list[str]:
    """How the viewer is started: its servers listen on this machine alone."""
    # an absolute name is no option and no address, whatever the file is called
    return [program, "--bind", "127.0.0.1", *(["--web-viewer"] if web else []), str(trace.absolute())]
