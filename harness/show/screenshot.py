"""A picture of a trace as the viewer shows it, made without a screen.

``python -m harness.show.screenshot FILE.rrd OUT.png [TIME]`` needs a graphics driver; Debian's software one is enough:
``apt-get install --no-install-recommends libvulkan1 mesa-vulkan-drivers``.
"""

import os
import socket
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from harness.core.errors import HarnessError, SimulationError
from harness.core.writing import replacing

PATIENCE = 60.0
TOASTS = 6.0
"""Time the viewer's start-up messages stay on screen, s."""


@dataclass(frozen=True, slots=True)
class Shot:
    """A picture (PNG) and what each view had to say: name -> warnings and errors, empty when all is well."""

    png: bytes
    reports: dict[str, list[str]]


def driver() -> str | None:
    """None when a Vulkan driver is installed, else what is missing, in a sentence."""
    folders = ("/usr/share/vulkan/icd.d", "/etc/vulkan/icd.d", "/usr/local/share/vulkan/icd.d")
    if any(list(Path(folder).glob("*.json")) for folder in folders if Path(folder).is_dir()):
        return None
    return "no Vulkan driver is installed (apt-get install --no-install-recommends libvulkan1 mesa-vulkan-drivers)"


def take(trace: Path, at: float | None = None) -> Shot:
    """Open a trace in a viewer without a window, set the time (s) and take its picture.

    Raises SimulationError when the viewer does not start or does not finish loading.
    """
    missing = driver()
    if missing:
        raise SimulationError(missing)
    with tempfile.TemporaryDirectory(prefix="friction-harness-viewer-") as private:
        environment = {"WGPU_BACKEND": "vulkan", "RERUN_ANALYTICS": "0", "XDG_RUNTIME_DIR": private, "NO_COLOR": "1"}
        before = {name: os.environ.get(name) for name in environment}
        os.environ.update(environment)
        try:
            return _take(trace, at)
        finally:
            for name, value in before.items():
                if value is None:
                    os.environ.pop(name, None)
                else:
                    os.environ[name] = value


def _take(trace: Path, at: float | None) -> Shot:
    from harness.show.trace import headless_viewer

    with headless_viewer(_free_port()) as viewer:
        viewer.open(str(trace.resolve()))
        end = time.monotonic() + PATIENCE
        while viewer.get_state().loading or not viewer.get_state().recordings:
            if time.monotonic() > end:
                raise SimulationError(f"{trace}: the viewer did not finish loading it in {PATIENCE:g} s")
            time.sleep(0.2)
        if at is not None:
            viewer.set_time("time", duration=at, play_state="paused")
        time.sleep(TOASTS)
        png = viewer.take_screenshot()
        reports = {
            view.name: [f"{report.severity}: {report.summary}" for report in view.reports]
            for view in viewer.get_state().views
        }
    return Shot(png, reports)


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def main(arguments: list[str]) -> int:
    """Write the picture; 1 and a line on standard error when a view reports anything."""
    if len(arguments) not in (2, 3):
        print("usage: python -m harness.show.screenshot FILE.rrd OUT.png [TIME]", file=sys.stderr)
        return 2
    try:
        shot = take(Path(arguments[0]), float(arguments[2]) if len(arguments) == 3 else None)
        with replacing(Path(arguments[1])) as part:
            part.write_bytes(shot.png)
    except HarnessError as error:
        print(error, file=sys.stderr)
        return error.exit_code
    complaints = [f"{name}: {line}" for name, lines in shot.reports.items() for line in lines]
    print("\n".join(complaints), end="\n" if complaints else "", file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
