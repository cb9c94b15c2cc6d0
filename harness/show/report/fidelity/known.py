"""A robot's servo, and words that do nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from harness.show.numbers import number
from harness.show.report.section import Section
from harness.show.report.table import Cell, Column, Row, Table, grade

Data = Mapping[str, Any]


@dataclass(frozen=True)
class Servos(Section):
    """about : the servo in words. rows : ("who", "n", "false_damping" in N s/m, "zeta") each. exact : zeta of it."""

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
        columns = [Column("sub-steps"), Column("false damping", "N s/m"), Column("ζ becomes")]
        rows = [
            Row(
                one["who"],
                [
                    Cell(str(one["n"])),
                    Cell(f"{one['false_damping']:+.3g}" if one["false_damping"] else "0"),
                    Cell(number(one["zeta"], 3), grade=grade(one["zeta"] / self.exact - 1.0)),
                ],
            )
            for one in self.rows
        ]
        return {"tables": [Table("who computes it", columns, rows, self.about)]}


@dataclass(frozen=True)
class Silents(Section):
    """rows : ("engine" with its version, "what") each."""

    template: ClassVar[str] = "table.html.j2"
    rows: Sequence[Data]

    @property
    def title(self) -> str:
        """The heading."""
        return "Words that do nothing"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        caption = (
            "Words and settings of friction that an engine takes and does not act on, or acts on unasked; the versions "
            "are those it was found in, and docs/fidelity.md names the test of each."
        )
        rows = [Row(one["engine"], [Cell(one["what"])]) for one in self.rows]
        return {"tables": [Table("engine", [Column("what")], rows, caption)]}
