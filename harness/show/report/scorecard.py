"""Sources against metrics, coloured by how far from exact."""

import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

from harness.show.headings import DECAY, heading
from harness.show.motion_units import units_of, without_step
from harness.show.numbers import number
from harness.show.report.estimates import true_values
from harness.show.report.section import Section
from harness.show.report.table import Cell, Column, Row, Table, grade


def scorecard_section(
    traces: Sequence[Mapping[str, Any]], scenario: Mapping[str, Any], palette: Sequence[str]
) -> Section:
    """traces : as in harness.run/1, the exact reference first. palette : a CSS colour each."""
    shown = measured(traces, scenario)
    headings = [heading(metric) for metric in shown]
    small = units_of(scenario).small
    columns = [Column(one.head, re.sub(r"^mm\b", small, one.unit), one.hint) for one in headings]
    columns.append(Column("run time", "ms", "wall clock time of the simulation"))
    rows = [_row(traces, scenario, trace, color, shown) for trace, color in zip(traces, palette, strict=True)]
    caption = (
        "Colours run from green (as good as exact) to red (off by more than 5 % of the start, the friction "
        "displacement x_k or the period, whichever the figure belongs to). A dash: there is no such figure."
    )
    return Section(
        "Scorecard",
        "folded.html.j2",
        {
            "tables": [Table("source", columns, rows, caption)],
            "summary": "Each source by each figure",
            "open": True,
        },
    )


def _row(
    traces: Sequence[Mapping[str, Any]],
    scenario: Mapping[str, Any],
    trace: Mapping[str, Any],
    color: str,
    shown: Sequence[str],
) -> Row:
    cells = [_cell(traces, scenario, trace, metric) for metric in shown]
    cells.append(Cell(number(None if trace["wall_s"] is None else trace["wall_s"] * 1e3, 3)))
    step = without_step(scenario) if trace["dt_s"] is None else f"step {trace['dt_s'] * 1e3:.4g} ms"
    return Row(f"{trace['source']} {trace['preset']}".strip(), cells, f"{trace['version']}, {step}".lstrip(", "), color)


def _cell(
    traces: Sequence[Mapping[str, Any]], scenario: Mapping[str, Any], trace: Mapping[str, Any], metric: str
) -> Cell:
    """A metric, graded by its distance from the exact motion's own."""
    value, exact = trace["metrics"].get(metric), traces[0]["metrics"].get(metric)
    if metric == "half_cycles":
        same = None if value is None or exact is None else 4 * (value != exact)
        return Cell(number(None) if value is None else str(value), grade=same)
    if metric == "stick_time_s":
        if value is None and exact is not None:
            return Cell("never", grade=4)
        return Cell(number(value, 5), grade=_graded(scenario, metric, value, exact))
    digits = 2 if metric == "energy_error" else 4
    shown = number(None if value is None else value * heading(metric).factor, digits)
    return Cell(shown, grade=_graded(scenario, metric, value, 0.0 if metric in DECAY else exact))


def _graded(scenario: Mapping[str, Any], metric: str, value: float | None, exact: float | None) -> int | None:
    scale = scales(scenario).get(metric)
    if scale is None and exact is not None:
        scale = 1.0 if metric.endswith("fraction") else abs(exact)
    return None if value is None or exact is None or not scale else grade((value - exact) / scale)


def measured(traces: Sequence[Mapping[str, Any]], scenario: Mapping[str, Any]) -> list[str]:
    """Metrics that a table of these traces shows, in order: a free decay's always, others where one trace has them."""
    every = dict.fromkeys([*DECAY, *(metric for trace in traces for metric in trace["metrics"])])
    always = DECAY if scenario.get("action") is None else ()
    there = [metric for metric in every if any(trace["metrics"].get(metric) is not None for trace in traces)]
    return [metric for metric in every if metric in always or metric in there]


def scales(scenario: Mapping[str, Any]) -> Mapping[str, float]:
    """What each metric is measured against, SI units; the scenario's own where it says them."""
    truth = true_values(scenario)
    found = {"max_error_m": abs(float((scenario.get("release") or {}).get("x0") or 0.0)), "energy_error": 1.0}
    found |= {"lift_m": found["max_error_m"], "rest_error_m": truth.get("x_k", 0.0)}
    if truth:
        period = 2.0 * math.pi / truth["omega_n"]
        found |= {"stick_time_s": period, "reversal_lead_s": period, "creep_m_s": truth["x_k"] / period}
    return found | dict(scenario.get("scales") or {})
