"""Pages of published cases: the drive axis (figures beside ours), real machines."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.show.report.diagnosis import VERDICTS
from harness.show.report.page import write_report
from harness.show.report.section import Cell, Column, Row, Section, Table
from harness.show.report.verdict import made_with_section, verdict_section


def figures_section(rows: Sequence[Mapping[str, Any]], ripples: Sequence[Mapping[str, Any]]) -> Section:
    """rows, ripples : as in harness.dataset/1."""
    figures = Table(
        "model",
        [
            Column("mass", "kg"),
            Column("viscous friction", "N s/m", "one, or forwards and backwards"),
            Column("dry friction", "N"),
            Column("offset", "N"),
            Column("force error, fitted file", "%"),
            Column("force error, other file", "%", "nothing refitted, without a ripple"),
        ],
        [
            Row(
                row["label"],
                [
                    _cell(row["mass_kg"], row["mass_stderr_kg"]),
                    Cell(", ".join(f"{value:.4g}" for value in row["viscous"])),
                    *(_cell(row[n]) for n in ("dry_n", "offset_n", "fit_error_percent", "cross_error_percent")),
                ],
            )
            for row in rows
        ],
    )
    repeating = Table(
        "file",
        [Column("period", "mm"), Column("amplitude", "N"), Column("phase", "rad")],
        [Row(r["file"], [_cell(1e3 * r["period_m"]), _cell(r["amplitude_n"]), _cell(r["phase_rad"])]) for r in ripples],
        "A force that repeats along the screw, found in each file by itself.",
    )
    return Section("Published figures beside ours", "table.html.j2", {"tables": [figures, repeating]})


def _cell(value: float | None, stderr: float | None = None) -> Cell:
    if value is None:
        return Cell("-")
    return Cell(f"{value:.4g}", () if stderr is None else (f"± {stderr:.1g}",))


def write_dataset_page(path: Path, result: Mapping[str, Any]) -> None:
    """Write the page. result : DatasetResult.model_dump(by_alias=True) (harness.dataset/1)."""
    headline = " ".join(result["found"]) or "Nothing beyond viscous and Coulomb friction was found."
    sections: list[Section] = [
        verdict_section(headline, [f"Still unexplained: {result['unexplained']}", *result["diagnosis"]["warnings"]]),
        figures_section(result["rows"], result["ripples"]),
        made_with_section(result["diagnosis"]["machine"], result["files"], result["command"]),
    ]
    write_report(path, "The drive-axis benchmark (EMPS)", result["source"], sections)


def machines_section(rows: Sequence[Mapping[str, Any]]) -> Section:
    """rows : as in harness.machines/1."""
    found = Table(
        "machine",
        [
            Column("named or listed"),
            Column("takes off", "%", "of the misfit beyond the noise, alone"),
            Column("held out", "", "error after over before, blocks left out of the fit"),
            Column("free run", "", "the same of the last 40 %, from a fit of the rest"),
            Column("left", "times noise"),
        ],
        [Row(row["name"], _cells(row), VERDICTS[row["verdict"]]) for row in rows],
        "Nobody knows the truth of these machines; what others said is what fits of a handful of laws came to.",
    )
    return Section("Recording by recording", "table.html.j2", {"tables": [found]})


def _cells(row: Mapping[str, Any]) -> list[Cell]:
    lines = row["found"]
    return [
        _lines([f"{m['name']} ({m['grade']})" for m in lines]),
        _lines(["-" if m["share"] is None else f"{100.0 * m['share']:.0f}" for m in lines]),
        _lines([_ratio(m["holdout"]) for m in lines]),
        _lines([_ratio(m["forward"]) for m in lines]),
        Cell("-" if row["over_noise"] is None else f"{row['over_noise']:.2g}"),
    ]


def _lines(said: Sequence[str]) -> Cell:
    return Cell(said[0], tuple(said[1:])) if said else Cell("-")


def _ratio(value: float | None) -> str:
    return "-" if value is None else f"x {value:.2g}"


def _said(row: Mapping[str, Any]) -> list[str]:
    """What is said of a recording, and by whom; each begins with its name."""
    parts = [
        row["said"],
        f"Other fits said: {row['others']}" if row["others"] else "",
        f"From {row['source']}." if row["source"] else "",
    ]
    return [f"{row['name']}: {part}" for part in parts if part]


def write_machines_page(path: Path, result: Mapping[str, Any]) -> None:
    """Write the page. result : MachinesResult.model_dump(by_alias=True) (harness.machines/1)."""
    rows = result["rows"]
    named = sum(row["verdict"] in ("missing_physics", "main_effect") for row in rows)
    listed = sum(row["verdict"] == "one_of" for row in rows)
    headline = (
        f"{len(rows)} recordings of real machines: in {named} one omission is the main one, in {listed} it is one of a"
        f" few, in {len(rows) - named - listed} none has a name of its own."
    )
    sentences = [line for row in rows for line in _said(row)]
    if result["absent"]:
        sentences.append(f"Not in the folder: {', '.join(result['absent'])}.")
    sections: list[Section] = [
        verdict_section(headline, [], heading="Real machines"),
        machines_section(rows),
        verdict_section("", sentences, [row["name"] for row in rows], heading="In sentences"),
        made_with_section(result["machine"], result["files"], result["command"]),
    ]
    write_report(path, "Real machines", "Published recordings, diagnosed by one command", sections)
