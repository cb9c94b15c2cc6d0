"""The page and the trace of an arm that moves as a whole: friction of its joints, and the torque that is left."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.show import scene as s
from harness.show.axes import padded, plane_grid, roomy
from harness.show.numbers import number
from harness.show.report.figure import Figure
from harness.show.report.section import Section
from harness.show.report.sources import MadeWith
from harness.show.report.table import Cell, Column, Row, Table
from harness.show.report.verdict import Verdict

Left = Mapping[str, NDArray[np.float64]]
"""By joint: t, q, v, torque left by the base and by the model, (m, 5)."""
BEFORE, AFTER = "#e4632d", "#2b7fd6"
_POINTS, _MEANS = 6000, 48


def arm_sections(result: Mapping[str, Any], left: Left) -> list[Section]:
    """Sections. result : DiagnosisResult.model_dump(mode="json", by_alias=True) of a whole arm."""
    robot = result["robot"]
    paste = [robot["paste"]["mjcf"], *robot["paste"]["urdf"].splitlines()]
    pairs = [" and ".join(pair) for pair in robot["confounded"]]
    sections: list[Section] = [
        Verdict(result["statement"], result["warnings"]),
        Torque(robot["joint"], left, result["baseline"]["parameters"]["f_k"]["unit"]),
        Joints(robot["arm"]["joints"], robot["joint"]),
        Found(robot["arm"]["found"]),
    ]
    if pairs:
        sections.append(Verdict("", pairs, heading="What this log cannot tell apart"))
    return [
        *sections,
        Verdict("", paste, heading="What to paste into the model (MJCF; URDF with PyBullet's calls)"),
        MadeWith(result["machine"], result["files"], result["command"]),
    ]


@dataclass(frozen=True)
class Torque(Section):
    """joint : whose torque is drawn. unit : of it, of a hinge N m."""

    template: ClassVar[str] = "figures.html.j2"
    joint: str
    left: Left
    unit: str

    @property
    def title(self) -> str:
        """The heading."""
        return f"Torque that is left of {self.joint}"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        if self.joint not in self.left:
            return {"figures": []}
        rows = _thinned(self.left[self.joint])
        figures, place = [], _place(self.unit)
        for name, at, unit in (("speed", 2, f"{place}/s"), ("position", 1, place)):
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
                for said, column, color in (("base", 3, BEFORE), ("with what is named", 4, AFTER))
            ]
            layout = {
                "xaxis": {"title": {"text": f"{name} / ({unit})" if "/" in unit else f"{name} / {unit}"}},
                "yaxis": {"title": {"text": f"torque left / ({self.unit})"}},
                "showlegend": True,
            }
            caption = "Guarded samples: the torque minus the rigid model, Coulomb and viscous friction and an offset."
            figures.append(Figure(f"left-{name}", traces, layout, caption if name == "speed" else "", "", 340))
        return {"figures": figures}


@dataclass(frozen=True)
class Joints(Section):
    """joints : as in the result. first : the one that was asked for."""

    template: ClassVar[str] = "table.html.j2"
    joints: list[Mapping[str, Any]]
    first: str

    @property
    def title(self) -> str:
        """The heading."""
        return "Friction of every joint"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
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
                "asked for" if one["joint"] == self.first else "",
            )
            for one in self.joints
        ]
        return {"tables": [Table("joint", columns, rows)]}


def _quantity(p: Mapping[str, Any]) -> Cell:
    if p["value"] is None:
        return Cell("-", (p.get("why") or "",))
    notes = () if p["stderr"] is None else (f"\u00b1 {p['stderr']:.2g}",)
    return Cell(number(p["value"], 4), (*notes, p["unit"]))


@dataclass(frozen=True)
class Found(Section):
    """found : everything named, of friction and of the model."""

    template: ClassVar[str] = "table.html.j2"
    found: list[Mapping[str, Any]]

    @property
    def title(self) -> str:
        """The heading."""
        return "What is named beside it"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
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
            for one in self.found
        ]
        return {"tables": [Table("name", columns, rows)] if rows else []}


def arm_scene(result: Mapping[str, Any], left: Left, notes: str) -> s.Scene:
    """The trace: torque that is left of each joint over time, and of the one asked for over its speed."""
    items: list[s.Item] = [s.Page("/notes", notes)]
    plots: list[s.Layout] = []
    for joint, rows in left.items():
        slug = "".join(c if c.isalnum() else "-" for c in joint)
        t, before, after = rows[:, 0], rows[:, 3], rows[:, 4]
        items.append(s.Marks(f"/left/{slug}/base", "base", t, before, BEFORE, 2.0))
        items.append(s.Marks(f"/left/{slug}/model", "with what is named", t, after, AFTER, 2.0))
        plots.append(s.Plot(f"torque left of {joint}", [f"/left/{slug}"], roomy([before, after])))
    side: list[s.Layout] = [s.Words("verdict", "/notes")]
    unit = result["baseline"]["parameters"]["f_k"]["unit"]
    if result["robot"]["joint"] in left:
        rows = left[result["robot"]["joint"]]
        means = _means(rows)
        v, torque = means[:, 2], means[:, 3:]
        scale = float(np.ptp(v)) / max(float(np.ptp(torque)), 1e-300)
        for name, column, color in (("base", 3, BEFORE), ("with what is named", 4, AFTER)):
            points = np.column_stack((v, means[:, column] * scale))
            moving = np.column_stack((rows[:, 2], np.interp(rows[:, 2], v, points[:, 1])))
            items.append(s.Orbit(f"/speed/{column}", name, points, color, (rows[:, 0], moving)))
        x, y = padded([v], 0.06), padded([torque[:, 0] * scale, torque[:, 1] * scale], 0.06)
        items.append(
            plane_grid(
                "/speed/axes", x, y, (f"speed / ({_place(unit)}/s)", 1.0), (f"torque left / ({unit})", 1.0 / scale)
            )
        )
        side.append(s.Plane("torque left over speed, means", ["/speed"], x, y))
    layout = s.Columns([s.Rows(plots, [1.0] * len(plots)), s.Rows(side)], [3.0, 2.0]) if plots else s.Rows(side)
    title = f"joints of {result['robot']['file'].rpartition('/')[2]}"
    return s.Scene(title, items, layout, {}, {"result": dict(result), "notes": {"text": notes}})


def _place(unit: str) -> str:
    """Unit of the position of a joint whose torque has this one: N m of a hinge, N of a slide."""
    return "rad" if "m" in unit else "m"


def _means(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Means of the rows over stretches of speed that hold equally many, by speed."""
    ordered = rows[np.argsort(rows[:, 2])]
    return np.array([part.mean(axis=0) for part in np.array_split(ordered, min(_MEANS, len(rows)))])


def _thinned(rows: NDArray[np.float64]) -> NDArray[np.float64]:
    return rows[:: max(1, -(-rows.shape[0] // _POINTS))]
