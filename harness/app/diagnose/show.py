"""Diagnoses as a trace for the viewer and as pages for the browser."""

import os
from collections.abc import Sequence
from pathlib import Path

from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.diagnosis import DiagnosisResult, FailedDiagnosis
from harness.results.fleet import FleetResult
from harness.show.diagnosis_scene import diagnosis_scene
from harness.show.report.diagnosis import (
    diagnosis_sections,
    diagnosis_title,
    gained,
    index_sections,
    index_title,
    said,
    to_change,
)
from harness.show.report.page import write_report
from harness.show.robot.fleet_page import fleet_sections
from harness.show.robot.page import arm_sections, match_sections, robot_sections
from harness.show.robot.scene import arm_scene, with_robot
from harness.show.robot.shown import Shown
from harness.show.trace import write_trace


def write_diagnosis_trace(
    path: Path,
    result: DiagnosisResult,
    recording: Recording,
    simulated: Sequence[Trajectory],
    shown: Shown | None = None,
) -> None:
    """Write trace.rrd, shown : of a robot, with everything in it that the page needs; raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    lines = ["# Verdict", "", result.statement, "", *(f"- {sentence}" for sentence in gained(data) + said(data))]
    if data["attribution"] is not None and (change := to_change(data["attribution"])):
        lines += ["", "## What to change in your simulation", "", *(f"- {sentence}" for sentence in change)]
    if result.evidence:
        lines += [
            "",
            "## Evidence over the catalogue",
            "",
            "| name | better by, in BIC | share of the misfit |",
            "|---|---|---|",
        ]
        shares = ["-" if one.share is None else f"{100.0 * one.share:.0f} %" for one in result.evidence]
        rows = zip(result.evidence, shares, strict=True)
        lines += [f"| {one.name} | {one.delta_bic:.1f} | {share} |" for one, share in rows]
    scene = diagnosis_scene(recording, simulated, data, "\n".join(lines))
    write_trace(path, scene if shown is None else with_robot(scene, data, shown))


def write_diagnosis_page(
    path: Path,
    result: DiagnosisResult,
    recording: Recording,
    simulated: Sequence[Trajectory],
    shown: Shown | None = None,
) -> None:
    """Write the page of a diagnosis; shown : of a robot. Raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    sections = diagnosis_sections(recording, simulated, data)
    if shown is not None:
        sections[1:1] = robot_sections(data, shown)
    write_report(path, *diagnosis_title(data), sections)


def write_index(
    path: Path,
    answers: Sequence[DiagnosisResult | FailedDiagnosis],
    command: str,
    fleet: FleetResult | None = None,
) -> None:
    """Write the page of several diagnoses, one row each with a link; fleet : of one robot. Raises StoreError."""
    data = []
    for answer in answers:
        one = answer.model_dump(mode="json", by_alias=True)
        report = one.get("files", {}).get("report")
        data.append(one | {"link": os.path.relpath(report, path.parent) if report else ""})
    sections = index_sections(data, command)
    if fleet is not None:
        sections = [*fleet_sections(fleet.model_dump(mode="json", by_alias=True)), *sections[1:]]
    write_report(path, *index_title(data), sections)


def write_arm_page(path: Path, result: DiagnosisResult, shown: Shown) -> None:
    """Write the page of an arm that moves as a whole; raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    write_report(path, f"Friction of {data['robot']['joint']}", data["recording"]["file"], arm_sections(data, shown))


def write_match_page(path: Path, result: DiagnosisResult) -> None:
    """Write the page of a log that does not go together with its model; raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    write_report(path, f"Log and model of {data['robot']['joint']}", data["recording"]["file"], match_sections(data))


def write_arm_trace(path: Path, result: DiagnosisResult, shown: Shown) -> None:
    """Write its trace.rrd; raises StoreError."""
    data = result.model_dump(mode="json", by_alias=True)
    lines = [
        "# Verdict",
        "",
        result.statement,
        "",
        *(f"- {joint['statement']}" for joint in data["robot"]["arm"]["joints"]),
    ]
    write_trace(path, arm_scene(data, shown, "\n".join(lines)))
