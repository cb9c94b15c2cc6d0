"""The page of an arm that moves as a whole: friction of its joints, and the torque that is left."""

from collections.abc import Mapping
from typing import Any

from harness.show.numbers import number
from harness.show.report.figure import Figure
from harness.show.report.section import Section
from harness.show.report.sources import made_with_section
from harness.show.report.table import Cell, Column, Row, Table
from harness.show.report.verdict import verdict_section
from harness.show.robot.in_engines import in_engines_section
from harness.show.robot.shown import AFTER, AFTER_NAME, BEFORE, BEFORE_NAME, Left, Shown, moved_in
from harness.show.robot.to_paste import to_paste_section

_POINTS = 6000


def arm_sections(result: Mapping[str, Any], shown: Shown) -> list[Section]:
    """Sections. result : DiagnosisResult.model_dump(mode="json", by_alias=True) of a whole arm."""
    robot = result["robot"]
    torque, *more = robot_sections(result, shown)
    return [
        verdict_section(result["statement"].replace("+-", "\u00b1"), result["warnings"]),
        torque,
        joints_section(robot["arm"]["joints"], robot["joint"]),
        found_section(robot["arm"]["found"]),
        *more,
        made_with_section(result["machine"], result["files"], result["command"]),
    ]


def robot_sections(result: Mapping[str, Any], shown: Shown) -> list[Section]:
    """What is said of any robot's joint: torque that is left, engines against the log, pairs, what to paste."""
    robot = result["robot"]
    unit = result["baseline"]["parameters"]["f_k"]["unit"]
    pairs = [" and ".join(pair) for pair in robot["confounded"]]
    sections: list[Section] = [torque_section(robot["joint"], shown.left, unit)]
    if robot["simulated"]:
        sections.append(in_engines_section(robot["joint"], robot["simulated"], shown.motions, moved_in(unit)))
    if pairs:
        sections.append(verdict_section("", pairs, heading="What this log cannot tell apart"))
    if robot.get("match"):
        sections.append(matches_section(robot["match"]))
    return [*sections, to_paste_section(robot["paste"], result["model_left_out"])]


def match_sections(result: Mapping[str, Any]) -> list[Section]:
    """Of a log that does not go together with its model."""
    return [
        verdict_section(result["statement"], result["warnings"]),
        matches_section(result["robot"]["match"]),
        made_with_section(result["machine"], result["files"], result["command"]),
    ]


def matches_section(match: list[Mapping[str, Any]]) -> Section:
    """match : as in the result."""
    columns = [
        Column("by", "", "what loads the joint"),
        Column("correlation", "", "of logged and modelled torque"),
        Column("slope", "", "logged over modelled torque"),
        Column("offset"),
        Column("what looks wrong"),
    ]
    rows = [
        Row(
            one["joint"],
            [
                Cell(one["by"] or "-"),
                *(Cell("-" if one[name] is None else number(one[name], 3)) for name in ("correlation", "slope")),
                Cell(number(one["offset"], 3)),
                Cell(one["suspicion"] or "-", (one["option"],) if one["option"] else ()),
            ],
        )
        for one in match
    ]
    return Section(
        "The log against its model", "table.html.j2", {"tables": [Table("joint", columns, rows)] if rows else []}
    )


def torque_section(joint: str, left: Left, unit: str) -> Section:
    """joint : whose torque is drawn. unit : of it, of a hinge N m."""
    if joint not in left:
        return Section(f"Torque that is left of {joint}", "figures.html.j2", {"figures": []})
    rows = left[joint]
    rows = rows[:: max(1, -(-rows.shape[0] // _POINTS))]
    figures, place = [], moved_in(unit)
    for name, at, along in (("speed", 2, f"{place}/s"), ("position", 1, place)):
        traces = [
            {
                "type": "scatter",
                "mode": "markers",
                "name": said,
                "x": rows[:, at],
                "y": rows[:, column],
                "marker": {"size": 4, "color": color, "opacity": 0.6},
                "hovertemplate": "%{y:.4g}<br>%{x:.4g}",
                "meta": {"curve": False},
            }
            for said, column, color in ((BEFORE_NAME, 3, BEFORE), (AFTER_NAME, 4, AFTER))
        ]
        layout = {
            "xaxis": {"title": {"text": f"{name} / ({along})" if "/" in along else f"{name} / {along}"}},
            "yaxis": {"title": {"text": f"torque left / ({unit})"}},
            "showlegend": True,
        }
        caption = "Guarded samples: the torque minus the rigid model, Coulomb and viscous friction and an offset."
        figures.append(Figure(f"left-{name}", traces, layout, caption if name == "speed" else "", "", 340))
    return Section(f"Torque that is left of {joint}", "figures.html.j2", {"figures": figures})


def joints_section(joints: list[Mapping[str, Any]], first: str) -> Section:
    """joints : as in the result. first : the one that was asked for."""
    columns = [
        Column("Coulomb"),
        Column("viscous"),
        Column("offset"),
        Column("left, base", "", "rms of torque that was not fitted"),
        Column("left, model", "", "the same with everything named"),
        Column("over noise", "", "rms of what is left over that of the torque's noise"),
    ]
    rows = [
        Row(
            one["joint"],
            [
                *(_quantity(one[name]) for name in ("f_k", "c", "offset")),
                *(Cell(number(one[name], 3)) for name in ("held_out_before", "held_out_after", "over_noise")),
            ],
            "asked for" if one["joint"] == first else "",
        )
        for one in joints
    ]
    return Section("Friction of every joint", "table.html.j2", {"tables": [Table("joint", columns, rows)]})


def _quantity(p: Mapping[str, Any]) -> Cell:
    if p["value"] is None:
        return Cell("-", (p.get("why") or "",))
    notes = () if p["stderr"] is None else (f"\u00b1 {p['stderr']:.2g}",)
    return Cell(number(p["value"], 4), (*notes, p["unit"]))


def found_section(found: list[Mapping[str, Any]]) -> Section:
    """found : everything named, of friction and of the model."""
    columns = [Column("of"), Column("or"), Column("grade"), Column("takes off", "%"), Column("evidence")]
    rows = [
        Row(
            one["name"],
            [
                Cell(one["joint"] or "the arm"),
                Cell(", ".join(filter(None, (one["partner"], *one["rivals"]))) or "-"),
                Cell(one["grade"]),
                Cell(f"{100.0 * one['share']:.0f}"),
                Cell(number(one["evidence"], 3)),
            ],
        )
        for one in found
    ]
    return Section(
        "What is named beside it", "table.html.j2", {"tables": [Table("name", columns, rows)] if rows else []}
    )
