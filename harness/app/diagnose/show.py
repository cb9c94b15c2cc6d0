"""Diagnoses as a trace for the viewer and as pages for the browser."""

import logging
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.app.diagnose.robot_options import RobotOptions
from harness.core.errors import SimulationError
from harness.core.recording import Recording
from harness.core.robot.joint_log import JointLog
from harness.core.trajectory import Trajectory
from harness.results.diagnosis import DiagnosisResult, FailedDiagnosis
from harness.results.fleet import FleetResult
from harness.results.robot import SimulatedResult
from harness.robot.arm import Arm
from harness.robot.paste import JointPaste
from harness.robot.pictured import pictured
from harness.robot.replay.replay import MUJOCO, PYBULLET, replayed
from harness.show.report.diagnosis import diagnosis_page, gained, index_page, said, to_change
from harness.show.report.diagnosis_figures import diagnosis_scene
from harness.show.report.page import write_report
from harness.show.report.robot import arm_page, fleet_sections, joint_beside, match_page
from harness.show.report.robot_scene import arm_scene
from harness.show.shown import Left, Motion, Shown
from harness.show.trace import write_trace


def write_diagnosis_trace(
    path: Path,
    result: DiagnosisResult,
    recording: Recording,
    simulated: Sequence[Trajectory],
    shown: Shown | None = None,
) -> None:
    """Write trace.rrd, shown : of a robot, with everything in it that the page needs; raises StoreError."""
    lines = ["# Verdict", "", result.statement, "", *(f"- {sentence}" for sentence in gained(result) + said(result))]
    if result.attribution is not None and (change := to_change(result.attribution)):
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
    write_trace(path, diagnosis_scene(recording, simulated, result, "\n".join(lines), shown))


def write_diagnosis_page(
    path: Path,
    result: DiagnosisResult,
    recording: Recording,
    simulated: Sequence[Trajectory],
    shown: Shown | None = None,
) -> None:
    """Write the page of a diagnosis; shown : of a robot. Raises StoreError."""
    beside = () if shown is None else joint_beside(result, shown)
    write_report(path, diagnosis_page(result, recording, simulated, beside))


def write_index(
    path: Path,
    answers: Sequence[DiagnosisResult | FailedDiagnosis],
    command: str,
    fleet: FleetResult | None = None,
) -> None:
    """Write the page of several diagnoses, one row each with a link; fleet : of one robot. Raises StoreError."""
    reports = [one.files.get("report") if isinstance(one, DiagnosisResult) else None for one in answers]
    links = [os.path.relpath(report, path.parent) if report else "" for report in reports]
    write_report(path, index_page(answers, links, command, None if fleet is None else fleet_sections(fleet)))


def write_arm_page(path: Path, result: DiagnosisResult, shown: Shown) -> None:
    """Write the page of an arm that moves as a whole; raises StoreError."""
    write_report(path, arm_page(result, shown))


def write_match_page(path: Path, result: DiagnosisResult) -> None:
    """Write the page of a log that does not go together with its model; raises StoreError."""
    write_report(path, match_page(result))


def write_arm_trace(path: Path, result: DiagnosisResult, shown: Shown) -> None:
    """Write its trace.rrd; raises StoreError."""
    assert result.robot is not None
    assert result.robot.arm is not None
    statements = [f"- {joint.statement}" for joint in result.robot.arm.joints]
    write_trace(path, arm_scene(result, shown, "\n".join(["# Verdict", "", result.statement, "", *statements])))


LOGGER = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Tried:
    """What is shown, and the figures of it."""

    shown: Shown
    results: tuple[SimulatedResult, ...]


def tried(
    arm: Arm, log: JointLog, paste: JointPaste, asked: RobotOptions, left: Left, offset: float, engines: tuple[str, ...]
) -> Tried:
    """Simulate the joint with the friction of its file and with what is to be pasted.

    offset : of the logged torque, N m or N. engines : those of mujoco and pybullet that were asked for.
    """
    held = {name: float(np.mean(log.position[name])) for name in arm.joints if name in log.position}
    results, motions = [], []
    for engine in [name for name in (MUJOCO, PYBULLET) if name in engines]:
        try:
            one = replayed(asked.file, arm, log, paste, held, asked.gravity, offset, asked.payload or 0.0, engine)
        except SimulationError as error:
            LOGGER.warning("%s", error)
            results.append(
                SimulatedResult(
                    engine=engine, dt_s=None, window_s=None, windows=0, before={}, after={}, error=str(error)
                )
            )
            continue
        if one is None:
            break
        motions.append(Motion(engine, one.t, one.logged, one.q_before, one.q_after))
        results.append(
            SimulatedResult(
                engine=engine,
                version=one.version,
                dt_s=one.dt,
                window_s=one.window,
                windows=one.windows,
                before=dict(one.before),
                after=dict(one.after),
                left_out=list(one.left_out),
            )
        )
    return Tried(
        Shown(left, tuple(motions), pictured(asked.file, arm, log.t, log.position, paste.joint)), tuple(results)
    )
