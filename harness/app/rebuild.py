"""The page of a run made again from its trace.rrd alone, and the trace opened in the viewer."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from pydantic import ValidationError

from harness.app.conclusions import conclusions
from harness.app.run import measured
from harness.app.scenarios import scenario_of_json
from harness.app.showing import write_run_page
from harness.core.errors import InputError, StoreError
from harness.results.run import RunResult
from harness.show.trace import read_trace

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


def rebuild(place: Path, out: Path | None = None) -> tuple[RunResult, Path]:
    """Make the page of a run again, estimates and metrics recomputed from the stored samples; nothing else is needed.

    place : output folder or .rrd. out : the page, a new file; None for report.html in the folder, or beside the .rrd
    under its name. Returns the result and the page. Raises InputError, StoreError.
    """
    trace = find_trace(place)
    page = out or (place / PAGE if place.is_dir() else trace.with_suffix(".html"))
    if out is not None and out.exists():
        raise StoreError(f"--out {out}: it exists; a new file is accepted")
    stored = read_trace(trace)
    try:
        result = RunResult.model_validate(stored.properties["result"])
    except (KeyError, ValidationError):
        raise InputError(str(trace), "holds no run", "a trace written by harness run is accepted") from None
    scenario = scenario_of_json(stored.properties["scenario"])
    again = iter([measured(trajectory, scenario) for trajectory in stored.trajectories])
    traces = [kept if kept.error is not None else next(again) for kept in result.traces]
    result = result.model_copy(update={"traces": traces, "conclusions": conclusions(traces, scenario)})
    write_run_page(page, result, stored.trajectories)
    return result, page


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
