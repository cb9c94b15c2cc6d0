"""Runs and recordings as a trace for the viewer and as a page for the browser."""

from collections.abc import Sequence
from pathlib import Path

from harness.core.recording import Recording
from harness.core.robot.bodies import Bodies
from harness.core.trajectory import Trajectory
from harness.results.identify import IdentifyResult
from harness.results.run import JointRunResult, RunResult
from harness.show.report.identify import identify_headline, identify_page, recording_scene
from harness.show.report.page import write_report
from harness.show.report.robot import joint_page
from harness.show.report.robot_scene import joint_scene
from harness.show.report.run import run_page
from harness.show.report.run_scene import run_scene
from harness.show.trace import write_trace


def write_run_trace(path: Path, result: RunResult, trajectories: Sequence[Trajectory], urdf: Path) -> None:
    """Write trace.rrd with everything in it that the page needs; raises StoreError."""
    notes = _notes("What differs, and why", result.conclusions)
    data = result.model_dump(mode="json", by_alias=True)
    write_trace(path, run_scene(trajectories, result.scenario, data, notes, urdf))


def _notes(heading: str, sentences: Sequence[str]) -> str:
    return "\n".join([f"# {heading}", "", *(f"- {sentence}" for sentence in sentences)])


def write_run_page(path: Path, result: RunResult, trajectories: Sequence[Trajectory]) -> None:
    """Write the page; raises StoreError."""
    write_report(path, run_page(result, trajectories))


def write_recording_trace(path: Path, result: IdentifyResult, recording: Recording) -> None:
    """Write the trace of a recording with its estimates; raises StoreError."""
    notes = _notes("What was read", [identify_headline(result), *result.warnings, *result.recording.notes])
    write_trace(path, recording_scene(recording, result, notes, _reversals(result)))


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
    write_report(path, identify_page(result, recording, fitted))


def write_joint_page(
    path: Path, result: JointRunResult, held: Sequence[Trajectory], swings: Sequence[Trajectory]
) -> None:
    """Write the page of a robot's joint in the engines; raises StoreError."""
    write_report(path, joint_page(result, held, swings))


def write_joint_trace(
    path: Path, result: JointRunResult, held: Sequence[Trajectory], swings: Sequence[Trajectory], robot: Bodies
) -> None:
    """Write its trace.rrd with everything in it that the page needs; raises StoreError."""
    notes = _notes(f"What engines make of {result.joint}", result.conclusions)
    write_trace(path, joint_scene(result, held, swings, robot, notes))
