"""What logs of one robot say together: which joint's friction is not the same in all."""

from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from harness.show.numbers import number, of_names, quantity
from harness.show.report.section import Cell, Column, Figure, Row, Section, Table
from harness.show.report.verdict import verdict_section

_NAMES = {"f_k": "Coulomb", "c": "viscous"}


def fleet_sections(fleet: Mapping[str, Any]) -> list[Section]:
    """Sections. fleet : FleetResult.model_dump(mode="json", by_alias=True) (harness.fleet/1)."""
    first, *more = (said.replace("+-", "\u00b1") for said in fleet["statements"])
    return [verdict_section(first, more, heading="Over all logs"), joints_section(fleet), spread_section(fleet)]


def joints_section(fleet: Mapping[str, Any]) -> Section:
    """Every parameter of every joint, a column a log."""
    logs = [PurePath(log["file"]).name for log in fleet["logs"]]
    trends = list(dict.fromkeys(t["name"] for row in fleet["rows"] for t in row["trends"]))
    columns = [
        *(Column(name) for name in logs),
        Column("the same?", "", "probability of such a scatter where it is"),
        *(Column(f"per {name}") for name in trends),
    ]
    rows = []
    for row in fleet["rows"]:
        slopes = {trend["name"]: trend for trend in row["trends"]}
        cells = [_cell(p) for p in row["values"]]
        cells.append(Cell("differs" if row["differs"] else number(row["chance"], 2), (), 4 if row["differs"] else 0))
        for name in trends:
            one = slopes.get(name)
            cells.append(Cell("-") if one is None else _cell(one["slope"], 4 if one["differs"] else None))
        rows.append(Row(f"{row['joint']}, {_NAMES[row['parameter']]}", cells, row["mean"]["unit"]))
    return Section("Joints over logs", "table.html.j2", {"tables": [Table("joint", columns, rows)]})


def _cell(p: Mapping[str, Any] | None, grade: int | None = None) -> Cell:
    if p is None:
        return Cell("-")
    value, error, _ = quantity(p)
    return Cell(value, [f"\u00b1 {error}"] if error else [], grade)


def spread_section(fleet: Mapping[str, Any]) -> Section:
    """Coulomb friction of every joint over its mean, with two errors."""
    logs = [PurePath(log["file"]).name for log in fleet["logs"]]
    figures = []
    for parameter, said in _NAMES.items():
        rows = [row for row in fleet["rows"] if row["parameter"] == parameter and row["mean"]["value"]]
        traces = [_trace(row, logs, color) for row, color in zip(rows, of_names(len(rows)), strict=True)]
        layout = {
            "xaxis": {"title": {"text": "log"}, "type": "category"},
            "yaxis": {"title": {"text": f"{said} friction over the mean"}},
            "showlegend": True,
        }
        caption = "Bars are two standard errors." if traces else ""
        figures.append(Figure(f"fleet-{parameter}", traces, layout, caption, "", 320))
    return Section(
        "How far each log is from the mean",
        "figures.html.j2",
        {"figures": [figure for figure in figures if figure.traces]},
    )


def _trace(row: Mapping[str, Any], logs: list[str], color: str) -> dict[str, Any]:
    mean = row["mean"]["value"]
    there = [(name, p) for name, p in zip(logs, row["values"], strict=True) if p is not None]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": row["joint"],
        "x": [name for name, _ in there],
        "y": [p["value"] / mean for _, p in there],
        "error_y": {"type": "data", "array": [2.0 * abs(p["stderr"] / mean) for _, p in there]},
        "marker": {"size": 8, "color": color},
        "hovertemplate": "%{y:.4f}<br>%{x}",
        "meta": {"curve": False},
    }
