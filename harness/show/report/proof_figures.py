"""Plots of a proof: figures with their intervals, and what was said of what was hidden."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.show.report.section import Figure, Section

Data = Mapping[str, Any]
GOOD, BAD = "#1f9e77", "#d1495b"
NOTHING, CANNOT_TELL, ABSENT, SEVERAL = "nothing", "cannot tell", "no result", "several names"
OUTSIDE = "alien-"


def interval_figure(name: str, rows: Sequence[Data], caption: str, height: int | None = None) -> Figure:
    """Shares as dots with their intervals, one a line.

    rows : ("label", "value", "low", "high", "color", "note") each, shares of 1; the first is drawn on top.
    """
    shown = [row for row in rows if row["value"] is not None]
    traces = [
        {
            "type": "scatter",
            "mode": "markers",
            "x": np.array([100.0 * row["value"] for row in shown]),
            "y": [row["label"] for row in shown],
            "error_x": {
                "type": "data",
                "symmetric": False,
                "array": [100.0 * (row["high"] - row["value"]) for row in shown],
                "arrayminus": [100.0 * (row["value"] - row["low"]) for row in shown],
                "color": "muted",
                "thickness": 1.4,
                "width": 3,
            },
            "marker": {"color": [row["color"] for row in shown], "size": 8},
            "text": [row["note"] for row in shown],
            "hovertemplate": "%{y}: %{x:.1f} %<br>%{text}<extra></extra>",
            "showlegend": False,
        }
    ]
    layout = {
        "xaxis": {"title": {"text": "%"}, "range": [-2, 102], "zeroline": False},
        "yaxis": {"autorange": "reversed", "type": "category", "ticks": ""},
        "margin": {"l": 64, "r": 16, "t": 12, "b": 42},
    }
    return Figure(name, traces, layout, caption, height=height or 90 + 22 * len(shown))


def by_name_section(rates: Mapping[str, Data], not_tested: Sequence[str]) -> Section:
    """rates : share named by name. not_tested : names that did not occur."""
    rows = [
        {
            "label": name,
            **rate,
            "note": f"{rate['hits']} of {rate['cases']}",
            "color": GOOD if rate["hits"] == rate["cases"] else BAD if rate["value"] < 0.5 else "#d99a2b",
        }
        for name, rate in rates.items()
    ]
    caption = "Single effects that were named, with exact 95 % intervals. Green: every one of them."
    figures = [interval_figure("by-name", rows, caption)] if rows else []
    return Section("Name by name", "proof_names.html.j2", {"figures": figures, "not_tested": not_tested})


def confusion_section(counts: Mapping[str, Mapping[str, int]], order: Sequence[str]) -> Section:
    """counts : what was hidden -> what was said -> recordings. order : names of the catalogue in their order."""
    alone = {true: said for true, said in counts.items() if " + " not in true}
    outside = sorted(true for true in alone if true.startswith(OUTSIDE))
    rows = [name for name in (NOTHING, *order) if name in alone] + outside
    said = {_column(order, label) for labels in alone.values() for label in labels}
    columns = [NOTHING, *(name for name in order if name in said or name in alone)]
    columns += [name for name in (SEVERAL, CANNOT_TELL, ABSENT) if name in said or name == CANNOT_TELL]
    right, wrong = _shares(order, alone, rows, columns)
    notes = [
        {"x": column, "y": row, "text": str(count), "showarrow": False, "font": {"size": 11, "color": "ink"}}
        for row in rows
        for column, count in _counts(order, alone[row]).items()
    ]
    traces = [_heat(right, rows, columns, GOOD), _heat(wrong, rows, columns, BAD)]
    layout = {
        "xaxis": {"side": "top", "tickangle": -50, "type": "category", "ticks": "", "showgrid": False},
        "yaxis": {"autorange": "reversed", "type": "category", "ticks": ""},
        "annotations": notes,
        "margin": {"l": 64, "r": 16, "t": 150, "b": 12},
    }
    caption = (
        "A line for what was hidden, a column for what was said; recordings, coloured by their share of the line: "
        "green where the answer is right, red where it is wrong. For effects that no catalogue holds (alien-...) "
        "saying that it cannot tell is right, and so is a name of the same family, here in red none the less."
    )
    return Section(
        "What was hidden, what was said",
        "figures.html.j2",
        {"figures": [Figure("confusion", traces, layout, caption, height=190 + 21 * len(rows))]},
    )


def _column(order: Sequence[str], label: str) -> str:
    return label if label in (NOTHING, CANNOT_TELL, ABSENT) or label in order else SEVERAL


def _counts(order: Sequence[str], said: Mapping[str, int]) -> dict[str, int]:
    found: dict[str, int] = {}
    for label, count in said.items():
        column = _column(order, label)
        found[column] = found.get(column, 0) + count
    return found


def _shares(
    order: Sequence[str], alone: Mapping[str, Mapping[str, int]], rows: Sequence[str], columns: Sequence[str]
) -> tuple[list[list[float | None]], list[list[float | None]]]:
    right: list[list[float | None]] = []
    wrong: list[list[float | None]] = []
    for row in rows:
        counts, total = _counts(order, alone[row]), sum(alone[row].values())
        good = CANNOT_TELL if row.startswith(OUTSIDE) else row
        shares = [counts[column] / total if column in counts else None for column in columns]
        right.append([share if column == good else None for share, column in zip(shares, columns, strict=True)])
        wrong.append([share if column != good else None for share, column in zip(shares, columns, strict=True)])
    return right, wrong


def _heat(shares: list[list[float | None]], rows: Sequence[str], columns: Sequence[str], color: str) -> dict[str, Any]:
    red, green, blue = (int(color[i : i + 2], 16) for i in (1, 3, 5))
    return {
        "type": "heatmap",
        "z": shares,
        "x": list(columns),
        "y": list(rows),
        "zmin": 0.0,
        "zmax": 1.0,
        "colorscale": [[0.0, f"rgba({red},{green},{blue},0.12)"], [1.0, f"rgba({red},{green},{blue},0.75)"]],
        "showscale": False,
        "xgap": 1,
        "ygap": 1,
        "hoverongaps": False,
        "hovertemplate": "hidden: %{y}<br>said: %{x}<br>%{z:.0%} of the line<extra></extra>",
    }


def detection_curve_section(curve: Data) -> Section:
    """curve : "detection" of harness.proof/1."""
    levels = [level for level in curve["levels"] if level["named"]["value"] is not None]
    rates = [level["named"] for level in levels]
    traces: list[dict[str, Any]] = [
        {
            "type": "scatter",
            "mode": "lines+markers",
            "name": "named",
            "x": np.array([level["loss"] for level in levels]),
            "y": np.array([100.0 * rate["value"] for rate in rates]),
            "error_y": {
                "type": "data",
                "symmetric": False,
                "array": [100.0 * (rate["high"] - rate["value"]) for rate in rates],
                "arrayminus": [100.0 * (rate["value"] - rate["low"]) for rate in rates],
                "color": "muted",
                "thickness": 1.4,
                "width": 4,
            },
            "text": [f"{rate['hits']} of {rate['cases']}" for rate in rates],
            "hovertemplate": "loss %{x:.4g}: %{y:.0f} %<br>%{text}<extra></extra>",
            "line": {"color": GOOD, "width": 2},
            "marker": {"size": 8},
        }
    ]
    for name, at, dash, color in (
        ("half are named", curve["half"], "dash", GOOD),
        ("what BIC charges", curve["limit"], "dot", "ink"),
    ):
        if at is not None:
            line = {"color": color, "width": 1.4, "dash": dash}
            traces.append(
                {"type": "scatter", "mode": "lines", "name": name, "x": [at, at], "y": [0, 100], "line": line}
            )
    layout = {
        "xaxis": {
            "type": "log",
            "exponentformat": "power",
            "title": {"text": "likelihood loss without the effect"},
        },
        "yaxis": {"title": {"text": "named / %"}, "range": [-3, 103]},
    }
    return Section(
        "Where naming stops",
        "figures.html.j2",
        {"figures": [Figure("detection", traces, layout, _caption(curve), height=380)]},
    )


def _caption(curve: Data) -> str:
    half = curve["half"]
    said = "The curve does not cross a half."
    if half is not None:
        said = f"Half are named at a loss of {half:.0f} ({curve['low']:.0f} to {curve['high']:.0f})."
    return (
        "The same cases under growing noise, from right to left. What a recording holds of an effect is the "
        "chi-square that the best model without it loses; below the dotted line BIC charges more for its numbers "
        f"than that, and nobody who goes by BIC can name it. {said}"
    )
