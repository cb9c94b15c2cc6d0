"""Diagnoses as a trace for the viewer and as pages for the browser."""

import os
from collections.abc import Sequence
from pathlib import Path

from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.diagnosis import DiagnosisResult, FailedDiagnosis
from harness.results.fleet import FleetResult
from harness.show.blocks import Page
from harness.show.report.diagnosis import gained, index_page, said, to_change
from harness.show.report.diagnosis_figures import diagnosis_scene
from harness.show.report.robot import fleet_sections
from harness.show.report.robot_scene import arm_scene
from harness.show.scene import Scene
from harness.show.shown import Shown


def scene_of(
    result: DiagnosisResult, recording: Recording, simulated: Sequence[Trajectory], shown: Shown | None = None
) -> Scene:
    """A diagnosis for the viewer, with everything in it that the page needs; shown : of a robot."""
    lines = ["# Verdict", "", result.statement, "", *(f"- {sentence}" for sentence in gained(result) + said(result))]
    if result.attribution is not None and (change := to_change(result.attribution)):
        lines += ["", "## What to change in your simulation", "", *(f"- {sentence}" for sentence in change)]
    if result.evidence:
        heads = ["| name | better by, in BIC | share of the misfit |", "|---|---|---|"]
        lines += ["", "## Evidence over the catalogue", "", *heads]
        shares = ["-" if one.share is None else f"{100.0 * one.share:.0f} %" for one in result.evidence]
        rows = zip(result.evidence, shares, strict=True)
        lines += [f"| {one.name} | {one.delta_bic:.1f} | {share} |" for one, share in rows]
    return diagnosis_scene(recording, simulated, result, "\n".join(lines), shown)


def index_of(
    path: Path, answers: Sequence[DiagnosisResult | FailedDiagnosis], command: str, fleet: FleetResult | None = None
) -> Page:
    """The page of several diagnoses, one row each with a link from ``path``; fleet : of one robot."""
    reports = [one.files.get("report") if isinstance(one, DiagnosisResult) else None for one in answers]
    links = [os.path.relpath(report, path.parent) if report else "" for report in reports]
    return index_page(answers, links, command, None if fleet is None else fleet_sections(fleet))


def arm_scene_of(result: DiagnosisResult, shown: Shown) -> Scene:
    """An arm that moves as a whole for the viewer."""
    assert result.robot is not None
    assert result.robot.arm is not None
    statements = [f"- {joint.statement}" for joint in result.robot.arm.joints]
    return arm_scene(result, shown, "\n".join(["# Verdict", "", result.statement, "", *statements]))
