"""The page of a sweep: scorecard, error against cost, convergence, creep, lift, worst traces."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.show.numbers import number
from harness.show.report.section import Cell, Column, Figure, Row, Section, Table, grade
from harness.show.report.verdict import made_with_section, verdict_section

Data = Mapping[str, Any]


def servos_section(about: str, rows: Sequence[Data], exact: float) -> Section:
    """about : the servo in words. exact : its zeta.

    rows : ("who", "n", "own", "false_damping" in N s/m, "zeta") each.
    """
    columns = [Column("false damping", "N s/m"), Column("ζ becomes")]
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
    return Section(
        "A robot's servo", "table.html.j2", {"tables": [Table("n sub-steps", columns, lines, about, footnotes=notes)]}
    )


def silent_words(rows: Sequence[Data]) -> Section:
    """Words that do nothing; rows : ("engine" with its version, "what") each."""
    note = (
        "These are words and settings of friction that an engine takes and does not act on, or acts on unasked. The "
        "versions are those it was found in, and docs/fidelity.md names the test of each."
    )
    said = [f"{one['engine']}: {one['what']}." for one in rows]
    return verdict_section("", [*said, note], [one["engine"] for one in rows], "Words that do nothing")


ROUTES = {
    "joint": "Joint friction",
    "contact": "Contact friction: a box on a floor",
    "law": "The neutral clipped force law",
}
_COLORS = ("#e4632d", "#2b7fd6", "#1f9e77", "#a45bc2", "#b58900", "#d6457f", "#4bb3c4", "#7a8c2e", "#8c6d5a", "#777777")
_MARKS = {"as-shipped": "circle-open", "tuned": "diamond"}
STEPS = (1e-4, 2e-3, 1e-2, 5e-2)
"""Relative distances from exact at which the colour changes."""


def sweep_scorecard_section(cards: Sequence[Data], figures: Sequence[Data]) -> Section:
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
        if lines:
            notes = [f"{card['engine']} {card['preset']}: {text}" for card in lines for text in card["errors"]]
            for group in dict.fromkeys(one["group"] for one in used):
                here = [one for one in used if one["group"] == group]
                rows = [_row(card, here) for card in lines]
                columns = [Column(one["label"], hint=one["good"]) for one in here]
                above = "" if tables else caption
                tables.append(Table("engine", columns, rows, above, f"{title}: {group}", notes))
                notes = []
    return Section("Scorecard", "table.html.j2", {"tables": tables})


def _row(card: Data, used: Sequence[Data]) -> Row:
    cells = []
    for one in used:
        value = card["values"].get(one["label"])
        text = number(None if value is None else 100.0 * value, 2)
        shown = f"{text} %" if value is not None else text
        cells.append(Cell(shown, _lines(card["physical"].get(one["label"])), grade(value, STEPS), card["settings"]))
    return Row(f"{card['engine']} {card['preset']}", cells, f"{card['version']}, {card['step']}", card["color"])


def _lines(text: str | None) -> tuple[str, ...]:
    return (text,) if text else ()


def pareto_section(points: Sequence[Data]) -> Section:
    """points : ("engine", "version", "route", "preset", "settings", "cost", "error", "best") each."""
    figures = []
    for route, title in ROUTES.items():
        here = [point for point in points if point["route"] == route]
        if not here:
            continue
        best = sorted((point for point in here if point["best"]), key=lambda point: float(point["cost"]))
        traces = [_points(here, engine, "cost", "error") for engine in _engines(here)]
        traces.append(
            {
                "type": "scatter",
                "mode": "lines",
                "name": "nothing is both cheaper and better",
                "x": np.array([point["cost"] for point in best]),
                "y": np.array([point["error"] for point in best]),
                "line": {"color": "muted", "width": 1, "dash": "dot", "shape": "hv"},
                "hoverinfo": "skip",
            }
        )
        layout = {
            "title": {"text": title, "font": {"size": 13}, "x": 0.01, "y": 0.99},
            "xaxis": {"title": {"text": "wall time for one second of motion / s"}, **_LOG},
            "yaxis": {"title": {"text": "score"}, **_LOG},
            "margin": {"l": 70, "r": 16, "t": 64, "b": 44},
        }
        caption = (
            "The score is the geometric mean of the figures of the scorecard over all scenarios of a setting "
            "(each at least 1e-6): lower is better. Open circles ship, diamonds are tuned, dots are other settings."
        )
        figures.append(Figure(f"pareto-{route}", traces, layout, caption, height=400))
    return Section("Error against cost", "figures.html.j2", {"figures": figures})


_LOG = {"type": "log", "exponentformat": "power", "dtick": 1}


def _engines(points: Sequence[Data]) -> list[str]:
    return list(dict.fromkeys(str(point["engine"]) for point in points))


def engine_color(engine: str, engines: Sequence[str]) -> str:
    """The colour of an engine among these."""
    return _COLORS[list(engines).index(engine) % len(_COLORS)]


def _points(here: Sequence[Data], engine: str, x: str, y: str) -> dict[str, Any]:
    mine = [point for point in here if point["engine"] == engine]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": f"{engine} {mine[0]['version']}",
        "x": np.array([point[x] for point in mine]),
        "y": np.array([point[y] for point in mine]),
        "text": [point["settings"] for point in mine],
        "hovertemplate": "%{text}<br>%{x:.3g}, %{y:.3g}<extra>" + f"{engine} {mine[0]['version']}</extra>",
        "marker": {
            "color": mine[0]["color"],
            "size": 9,
            "symbol": [_MARKS.get(point["preset"], "circle") for point in mine],
        },
    }


def orders_section(orders: Sequence[Data]) -> Section:
    """orders : as in harness.sweep/1, with "color"."""
    figures = []
    for scenario, what in (("free-decay-no-friction", "without friction"), ("free-decay", "with friction")):
        here = [one for one in orders if one["scenario"] == scenario and one["route"] == "joint"]
        traces = [
            {
                "type": "scatter",
                "mode": "lines+markers",
                "name": f"{one['engine']} {one['preset']}, {one['integrator']}",
                "x": np.array(one["dt_s"]) * 1e3,
                "y": np.array(one["error"]) * 1e3,
                "line": {"color": one["color"], "dash": "dash" if one["preset"] == "as-shipped" else "solid"},
                "hovertemplate": f"{one['version']}, order {one['order']:.2f}<br>%{{x:.3g}} ms: %{{y:.3g}} mm",
            }
            for one in here
        ]
        layout = {
            "xaxis": {"title": {"text": "step / ms"}, "type": "log"},
            "yaxis": {"title": {"text": "largest position error / mm"}, **_LOG},
            "margin": {"l": 70, "r": 16, "t": 90, "b": 44},
        }
        if traces:
            figures.append(Figure(f"order-{scenario}", traces, layout, f"Free decay {what}, joint route.", height=420))
    columns = [Column(head) for head in ("scenario", "metric", "order", "scatter", "finest error")]
    rows = [
        Row(
            f"{one['engine']} {one['preset']}",
            [
                Cell(one["scenario"]),
                Cell(one["metric"]),
                Cell(number(one["order"], 3)),
                Cell(f"x{one['spread']:.2g}"),
                Cell(number(one["error"][-1], 2)),
            ],
            f"{one['version']}, {one['route']}, {one['integrator']}",
            one["color"],
        )
        for one in orders
    ]
    caption = (
        "error ~ step^order. Without friction the order is the scheme's; with friction a reversal falls somewhere "
        "between two steps, which leaves order 1 and a scatter: the largest factor between an error and the line."
    )
    return Section(
        "Convergence in the step",
        "sweep_orders.html.j2",
        {"figures": figures, "table": Table("setting", columns, rows, caption)},
    )


def plain_section(heading: str, table: Table) -> Section:
    """heading, table : one table under a heading of its own."""
    return Section(heading, "table.html.j2", {"tables": [table]})


def creep_section(rows: Sequence[Data]) -> Section:
    """Creep at both loads; rows : ("engine", "version", "route", "settings", "half", "most", "color"), m/s."""
    columns = [
        Column("at 50 %", "µm/s", "creep at half of the break-away force"),
        Column("at 97 %", "µm/s", "creep at 97 % of the break-away force"),
    ]
    lines = [
        Row(
            f"{row['engine']} {row['route']}",
            [_creep_cell(row[load]) for load in ("half", "most")],
            f"{row['version']}, {row['settings']}",
            row["color"],
        )
        for row in rows
    ]
    caption = "A slider held below break-away does not move; what moves here is the engine's. Colour: against 1 µm/s."
    return plain_section("Creep under a static load", Table("engine, route", columns, lines, caption))


def _creep_cell(speed: float | None) -> Cell:
    steps = (1e-9, 1e-7, 1e-6, 1e-4)
    return Cell(number(None if speed is None else speed * 1e6, 3), grade=grade(speed, steps))


def lift_section(rows: Sequence[Data]) -> Section:
    """Where a box stays on its floor; rows : ("engine", "settings", "speed", "lift", "normal", "ratio", ...)."""
    columns = [
        Column("release", "m"),
        Column("mu v / g", "ms", "largest coefficient of friction times speed over gravity"),
        Column("lift", "mm", "largest height over the place of rest"),
        Column("normal force off by", "%", "largest |N/(m g) - 1|"),
        Column("position error", "%", "over the release"),
    ]
    lines = [
        Row(
            row["engine"],
            [
                Cell(number(row["release"], 3)),
                Cell(number(row["ratio"] * 1e3, 3)),
                Cell(number(row["lift"] * 1e3, 3), grade=grade(row["lift"] / row["release"], STEPS)),
                Cell(number(row["normal"] * 100.0, 3), grade=grade(row["normal"], (1e-3, 1e-2, 0.1, 1.0))),
                Cell(number(row["error"] * 100.0, 3), grade=grade(row["error"], STEPS)),
            ],
            f"{row['version']}, {row['settings']}",
            row["color"],
        )
        for row in rows
    ]
    caption = (
        "A friction cone that is solved as one turns sliding into lift, at a rate of mu v against gravity. The same "
        "free decay at one, three and ten times the size: a box stays on the floor where lift stays green."
    )
    return plain_section("Contact: lift against mu v", Table("engine", columns, lines, caption))


def worst_section(traces: Sequence[Data]) -> Section:
    """traces : ("name", "file", "settings", "badness", "t", "x", "exact") each, times in s, positions in m."""
    shown = []
    for place, trace in enumerate(traces, 1):
        t: FloatArray = trace["t"]
        curves = [
            _line("exact", t, trace["exact"], {"color": "ink", "width": 2.4}),
            _line("engine", t, trace["x"], {"color": trace["color"], "width": 1.5}),
        ]
        layout = {"xaxis": {"title": {"text": "time / s"}}, "yaxis": {"title": {"text": "position / mm"}}}
        shown.append(
            {
                "figure": Figure(f"worst-{place}", curves, layout, height=260),
                "file": trace["file"],
                "head": f"{place}. {trace['head']}",
                "line": f"{trace['settings']}: worst figure off by {number(100.0 * trace['badness'], 3)} %",
            }
        )
    return Section("Worst rows", "sweep_worst.html.j2", {"shown": shown})


def _line(name: str, t: FloatArray, x: FloatArray, line: Data) -> dict[str, Any]:
    return {"type": "scatter", "mode": "lines", "name": name, "x": t, "y": x * 1e3, "line": dict(line)}


def sweep_sections(data: Data) -> list[Section]:
    """Sections of the page; data : as harness.app.sweep.report makes it."""
    sections: list[Section] = [
        verdict_section(data["headline"], (), (), "Conclusions"),
        sweep_scorecard_section(data["cards"], data["figures"]),
        verdict_section("", data["sentences"], data["about"], "What to change, and what stays wrong"),
        pareto_section(data["points"]),
        orders_section(data["orders"]),
        creep_section(data["creep"]),
    ]
    if data["lift"]:
        sections.append(lift_section(data["lift"]))
    if data["worst"]:
        sections.append(worst_section(data["worst"]))
    sections += [servos_section(**data["servo"]), silent_words(data["silent"])]
    return [*sections, made_with_section(data["machine"], data["files"], data["command"])]
