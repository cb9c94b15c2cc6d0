"""The page of a sweep: scorecard, error against cost, convergence, creep, lift, worst traces."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from harness.results.common import Machine
from harness.show.blocks import (
    Block,
    Cell,
    Column,
    Figure,
    Folded,
    Row,
    Section,
    Table,
    Text,
    by,
    grade,
    tabulated,
    verdict,
)
from harness.show.numbers import number
from harness.show.plots import Trace, axes, dots, plain
from harness.show.report.page import made_with

Data = Mapping[str, Any]
ROUTES = {
    "joint": "Joint friction",
    "contact": "Contact friction: a box on a floor",
    "law": "The neutral clipped force law",
}
_COLORS = ("#e4632d", "#2b7fd6", "#1f9e77", "#a45bc2", "#b58900", "#d6457f", "#4bb3c4", "#7a8c2e", "#8c6d5a", "#777777")
_MARKS = {"as-shipped": "circle-open", "tuned": "diamond"}
_LOG = {"type": "log", "exponentformat": "power", "dtick": 1}
STEPS = (1e-4, 2e-3, 1e-2, 5e-2)
"""Relative distances from exact at which the colour changes."""
_SILENT = (
    "These are words and settings of friction that an engine takes and does not act on, or acts on unasked. The "
    "versions are those it was found in, and docs/fidelity.md names the test of each."
)


def sweep_sections(data: Data) -> list[Section]:
    """Sections of the page; data : as harness.app.sweep.report makes it."""
    silent = [f"{one['engine']}: {one['what']}." for one in data["silent"]]
    return [
        verdict(data["headline"], heading="Conclusions"),
        _scorecard(data["cards"], data["figures"]),
        verdict("", data["sentences"], data["about"], "What to change, and what stays wrong"),
        _pareto(data["points"]),
        _orders(data["orders"]),
        _creep(data["creep"]),
        *([_lift(data["lift"])] if data["lift"] else []),
        *([_worst(data["worst"])] if data["worst"] else []),
        _servos(**data["servo"]),
        verdict("", [*silent, _SILENT], [one["engine"] for one in data["silent"]], "Words that do nothing"),
        made_with(Machine.model_validate(data["machine"]), data["files"], data["command"]),
    ]


def engine_color(engine: str, engines: Sequence[str]) -> str:
    """The colour of an engine among these."""
    return _COLORS[list(engines).index(engine) % len(_COLORS)]


def _scorecard(cards: Sequence[Data], figures: Sequence[Data]) -> Section:
    """cards : a line each ("engine", "version", "route", "preset", "step", "settings", "values", "physical", "errors").

    figures : a column each ("label", "good").
    """
    caption = (
        "Distance from the exact answer, relative, as shipped beside tuned: green is as good as exact (below "
        "0.01 %), red is off by more than 5 %. Small, below it, the measured value. What a column means, and every "
        "setting behind a figure, shows on hovering."
    )
    tables: list[Table] = []
    for route, title in ROUTES.items():
        lines = [card for card in cards if card["route"] == route]
        used = [one for one in figures if any(card["values"].get(one["label"]) is not None for card in lines)]
        notes = [f"{card['engine']} {card['preset']}: {text}" for card in lines for text in card["errors"]]
        for group in dict.fromkeys(one["group"] for one in used):
            here = [one for one in used if one["group"] == group]
            tables.append(
                tabulated(
                    "engine",
                    [Column(one["label"], by(one["label"], _scored), "", one["good"]) for one in here],
                    lines,
                    lambda card: f"{card['engine']} {card['preset']}",
                    lambda card: f"{card['version']}, {card['step']}",
                    _color,
                    caption="" if tables else caption,
                    title=f"{title}: {group}",
                    footnotes=notes,
                )
            )
            notes = []
    return Section("Scorecard", tables or [Text("There is nothing to show.")])


def _scored(card: Data, label: str) -> Cell:
    """The cell of a figure."""
    value, physical = card["values"].get(label), card["physical"].get(label)
    text = number(None) if value is None else f"{number(100.0 * value, 2)} %"
    return Cell(text, (physical,) if physical else (), grade(value, STEPS), card["settings"])


def _color(one: Data) -> str:
    return str(one["color"])


def _about(one: Data) -> str:
    return f"{one['version']}, {one['settings']}"


def _pareto(points: Sequence[Data]) -> Section:
    """points : ("engine", "version", "route", "preset", "settings", "cost", "error", "best") each."""
    figures = []
    for route, title in ROUTES.items():
        here = [point for point in points if point["route"] == route]
        if not here:
            continue
        traces = [
            _points([one for one in here if one["engine"] == name]) for name in dict.fromkeys(p["engine"] for p in here)
        ]
        best = sorted((point for point in here if point["best"]), key=lambda point: float(point["cost"]))
        cost, error = (np.array([point[name] for point in best]) for name in ("cost", "error"))
        line = {"color": "muted", "width": 1, "dash": "dot", "shape": "hv"}
        traces.append(plain("nothing is both cheaper and better", cost, error, "muted", line=line, hoverinfo="skip"))
        layout = axes("wall time for one second of motion / s", "score", margin={"l": 70, "r": 16, "t": 64, "b": 44})
        layout["title"] = {"text": title, "font": {"size": 13}, "x": 0.01, "y": 0.99}
        for axis in ("xaxis", "yaxis"):
            layout[axis] |= _LOG
        caption = (
            "The score is the geometric mean of the figures of the scorecard over all scenarios of a setting "
            "(each at least 1e-6): lower is better. Open circles ship, diamonds are tuned, dots are other settings."
        )
        figures.append(Figure(f"pareto-{route}", traces, layout, caption, height=400))
    return Section("Error against cost", figures)


def _points(mine: Sequence[Data]) -> Trace:
    """Points of one engine."""
    name = f"{mine[0]['engine']} {mine[0]['version']}"
    marks = [_MARKS.get(point["preset"], "circle") for point in mine]
    cost, error = (np.array([point[key] for point in mine]) for key in ("cost", "error"))
    hover = "%{text}<br>%{x:.3g}, %{y:.3g}<extra>" + f"{name}</extra>"
    marker = {"color": mine[0]["color"], "size": 9, "symbol": marks}
    return dots(name, cost, error, marker, hover, text=[point["settings"] for point in mine])


def _orders(orders: Sequence[Data]) -> Section:
    """orders : as in harness.sweep/1, with "color"."""
    blocks: list[Block] = []
    for scenario, what in (("free-decay-no-friction", "without friction"), ("free-decay", "with friction")):
        traces = [
            plain(
                f"{one['engine']} {one['preset']}, {one['integrator']}",
                np.array(one["dt_s"]) * 1e3,
                np.array(one["error"]) * 1e3,
                one["color"],
                mode="lines+markers",
                line={"color": one["color"], "dash": "dash" if one["preset"] == "as-shipped" else "solid"},
                hovertemplate=f"{one['version']}, order {one['order']:.2f}<br>%{{x:.3g}} ms: %{{y:.3g}} mm",
            )
            for one in orders
            if one["scenario"] == scenario and one["route"] == "joint"
        ]
        layout = axes("step / ms", "largest position error / mm", margin={"l": 70, "r": 16, "t": 90, "b": 44})
        layout["xaxis"]["type"] = "log"
        layout["yaxis"] |= _LOG
        if traces:
            blocks.append(Figure(f"order-{scenario}", traces, layout, f"Free decay {what}, joint route.", height=420))
    columns = [
        Column("scenario", lambda one: one["scenario"]),
        Column("metric", lambda one: one["metric"]),
        Column("order", lambda one: number(one["order"], 3)),
        Column("scatter", lambda one: f"x{one['spread']:.2g}"),
        Column("finest error", lambda one: number(one["error"][-1], 2)),
    ]
    caption = (
        "error ~ step^order. Without friction the order is the scheme's; with friction a reversal falls somewhere "
        "between two steps, which leaves order 1 and a scatter: the largest factor between an error and the line."
    )
    table = tabulated(
        "setting",
        columns,
        orders,
        lambda one: f"{one['engine']} {one['preset']}",
        lambda one: f"{one['version']}, {one['route']}, {one['integrator']}",
        _color,
        caption=caption,
    )
    every = Folded("All measured orders", [table]) if orders else Text("No setting was run at three steps or more.")
    return Section("Convergence in the step", [*blocks, every])


def _creep(rows: Sequence[Data]) -> Section:
    """Creep at both loads; rows : ("engine", "version", "route", "settings", "half", "most", "color"), m/s."""

    def creep(row: Data, load: str) -> Cell:
        speed = row[load]
        shown = number(None if speed is None else speed * 1e6, 3)
        return Cell(shown, grade=grade(speed, (1e-9, 1e-7, 1e-6, 1e-4)))

    columns = [
        Column("at 50 %", by("half", creep), "µm/s", "creep at half of the break-away force"),
        Column("at 97 %", by("most", creep), "µm/s", "creep at 97 % of the break-away force"),
    ]
    caption = "A slider held below break-away does not move; what moves here is the engine's. Colour: against 1 µm/s."
    table = tabulated(
        "engine, route", columns, rows, lambda row: f"{row['engine']} {row['route']}", _about, _color, caption=caption
    )
    return Section("Creep under a static load", [table])


def _lift(rows: Sequence[Data]) -> Section:
    """Where a box stays on its floor; rows : ("engine", "settings", "speed", "lift", "normal", "ratio", ...)."""

    def share(row: Data, name: str, value: float, steps: tuple[float, float, float, float]) -> Cell:
        return Cell(number(value, 3), grade=grade(row[name], steps))

    columns = [
        Column("release", lambda row: number(row["release"], 3), "m"),
        Column(
            "mu v / g",
            lambda row: number(row["ratio"] * 1e3, 3),
            "ms",
            "largest coefficient of friction times speed over gravity",
        ),
        Column(
            "lift",
            lambda row: Cell(number(row["lift"] * 1e3, 3), grade=grade(row["lift"] / row["release"], STEPS)),
            "mm",
            "largest height over the place of rest",
        ),
        Column(
            "normal force off by",
            lambda row: share(row, "normal", row["normal"] * 100.0, (1e-3, 1e-2, 0.1, 1.0)),
            "%",
            "largest |N/(m g) - 1|",
        ),
        Column("position error", lambda row: share(row, "error", row["error"] * 100.0, STEPS), "%", "over the release"),
    ]
    caption = (
        "A friction cone that is solved as one turns sliding into lift, at a rate of mu v against gravity. The same "
        "free decay at one, three and ten times the size: a box stays on the floor where lift stays green."
    )
    table = tabulated("engine", columns, rows, lambda row: row["engine"], _about, _color, caption=caption)
    return Section("Contact: lift against mu v", [table])


def _worst(traces: Sequence[Data]) -> Section:
    """traces : ("head", "file", "settings", "badness", "t", "x", "exact") each, times in s, positions in m."""
    said = Markup(
        "The rows that are farthest from exact, with the exact motion over the engine's. Each is a trace that opens in"
        " the viewer: <code>harness view FILE</code>."
    )
    blocks: list[Block] = [Text(said)]
    for place, one in enumerate(traces, 1):
        curves = [
            plain("exact", one["t"], one["exact"] * 1e3, "ink", 2.4),
            plain("engine", one["t"], one["x"] * 1e3, one["color"]),
        ]
        line = f"{one['settings']}: worst figure off by {number(100.0 * one['badness'], 3)} %."
        file = f"traces/{one['file']}"
        blocks += [
            Text(f"{place}. {one['head']}", "heading"),
            Text(line, "table-caption", (file, file)),
            Figure(f"worst-{place}", curves, axes("time / s", "position / mm"), height=260),
        ]
    return Section("Worst rows", blocks)


def _servos(about: str, rows: Sequence[Data], exact: float) -> Section:
    """about : the servo in words. exact : its zeta.

    rows : ("who", "n", "own", "false_damping" in N s/m, "zeta") each.
    """
    lines = [
        Row(
            f"{'own drive' if one['own'] else 'held torque'}, n = {one['n']}",
            [
                Cell(f"{one['false_damping']:+.3g}" if one["false_damping"] else "0"),
                Cell(number(one["zeta"], 3), grade=grade(one["zeta"] / exact - 1.0)),
            ],
        )
        for one in rows
    ]
    notes = [f"{row.head}: {one['who']}." for row, one in zip(lines, rows, strict=True)]
    columns = [Column("false damping", str, "N s/m"), Column("ζ becomes", str)]
    return Section("A robot's servo", [Table("n sub-steps", columns, lines, about, footnotes=notes)])
