"""A page made again from its trace.rrd alone, and the trace opened in the viewer."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from harness.app.diagnose_show import write_diagnosis_page
from harness.app.identify import result_of
from harness.app.model_run import case_of_json
from harness.app.run import measured
from harness.app.showing import write_recording_page, write_run_page
from harness.core.errors import InputError, StoreError
from harness.results.diagnosis import DiagnosisResult
from harness.results.identify import IdentifyResult
from harness.results.run import RunResult
from harness.show.trace import StoredTrace, read_trace

TRACE, PAGE = "trace.rrd", "report.html"


def find_trace(place: Path) -> Path:
    """The .rrd that ``place`` is, or that lies in it.

    Raises InputError when there is none.
    """
    path = place / TRACE if place.is_dir() else place
    if not path.is_file():
        raise InputError(str(path), "no such file", f"an output folder with {TRACE}, or a .rrd, is accepted")
    if path.suffix.lower() != ".rrd":
        raise InputError(str(path), f"a {path.suffix or 'nameless'} file", "an output folder or a .rrd is accepted")
    return path


def rebuild(place: Path, out: Path | None = None) -> tuple[RunResult | IdentifyResult | DiagnosisResult, Path]:
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
    except ValidationError:
        raise InputError(str(trace), "holds a result of another version", _ACCEPTED) from None


_ACCEPTED = "a trace written by harness run, identify or diagnose is accepted"


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
    result = result_of(stored.recordings[0], kept.command, kept.files).model_copy(update={"machine": kept.machine})
    write_recording_page(page, result, stored.recordings[0])
    return result


def _diagnose_again(stored: StoredTrace, data: Any, page: Path) -> DiagnosisResult:
    """A diagnosis is kept as it was found: fits are not made again."""
    result = DiagnosisResult.model_validate(data)
    write_diagnosis_page(page, result, stored.recordings[0], stored.trajectories)
    return result


_AGAIN: dict[str, Callable[[StoredTrace, Any, Path], RunResult | IdentifyResult | DiagnosisResult]] = {
    "harness.diagnosis/1": _diagnose_again,
    "harness.run/1": _run_again,
    "harness.identify/1": _identify_again,
}


def view(place: Path, web: bool = False) -> int:
    """Open a trace in the rerun viewer and return the viewer's exit code.

    web : in the browser instead of a window. Raises InputError without a trace, a viewer, or a screen.
    """
    trace = find_trace(place)
    beside = str(Path(sys.executable).parent)
    program = shutil.which("rerun", path=beside) or shutil.which("rerun")
    if program is None:
        raise InputError("rerun", "not found", "an installed rerun-sdk, whose viewer this is, is accepted")
    if not web and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise InputError("screen", "neither DISPLAY nor WAYLAND_DISPLAY is set", "a screen, or --web, is accepted")
    return subprocess.run([program, *(["--web-viewer"] if web else []), str(trace)], check=False).returncode
