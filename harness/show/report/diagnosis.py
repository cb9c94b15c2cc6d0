"""The page of a diagnosis: what was left out, where, how well the model that has it does, and in which engines."""

from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any

from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.show.report.diagnosis_figures import Before, Evidence, Mismatch, PhasePlane, Shares
from harness.show.report.diagnosis_tables import Engines, Heldout, Mechanisms, Models
from harness.show.report.numbers import number
from harness.show.report.section import Section
from harness.show.report.sources import MadeWith
from harness.show.report.verdict import Verdict


def diagnosis_sections(
    recording: Recording, simulated: Sequence[Trajectory], result: Mapping[str, Any]
) -> list[Section]:
    """Sections of a diagnosis.

    simulated : base model and refined model at the recording's times, extra "shown x" and the like what their sensors
    show. result : DiagnosisResult.model_dump(by_alias=True) (harness.diagnosis/1).
    """
    curves = Before(recording, simulated, result)
    sections: list[Section] = [
        Verdict(result["statement"].replace("+-", "\u00b1"), said(result), heading="Verdict"),
        curves,
        Mismatch(recording, simulated, result),
        PhasePlane(recording, simulated, result),
        Models(result),
    ]
    if result["mechanisms"]:
        sections.append(Mechanisms(result))
    if result["evidence"]:
        sections.append(Evidence(result))
    sections.append(Heldout(result))
    if result["attribution"] is not None:
        sections.append(Shares(result["attribution"]))
    if result["engines"]:
        sections.append(Engines(result))
    sections.append(MadeWith(result["machine"], result["files"], result["command"]))
    return sections


def diagnosis_title(result: Mapping[str, Any]) -> tuple[str, str]:
    """Title and subtitle of the page."""
    about = result["recording"]
    channels = ", ".join(about["channels"])
    name = "the recording on standard input" if about["file"] == "-" else PurePath(about["file"]).name
    line = f"{about['samples']} samples of {channels} at {about['rate_hz']:.6g} Hz, {about['duration_s']:.4g} s"
    return f"What a simulation leaves out of {name}", line


def said(result: Mapping[str, Any]) -> list[str]:
    """Sentences below the verdict: by how much, what else it could be, what would decide, warnings."""
    sentences = []
    before, after = (result[side]["chi2_per_point"] for side in ("baseline", "refined"))
    if result["mechanisms"]:
        sentences.append(
            f"Chi-square per point falls from {number(before, 4)} to {number(after, 4)} (1 when only noise is left)."
        )
    else:
        sentences.append(f"Chi-square per point is {number(before, 4)} (1 when only noise is left).")
    for mechanism in result["mechanisms"]:
        others = [f"{a['name']} (worse by {number(a['delta_bic'], 2)} in BIC)" for a in mechanism["alternatives"]]
        if others:
            sentences.append(f"The data do not rule out, in place of {mechanism['name']}: {', '.join(others)}.")
    for place in result["where"]:
        if place["regime"] == "throughout":
            sentences.append(f"Simulation and recording part throughout: {place['condition']}.")
            continue
        share = "" if place["share"] is None else f", which holds {100.0 * place['share']:.0f} % of the mismatch"
        sentences.append(f"Simulation and recording part where {place['condition']}{share}.")
    sentences += filter(None, [result["next_experiment"], *result["warnings"], *result["recording"]["notes"]])
    return [f"{sentence[0].upper()}{sentence[1:]}" for sentence in sentences]
