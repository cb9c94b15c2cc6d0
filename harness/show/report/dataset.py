"""The page of a published case: published figures beside ours, what was found, what is still unexplained."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from harness.show.report.page import write_report
from harness.show.report.section import Section
from harness.show.report.sources import made_with_section
from harness.show.report.table import Cell, Column, Row, Table
from harness.show.report.verdict import verdict_section


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
