"""A run as a trace for the viewer and as a page for the browser."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from harness.core.errors import StoreError
from harness.core.trajectory import Trajectory
from harness.results.run import RunResult
from harness.show.report.page import write_report
from harness.show.report.run import run_sections, run_title
from harness.show.run_scene import run_scene
from harness.show.trace import write_trace


def _shown(result: RunResult) -> dict[str, Any]:
    """The result as JSON, with the traces that have a trajectory."""
    data = result.model_dump(mode="json", by_alias=True)
    data["traces"] = [trace for trace in data["traces"] if trace["error"] is None]
    return data


def write_run_trace(path: Path, result: RunResult, trajectories: Sequence[Trajectory], urdf: Path) -> None:
    """Write trace.rrd with everything in it that the page needs; raises StoreError."""
    notes = "\n".join(["# What differs, and why", "", *(f"- {sentence}" for sentence in result.conclusions)])
    scene = run_scene(trajectories, result.scenario, result.model_dump(mode="json", by_alias=True), notes, urdf)
    try:
        write_trace(path, scene)
    except RuntimeError as error:  # all that the viewer's library says of a writer that found no space
        raise StoreError(f"{path.name}: {error}; a place with room on the disk is accepted") from error


def write_run_page(path: Path, result: RunResult, trajectories: Sequence[Trajectory]) -> None:
    """Write the page; raises StoreError."""
    data = _shown(result)
    write_report(path, *run_title(data), run_sections(trajectories, data, result.command))
