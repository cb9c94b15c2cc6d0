"""A trace opened in the viewer."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from harness.app.report.place import find_trace
from harness.core.errors import InputError


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
    return subprocess.run(viewer_command(program, trace, web), check=False).returncode


def viewer_command(program: str, trace: Path, web: bool) -> list[str]:
    """How the viewer is started: its servers listen on this machine alone."""
    # an absolute name is no option and no address, whatever the file is called
    return [program, "--bind", "127.0.0.1", *(["--web-viewer"] if web else []), str(trace.absolute())]
