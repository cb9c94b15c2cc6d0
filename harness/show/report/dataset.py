"""The page of a published case: published figures beside ours, what was found, what is still unexplained."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from harness.show.report.page import write_report
from harness.show.report.section import Section
from harness.show.report.sources import MadeWith
from harness.show.report.table import Cell, Column, Row, Table
from harness.show.report.verdict import Verdict


@dataclass(frozen=True)
class Figures(Section):
    """rows, ripples : as in harness.dataset/1."""

    template: ClassVar[str] = "table.html.j2"
    rows: Sequence[Mapping[str, Any]]
    ripples: Sequence[Mapping[str, Any]]

    @property
    def title(self) -> str:
        """The heading."""
        return "Published figures beside ours"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
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
                for row in self.rows
            ],
        )
        ripples = Table(
            "file",
            [Column("period", "mm"), Column("amplitude", "N"), Column("phase", "rad")],
            [
                Row(r["file"], [_cell(1e3 * r["period_m"]), _cell(r["amplitude_n"]), _cell(r["phase_rad"])])
                for r in self.ripples
            ],
            "A force that repeats along the screw, found in each file by itself.",
        )
        return {"tables": [figures, ripples]}


def _cell(value: float | None, stderr: float | None = None) -> Cell:
    if value is None:
        return Cell("-")
    return Cell(f"{value:.4g}", () if stderr is None else (f"± {stderr:.1g}",))


def write_dataset_page(path: Path, result: Mapping[str, Any]) -> None:
    """Write the page. result : DatasetResult.model_dump(by_alias=True) (harness.dataset/1)."""
    headline = " ".join(result["found"]) or "Nothing beyond viscous and Coulomb friction was found."
    sections: list[Section] = [
        Verdict(headline, [f"Still unexplained: {result['unexplained']}", *result["diagnosis"]["warnings"]]),
        Figures(result["rows"], result["ripples"]),
        MadeWith(result["diagnosis"]["machine"], result["files"], result["command"]),
    ]
    write_report(path, "The drive-axis benchmark (EMPS)", result["source"], sections)
