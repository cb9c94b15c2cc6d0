"""Sources against metrics, coloured by how far from exact."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from harness.show.report.estimates import true_values
from harness.show.report.numbers import number
from harness.show.report.section import Section
from harness.show.report.table import Cell, Column, Row, Table, grade


@dataclass(frozen=True)
class Scorecard(Section):
    """traces : as in harness.run/1. palette : a CSS colour each."""

    template: ClassVar[str] = "table.html.j2"
    traces: Sequence[Mapping[str, Any]]
    scenario: Mapping[str, Any]
    palette: Sequence[str]

    @property
    def title(self) -> str:
        """The heading."""
        return "Scorecard"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        columns = [
            Column("largest position error", "mm", "largest |x - exact x| over the run"),
            Column("error at rest", "mm", "last position minus the exact rest position"),
            Column("stops at", "s", "time from which the slider does not move any more"),
            Column("creep", "mm/s", "mean speed while the exact slider rests"),
            Column("half-cycles", "", "until it rests"),
            Column("friction leads by", "ms", "by how much friction reverses before the speed does"),
            Column("energy error", "", "largest error of the energy balance over the starting energy"),
            Column("run time", "ms", "wall clock time of the simulation"),
        ]
        if any(trace["metrics"].get("lift_m") is not None for trace in self.traces):
            columns.append(Column("lift", "mm", "largest height of the box above the floor"))
        rows = [
            self._row(trace, color, len(columns) > 8) for trace, color in zip(self.traces, self.palette, strict=True)
        ]
        caption = (
            "Colours run from green (as good as exact) to red (off by more than 5 % of the start, the friction "
            "displacement x_k or the period, whichever the figure belongs to). A dash: there is no such figure."
        )
        return {"tables": [Table("source", columns, rows, caption)]}

    def _row(self, trace: Mapping[str, Any], color: str, with_lift: bool) -> Row:
        metrics, exact = trace["metrics"], self.traces[0]["metrics"]
        size = abs(float((self.scenario.get("release") or {}).get("x0") or 0.0)) or None
        period, x_k = self._period(), self._x_k()
        stick = metrics["stick_time_s"]
        late = None if stick is None or exact["stick_time_s"] is None else stick - exact["stick_time_s"]
        never = stick is None and exact["stick_time_s"] is not None
        halves = metrics["half_cycles"]
        cells = [
            self._cell(metrics["max_error_m"], 1e3, size),
            self._cell(metrics["rest_error_m"], 1e3, x_k),
            Cell("never" if never else number(stick, 5), grade=4 if never else _graded(late, period)),
            self._cell(metrics["creep_m_s"], 1e3, x_k / period if x_k and period else None),
            Cell(
                number(halves, 6) if halves is None else str(halves),
                grade=None if halves is None or exact["half_cycles"] is None else 4 * (halves != exact["half_cycles"]),
            ),
            self._cell(metrics["reversal_lead_s"], 1e3, period),
            self._cell(metrics["energy_error"], 1.0, 1.0, 2),
            Cell(number(None if trace["wall_s"] is None else trace["wall_s"] * 1e3, 3)),
        ]
        if with_lift:
            cells.append(self._cell(metrics.get("lift_m"), 1e3, size))
        step = "closed form" if trace["dt_s"] is None else f"step {trace['dt_s'] * 1e3:.4g} ms"
        return Row(
            f"{trace['source']} {trace['preset']}".strip(), cells, f"{trace['version']}, {step}".lstrip(", "), color
        )

    @staticmethod
    def _cell(value: float | None, factor: float, scale: float | None, digits: int = 4) -> Cell:
        return Cell(number(None if value is None else value * factor, digits), grade=_graded(value, scale))

    def _x_k(self) -> float | None:
        return true_values(self.scenario).get("x_k") or None

    def _period(self) -> float | None:
        omega_n = true_values(self.scenario).get("omega_n")
        return 2.0 * math.pi / omega_n if omega_n else None


def _graded(value: float | None, scale: float | None) -> int | None:
    return None if value is None or not scale else grade(value / scale)
