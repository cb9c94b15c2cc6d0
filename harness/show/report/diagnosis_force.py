"""Forces without a name, drawn: each table with its band over the range that was swept."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from harness.show.report.figure import Figure
from harness.show.report.section import Section

_COLOR, _BAND = "#e4632d", "rgba(228, 99, 45, 0.18)"
_ERRORS = 2.0
"""Standard errors of a band."""


def tables_section(result: Mapping[str, Any]) -> Section:
    """What has no name, as curves. result : as in harness.diagnosis/2, with tables."""
    figures = [_figure(i, table) for i, table in enumerate(result["tables"])]
    if (surface := result.get("surface")) is not None:
        figures.append(_plane(surface))
    return Section("Force without a name", "figures.html.j2", {"figures": figures})


def _figure(number: int, table: Mapping[str, Any]) -> Figure:
    at, force, stderr = (np.array(table[key]) for key in ("at", "force", "stderr"))
    label = {"x": "displacement", "v": "speed", "|v|": "speed, either way"}[table["of"]]
    at_unit, unit = _unit(table["at_unit"]), _unit(table["force_unit"])
    plain: dict[str, Any] = {"type": "scatter", "mode": "lines", "x": at, "hoverinfo": "skip", "showlegend": False}
    line = {"width": 0}
    traces = [
        {**plain, "y": force - _ERRORS * stderr, "line": line},
        {**plain, "y": force + _ERRORS * stderr, "line": line, "fill": "tonexty", "fillcolor": _BAND},
        {
            "type": "scatter",
            "mode": "lines",
            "name": table["form"],
            "x": at,
            "y": force,
            "line": {"color": _COLOR, "width": 2},
            "hovertemplate": "%{x:.4g}: %{y:.4g}<extra></extra>",
        },
    ]
    layout = {
        "xaxis": {"title": {"text": f"{label} / {at_unit}"}},
        "yaxis": {"title": {"text": f"{table['form']} / {unit}"}},
        "showlegend": False,
        "hovermode": "closest",
    }
    near = ", ".join(f"{one['name']} ({100.0 * one['share']:.0f} % of it)" for one in table["nearest"])
    said = table["described"]
    caption = (
        f"{said[:1].upper()}{said[1:]}. On the left of the equation of motion, with two standard errors, over the "
        f"range that was swept; beyond it nothing is known. The table holds {table['gauge']}."
        f"{f' Nearest in the catalogue: {near}.' if near else ''}"
    )
    return Figure(f"table-{number}", traces, layout, caption, height=320)


def _plane(surface: Mapping[str, Any]) -> Figure:
    """A force over both: coloured where the motion was, its error below the pointer."""
    force, stderr = (np.array(surface[key], dtype=np.float64) for key in ("force", "stderr"))
    x_unit, v_unit, unit = (_unit(surface[key]) for key in ("x_unit", "v_unit", "force_unit"))
    most = float(np.nanmax(np.abs(force)))
    trace = {
        "type": "heatmap",
        "x": np.array(surface["x"]),
        "y": np.array(surface["v"]),
        "z": surface["force"],
        "customdata": surface["stderr"],
        "zmin": -most,
        "zmax": most,
        "colorscale": [[0.0, "#2f6fb0"], [0.5, "#f4f1ea"], [1.0, _COLOR]],
        "hoverongaps": False,
        "colorbar": {"title": {"text": unit}},
        "hovertemplate": "%{x:.4g}, %{y:.4g}: %{z:.3g} \u00b1 %{customdata:.2g}<extra></extra>",
    }
    layout = {
        "xaxis": {"title": {"text": f"displacement / {x_unit}"}},
        "yaxis": {"title": {"text": f"speed / {v_unit}"}},
        "hovermode": "closest",
    }
    said, error = surface["described"], float(np.nanmedian(stderr))
    caption = (
        f"{said[:1].upper()}{said[1:]}. On the left of the equation of motion; one standard error is {error:.2g} {unit}"
        " in the middle, and stands below the pointer. Blank where the motion never was: there nothing is known. The"
        f" table holds {surface['gauge']}."
    )
    return Figure("table-plane", [trace], layout, caption, height=420)


def _unit(unit: str) -> str:
    return f"({unit})" if "/" in unit or " " in unit else unit
