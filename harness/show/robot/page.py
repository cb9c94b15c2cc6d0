"""The page of an arm that moves as a whole: friction of its joints, and the torque that is left."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.core.trajectory import Trajectory
from harness.show.numbers import number, of_engines
from harness.show.report.section import Cell, Column, Figure, Row, Section, Table
from harness.show.report.verdict import made_with_section, verdict_section
from harness.show.robot.shown import AFTER, AFTER_NAME, BEFORE, BEFORE_NAME, Left, Motion, Shown, moved_in


def to_paste_section(paste: Mapping[str, str], left_out: Sequence[str] = ()) -> Section:
    """paste : the texts for MJCF and for URDF. left_out : what those formats have no word for, a sentence each."""
    dynamics, _, calls = paste["urdf"].partition("\n")
    texts = {"MJCF, in the joint's element": paste["mjcf"], "URDF, in the joint's element": dynamics}
    if calls:
        texts["PyBullet, for what it does not read of a URDF"] = calls
    return Section("What to paste into the model", "paste.html.j2", {"texts": texts, "left_out": list(left_out)})


_AS_IT_IS, _PASTED = "the model as it is", "with what is pasted"
_ENGINE_POINTS = 4000


def in_engines_section(
    joint: str, simulated: Sequence[Mapping[str, Any]], motions: Sequence[Motion], place: str
) -> Section:
    """joint : its name. simulated : as in the result. motions : one an engine. place : rad or m."""
    columns = [
        Column("position, as it is", place, "rms of simulation minus log"),
        Column("with what is pasted", place),
        Column("speed, as it is", f"{place}/s"),
        Column("with what is pasted", f"{place}/s"),
    ]
    rows, notes = [], []
    for one in simulated:
        name = f"{one['engine']} {one['version']}".strip()
        if one["error"]:
            notes.append(f"{name}: {one['error']}")
            continue
        cells = [Cell(number(one[side][c], 3)) for c in ("x", "v") for side in ("before", "after")]
        rows.append(Row(name, cells, f"step {1e3 * one['dt_s']:g} ms, {one['windows']} windows"))
        notes += one["left_out"]
    window = next((one["window_s"] for one in simulated if one["window_s"]), None)
    caption = "" if window is None else (
        f"{joint} is driven by the torque of the log and the other joints are led along it, in windows of"
        f" {window:g} s that each begin at the smoothed log."
    )  # fmt: skip
    figures = [_engine_figure(place, motion) for motion in motions]
    return Section(
        "Your model against the log, before and after",
        "in_engines.html.j2",
        {"tables": [Table("engine", columns, rows, caption, footnotes=notes)], "figures": figures},
    )


def _engine_figure(place: str, motion: Motion) -> Figure:
    thin = slice(None, None, max(1, -(-motion.t.size // _ENGINE_POINTS)))
    t = motion.t[thin]
    traces = [
        {
            "type": "scatter",
            "mode": "lines",
            "name": said,
            "x": t,
            "y": np.asarray((y - motion.logged)[thin]),
            "line": {"color": color, "width": 1.5},
            "connectgaps": False,
            "hovertemplate": "%{y:.4g}<br>%{x:.4g} s",
            "meta": {"curve": False},
        }
        for said, y, color in ((_AS_IT_IS, motion.before, BEFORE), (_PASTED, motion.after, AFTER))
    ]
    layout = {
        "xaxis": {"title": {"text": "time / s"}},
        "yaxis": {"title": {"text": f"{motion.engine} minus log / {place}"}},
        "showlegend": True,
    }
    return Figure(f"engine-{motion.engine}", traces, layout, "", "time", 280)


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


_JOINT_POINTS = 2000


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
        thin = slice(None, None, max(1, -(-motion.t.size // _JOINT_POINTS)))
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
