"""A robot's servo, and words that do nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from harness.show.numbers import number
from harness.show.report.section import Section
from harness.show.report.table import Cell, Column, Row, Table, grade
from harness.show.report.verdict import Verdict

Data = Mapping[str, Any]


@dataclass(frozen=True)
class Servos(Section):
    """about : the servo in words. exact : its zeta.

    rows : ("who", "n", "own", "false_damping" in N s/m, "zeta") each.
    """

    template: ClassVar[str] = "table.html.j2"
    about: str
    rows: Sequence[Data]
    exact: float

    @property
    def title(self) -> str:
        """The heading."""
        return "A robot's servo"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        columns = [Column("false damping", "N s/m"), Column("ζ becomes")]
        rows = [
            Row(
                f"{'own drive' if one['own'] else 'held torque'}, n = {one['n']}",
                [
                    Cell(f"{one['false_damping']:+.3g}" if one["false_damping"] else "0"),
                    Cell(number(one["zeta"], 3), grade=grade(one["zeta"] / self.exact - 1.0)),
                ],
            )
            for one in self.rows
        ]
        notes = [f"{row.head}: {one['who']}." for row, one in zip(rows, self.rows, strict=True)]
        return {"tables": [Table("n sub-steps", columns, rows, self.about, footnotes=notes)]}


def silent_words(rows: Sequence[Data]) -> Verdict:
    """Words that do nothing; rows : ("engine" with its version, "what") each."""
    note = (
        "These are words and settings of friction that an engine takes and does not act on, or acts on unasked. The "
        "versions are those it was found in, and docs/fidelity.md names the test of each."
    )
    said = [f"{one['engine']}: {one['what']}." for one in rows]
    return Verdict("", [*said, note], [one["engine"] for one in rows], "Words that do nothing")
