"""Bars of a diagnosis: what each catalogue name takes off, what the best model leaves, whose mismatch it is."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from harness.show.diagnosis_scene import AFTER, BEFORE, best_terms
from harness.show.numbers import NONE, number
from harness.show.report.section import Cell, Column, Figure, Row, Section, Table

_GREY = "#b9c0c9"
_ROOM = 0.12
"""Of the width of a bar chart, for the number beside a short bar."""


def _percents(
    name: str,
    labels: Sequence[str],
    percent: Sequence[float],
    colors: Sequence[str],
    title: str,
    caption: str,
    errors: Sequence[float | None] = (),
) -> Figure:
    """Bars in per cent, the first on top. errors : standard errors of those that have one."""
    known = [*errors, *[None] * (len(percent) - len(errors))]
    low, high = min(0.0, *percent), max(1.0, *percent)
    beside = _ROOM * (high - low)
    trace = {
        "type": "bar",
        "orientation": "h",
        "x": list(percent)[::-1],
        "y": list(labels)[::-1],
        "marker": {"color": list(colors)[::-1]},
        "text": [
            f"{value:.3g} %" if error is None else f"{value:.3g} \u00b1 {error:.2g} %"
            for value, error in reversed(list(zip(percent, known, strict=True)))
        ],
        "textposition": ["outside" if abs(value) < beside else "auto" for value in reversed(percent)],
        "hovertemplate": "%{y}: %{x:.4g} %<extra></extra>",
    }
    limits = [low - (beside if low < 0.0 else 0.0), high + beside]
    layout = {
        "xaxis": {"title": {"text": title}, "zeroline": True, "range": limits},
        "yaxis": {"ticks": ""},
        "showlegend": False,
        "bargap": 0.35,
    }
    return Figure(name, [trace], layout, caption, "", 110 + 30 * len(labels))


def evidence_section(result: Mapping[str, Any]) -> Section:
    """result : as in harness.diagnosis/2."""
    chosen = {mechanism["name"] for mechanism in result["mechanisms"]}
    if result["evidence"] and all(one.get("share") is not None for one in result["evidence"]):
        return Section("Evidence over the catalogue", "figures.html.j2", {"figures": [_shares(result, chosen)]})
    ordered = sorted(result["evidence"], key=lambda one: float(one["delta_bic"]))
    better = [one for one in ordered if one["delta_bic"] > 1.0]
    others = [one["name"] for one in reversed(ordered) if one["delta_bic"] <= 1.0]
    none = f" No better than the base model alone: {', '.join(others)}." if others else ""
    if not better:
        return Section(
            "Evidence over the catalogue",
            "figures.html.j2",
            {
                "figures": [
                    Figure("evidence", [], {}, f"No catalogue name does better than the base model.{none}", "", 40)
                ]
            },
        )
    trace = {
        "type": "bar",
        "orientation": "h",
        "x": [float(one["delta_bic"]) for one in better],
        "y": [one["name"] for one in better],
        "marker": {"color": [AFTER if one["name"] in chosen else _GREY for one in better]},
        "text": [f"{one['delta_bic']:.0f}" for one in better],
        "textposition": "auto",
        "hovertemplate": "%{y}: %{x:.5g}<extra></extra>",
    }
    layout = {
        "xaxis": {
            "title": {"text": "BIC gained"},
            "type": "log",
            "range": [0.0, math.log10(1.3 * float(better[-1]["delta_bic"]))],
            "dtick": 1,
        },
        "yaxis": {"ticks": ""},
        "showlegend": False,
        "bargap": 0.35,
    }
    caption = (
        "Each catalogue name tried alone against viscous and Coulomb friction; 10 is decisive. Blue: in the "
        f"refined model. With two effects, a name that explains neither alone can still do well here.{none}"
    )
    return Section(
        "Evidence over the catalogue",
        "figures.html.j2",
        {"figures": [Figure("evidence", [trace], layout, caption, "", 110 + 24 * len(better))]},
    )


def _shares(result: Mapping[str, Any], chosen: set[str]) -> Figure:
    """Where names are graded: the share of the misfit, which says more than a BIC that counts samples."""
    ordered = sorted(result["evidence"], key=lambda one: -float(one["share"]))
    caption = (
        "Each catalogue name tried alone against viscous and Coulomb friction: share of the mean square misfit "
        "beyond noise that it takes off. Blue: named."
    )
    return _percents(
        "evidence",
        [one["name"] for one in ordered],
        [100.0 * float(one["share"]) for one in ordered],
        [AFTER if one["name"] in chosen else _GREY for one in ordered],
        "share of the misfit / %",
        caption,
    )


_DEPENDS = {
    "x": "position",
    "v": "speed",
    "t": "time",
    "direction": "direction of motion",
    "amplitude": "amplitude",
}


def left_section(result: Mapping[str, Any]) -> Section:
    """What the best model found leaves. result : as in harness.diagnosis/2, with a remainder."""
    rest = result["remainder"]
    said = rest["looks_like"]
    best = f"with {best_terms(result)}" if result["mechanisms"] else "viscous and Coulomb"
    sentence = (
        f"The best model found ({best}) leaves {number(100.0 * rest['share'], 3)} % of the misfit; its residual is "
        f"{number(rest['over_noise'], 3)} times the sensors' noise. {said[0].upper()}{said[1:]}."
    )
    percent = [100.0 * float(rest["depends_on"].get(name, 0.0)) for name in _DEPENDS]
    caption = (
        "Share of the residual that is a function of one quantity alone; the bars overlap and need not add up to "
        "100 %. What is a function of none of them is no law of this motion, or of several together."
    )
    colors = ["#b58900"] * len(percent)
    title = "share of the residual / %"
    return Section(
        "What is left",
        "left.html.j2",
        {
            "sentence": sentence,
            "figures": [_percents("remainder", list(_DEPENDS.values()), percent, colors, title, caption)],
        },
    )


def shares_section(attribution: Mapping[str, Any]) -> Section:
    """attribution : as in harness.diagnosis/2."""
    found, stderr = attribution, attribution.get("stderr") or {}
    names = [name for name in _PARTS if found[name] is not None and not (name == "engine" and found.get("why"))]
    called = {name: name.replace("_", " ") for name in names}
    if found.get("why"):
        called["parameters"] = "engine and parameters"
    bars = found.get("bars") or [{"of": [n], "name": called[n], "share": found[n]} for n in names]
    caption = f"Compared with the recording: {found['configuration']}, in windows of about a period."
    if any(len(bar["of"]) > 1 for bar in bars):
        caption += " Errors that make up for each other are one bar."
    if found.get("why"):
        caption += f" Engine and parameters are one: {found['why']}."
    figure = _percents(
        "attribution",
        [bar["name"] for bar in bars],
        [100.0 * float(bar["share"]) for bar in bars],
        [_PARTS[bar["of"][0]] for bar in bars],
        "part of the mean square mismatch / %",
        caption,
    )
    rows = []
    for name in names:
        error = NONE if name not in stderr else number(100.0 * float(stderr[name]), 2)
        rows.append(Row(called[name], [Cell(number(100.0 * float(found[name]), 3)), Cell(error)]))
    note = (
        "What each brings when all are put right in turn, averaged over the orders; below 0: its error hides that"
        " of another."
    )
    columns = [Column("share", "%"), Column("standard error", "points")]
    return Section(
        "Whose mismatch it is", "shares.html.j2", {"figures": [figure], "table": Table("part", columns, rows, note)}
    )


_PARTS = {
    "engine": BEFORE,
    "parameters": "#b58900",
    "missing_physics": AFTER,
    "unexplained": "#a45bc2",
    "noise": _GREY,
}
"""Parts of a mismatch, by name, with their colours."""
