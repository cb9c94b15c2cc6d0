"""The page of real machines: what each recording comes to, shares and predictions, and what other fits said."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from harness.show.report.diagnosis_index import VERDICTS
from harness.show.report.page import write_report
from harness.show.report.section import Section
from harness.show.report.sources import MadeWith
from harness.show.report.table import Cell, Column, Row, Table
from harness.show.report.verdict import Verdict


@dataclass(frozen=True)
class Machines(Section):
    """rows : as in harness.machines/1."""

    template: ClassVar[str] = "table.html.j2"
    rows: Sequence[Mapping[str, Any]]

    @property
    def title(self) -> str:
        """The heading."""
        return "Recording by recording"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        found = Table(
            "machine",
            [
                Column("named or listed"),
                Column("takes off", "%", "of the misfit beyond the noise, alone"),
                Column("held out", "", "error after over before, blocks left out of the fit"),
                Column("free run", "", "the same of the last 40 %, from a fit of the rest"),
                Column("left", "times noise"),
            ],
            [Row(row["name"], self._cells(row), VERDICTS[row["verdict"]]) for row in self.rows],
            "Nobody knows the truth of these machines; what others said is what fits of a handful of laws came to.",
        )
        return {"tables": [found]}

    def _cells(self, row: Mapping[str, Any]) -> list[Cell]:
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
        Verdict(headline, [], heading="Real machines"),
        Machines(rows),
        Verdict("", sentences, [row["name"] for row in rows], heading="In sentences"),
        MadeWith(result["machine"], result["files"], result["command"]),
    ]
    write_report(path, "Real machines", "Published recordings, diagnosed by one command", sections)
