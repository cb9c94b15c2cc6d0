"""Traces opened in the viewer; light, since the command asks it before anything heavy is loaded."""

import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from harness.core.errors import InputError

TRACE = "trace.rrd"


def find_trace(place: Path) -> Path:
    """The .rrd that ``place`` is, or that lies in it.

    Raises InputError when there is none.
    """
    if place.is_dir():
        if (place / TRACE).is_file():
            return place / TRACE
        inside = next(iter(sorted(place.glob(f"*/{TRACE}"))), None)  # of a folder of several results
        near = f"; did you mean {inside}?" if inside else ""
        raise InputError(str(place), f"no {TRACE} in it", f"an output folder with {TRACE}, or a .rrd{near}")
    if not place.is_file():
        raise InputError(str(place), "no such file", f"an output folder with {TRACE}, or a .rrd")
    if place.suffix.lower() == ".rrd":
        return place
    kind = f"a {place.suffix or 'nameless'} file"
    # the page or the result of a run is pointed at where its folder, or the trace beside it, is meant
    if place.with_name(TRACE).is_file():
        accepted = f"an output folder or a .rrd; did you mean {place.with_name(TRACE)}?"
    elif place.suffix.lower() in _PAGES:
        accepted = "an output folder or a .rrd"
    else:
        accepted = f"try: harness log {shlex.quote(str(place))}"
    raise InputError(str(place), kind, accepted)


_PAGES = (".html", ".json")
"""Endings of what is written beside a trace."""
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
