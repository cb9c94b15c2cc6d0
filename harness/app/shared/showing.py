"""Runs and recordings as a trace for the viewer and as a page for the browser."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from harness.core.recording import Recording
from harness.core.robot.bodies import Bodies
from harness.core.trajectory import Trajectory
from harness.results.identify import IdentifyResult
from harness.results.run import JointRunResult, RunResult
from harness.show.overlay_scene import recording_scene
from harness.show.report.identify import identify_headline, identify_sections, identify_title
from harness.show.report.page import write_report
from harness.show.report.run import run_sections, run_title
from harness.show.robot.page import joint_sections
from harness.show.robot.scene import joint_scene
from harness.show.run_scene import run_scene
from harness.show.trace import write_trace


def _shown(result: RunResult) -> dict[str, Any]:
    """The result as JSON, with the traces that have a trajectory."""
    data = result.model_dump(mode="json", by_alias=True)
    data["traces"] = [trace for trace in data["traces"] if trace["error"] is None]
    return data


def write_run_trace(path: Path, result: RunResult, trajectories: Sequence[Trajectory], urdf: Path) -> None:
    """Write trace.rrd with everything in it that the page needs; raises StoreError."""
    notes = _notes("What differs, and why", result.conclusions)
    data = result.model_dump(mode="json", by_alias=True)
    write_trace(path, run_scene(trajectories, result.scenario, data, notes, urdf))


def _notes(heading: str, sentences: Sequence[str]) -> str:
    return "\n".join([f"# {heading}", "", *(f"- {sentence}" for sentence in sentences)])


def write_run_page(path: Path, result: RunResult, trajectories: Sequence[Trajectory]) -> None:
    """Write the page; raises StoreError."""
    data = _shown(result)
    write_report(path, *run_title(data), run_sections(trajectories, data, result.command))


def write_recording_trace(path: Path, result: IdentifyResult, recording: Recording) -> None:
    """Write the trace of a recording with its estimates; raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    notes = _notes("What was read", [identify_headline(data), *result.warnings, *result.recording.notes])
    write_trace(path, recording_scene(recording, data, notes, _reversals(result)))


def _reversals(result: IdentifyResult) -> list[tuple[float, str]]:
    """Time of every reversal, and what was read from it, by the first method that reads each by itself."""
    for method, estimate in result.estimates.items():
        rows = [row for row in estimate.per_reversal if row.get("x_k") is not None]
        if rows:
            unit = estimate.x_k.unit
            return [(row["t"], f"{method}: x_k = {row['x_k']:.6g} {unit}") for row in rows]
    return []


def write_recording_page(
    path: Path, result: IdentifyResult, recording: Recording, fitted: Trajectory | None = None
) -> None:
    """Write the page of a recording; fitted : the base model's motion. Raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    write_report(path, *identify_title(data), identify_sections(recording, data, result.command, fitted))


def write_joint_page(
    path: Path, result: JointRunResult, held: Sequence[Trajectory], swings: Sequence[Trajectory]
) -> None:
    """Write the page of a robot's joint in the engines; raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    sections = joint_sections(data, held, swings)
    write_report(path, f"What engines make of {result.joint}", result.file, sections)


def write_joint_trace(
    path: Path, result: JointRunResult, held: Sequence[Trajectory], swings: Sequence[Trajectory], robot: Bodies
) -> None:
    """Write its trace.rrd with everything in it that the page needs; raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    notes = _notes(f"What engines make of {result.joint}", result.conclusions)
    write_trace(path, joint_scene(data, held, swings, robot, notes))
