"""The page of a robot's joint in the engines."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.core.trajectory import Trajectory
from harness.show.numbers import number
from harness.show.palette import of_engines
from harness.show.report.figure import Figure
from harness.show.report.section import Section
from harness.show.report.sources import made_with_section
from harness.show.report.table import Cell, Column, Row, Table
from harness.show.report.verdict import verdict_section
from harness.show.robot.to_paste import to_paste_section

_POINTS = 2000


def joint_sections(
    result: Mapping[str, Any], held: Sequence[Trajectory], swings: Sequence[Trajectory]
) -> list[Section]:
    """Sections. result : JointRunResult.model_dump(by_alias=True) (harness.joint/1). held, swings : its motions."""
    first, *rest = result["conclusions"]
    sections: list[Section] = [verdict_section(first, rest)]
    if result["scores"]:
        sections.append(scores_section(result, held, swings))
    if result["servo"] is not None:
        sections.append(servo_section(result))
    return [
        *sections,
        to_paste_section(result["paste"]),
        made_with_section(result["machine"], result["files"], result["command"]),
    ]


def scores_section(result: Mapping[str, Any], held: Sequence[Trajectory], swings: Sequence[Trajectory]) -> Section:
    """Creep and lead, in numbers and as motions."""
    slides = result["slides"]
    unit, scale = ("mm", 1e3) if slides else ("deg", float(np.degrees(1.0)))
    columns = [
        Column("creep", f"{unit}/s", "under the load; a real joint does not move"),
        Column("lead", "ms", "by which friction turns round before the speed"),
    ]
    rows, notes = [], []
    for one in result["scores"]:
        if one["error"]:
            notes.append(f"{one['engine']} {one['preset']}: {one['error']}")
            continue
        values = ((one["creep"], scale), (one["reversal_lead_s"], 1e3))
        cells = [Cell(_or_none(value, times)) for value, times in values]
        rows.append(Row(f"{one['engine']} {one['preset']}", cells, f"step {1e3 * (one['dt_s'] or 0.0):.3g} ms"))
    for one in result["as_it_is"]:
        creep = "it diverges" if one["diverges_after"] else _or_none(one["creep"], scale)
        label = f"your file itself, {one['engine']} {one['preset']}"
        rows.append(Row(label, [Cell(creep), Cell("-")], f"step {1e3 * one['dt_s']:.3g} ms"))
    figures = [
        _figure("creep", f"creep / {unit}", [(m, (m.x - m.x[0]) * scale) for m in held]),
        _figure("swing", f"swing / {unit}", [(m, m.x * scale) for m in swings]),
    ]
    return Section(
        "Creep and lead",
        "in_engines.html.j2",
        {
            "tables": [Table("engine", columns, rows, footnotes=notes)],
            "figures": [f for f in figures if f.traces],
        },
    )


def servo_section(result: Mapping[str, Any]) -> Section:
    """What a step does to the servo of the joint."""
    servo = result["servo"]
    unit = "N s/m" if result["slides"] else "N m s/rad"
    columns = [Column("false damping", unit, "beyond what was asked for"), Column("zeta")]
    rows = [
        Row(one["who"], [Cell(_or_diverges(one[name], one["stable"])) for name in ("false_damping", "zeta")])
        for one in servo["scores"]
    ]
    caption = f"It has zeta {_or_none(servo['zeta'], 1.0)}; the step is {1e3 * servo['step_s']:.3g} ms."
    return Section(
        "What the step does to its servo",
        "table.html.j2",
        {"tables": [Table("who computes it", columns, rows, caption)]},
    )


def _or_diverges(value: float | None, stable: bool) -> str:
    return _or_none(value, 1.0) if stable else "it diverges"


def _or_none(value: float | None, times: float) -> str:
    return "-" if value is None else number(value * times, 3)


def _figure(name: str, axis: str, curves: Sequence[tuple[Trajectory, Any]]) -> Figure:
    colors = of_engines([motion.source for motion, _ in curves])
    traces = []
    for (motion, y), color in zip(curves, colors, strict=True):
        thin = slice(None, None, max(1, -(-motion.t.size // _POINTS)))
        traces.append(
            {
                "type": "scatter",
                "mode": "lines",
                "name": motion.source.label,
                "x": motion.t[thin],
                "y": np.asarray(y[thin]),
                "line": {"color": color, "width": 1.8},
                "hovertemplate": "%{y:.4g}<br>%{x:.4g} s",
                "meta": {"curve": False},
            }
        )
    layout = {"xaxis": {"title": {"text": "time / s"}}, "yaxis": {"title": {"text": axis}}, "showlegend": True}
    return Figure(name, traces, layout, "", "", 300)
