"""The user's model before and after, driven by the log's torque in engines: how far it goes from the log."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.show.numbers import number
from harness.show.report.figure import Figure
from harness.show.report.section import Section
from harness.show.report.table import Cell, Column, Row, Table
from harness.show.robot.shown import AFTER, BEFORE, Motion

_AS_IT_IS, _PASTED = "the model as it is", "with what is pasted"
_POINTS = 4000


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
    figures = [_figure(place, motion) for motion in motions]
    return Section(
        "Your model against the log, before and after",
        "in_engines.html.j2",
        {"tables": [Table("engine", columns, rows, caption, footnotes=notes)], "figures": figures},
    )


def _figure(place: str, motion: Motion) -> Figure:
    thin = slice(None, None, max(1, -(-motion.t.size // _POINTS)))
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
