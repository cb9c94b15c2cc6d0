"""What each of several recordings has of its own, as a table: start, zero, noise, what both models leave of it."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, ClassVar

from harness.show.numbers import number, quantity
from harness.show.report.section import Section
from harness.show.report.table import Cell, Column, Row, Table


@dataclass(frozen=True, slots=True)
class Own(Section):
    """A row a recording. result : as in harness.diagnosis/2, of several recordings."""

    template: ClassVar[str] = "table.html.j2"
    result: Mapping[str, Any]

    @property
    def title(self) -> str:
        """The heading."""
        return "Recordings of one machine"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        own = self.result["own"]
        channels = list(own[0]["rmse"])
        length = own[0]["start"]["x0"]["unit"]
        zero = [Column("zero", length)] if own[0]["zero"] else []
        columns = [Column("begins at", "s", "on the axis of time on which all lie"), Column("start", length), *zero]
        for c in channels:
            columns += [Column(f"noise of {c}"), Column(f"rmse of {c}", "", "viscous and Coulomb")]
            columns += [Column("refined", "", f"rmse of {c}")] if self.result["mechanisms"] else []
        alone = [Column(name, p["unit"]) for name, p in own[0]["alone"].items()]
        rows = [Row(_name(one), [_cell(p) for p in one["alone"].values()]) for one in own]
        return {
            "tables": [
                Table("recording", columns, [self._row(one, channels) for one in own]),
                Table("recording", alone, rows, "Viscous and Coulomb friction fitted to each by itself."),
            ]
        }

    def _row(self, one: Mapping[str, Any], channels: list[str]) -> Row:
        cells = [Cell(number(one["begins_s"], 4)), _cell(one["start"]["x0"])]
        cells += [_cell(one["zero"])] if one["zero"] else []
        for c in channels:
            noise, before = one["noise"][c], number(one["baseline_rmse"][c], 3)
            cells += [Cell(noise if isinstance(noise, str) else number(noise, 3)), Cell(before)]
            cells += [Cell(number(one["rmse"][c], 3))] if self.result["mechanisms"] else []
        return Row(_name(one), cells, "; ".join(one["differs"]))


def _name(one: Mapping[str, Any]) -> str:
    return PurePath(one["file"]).name


def _cell(p: Mapping[str, Any]) -> Cell:
    value, error, _ = quantity(p)
    return Cell(value, [f"\u00b1 {error}"] if error else [])
