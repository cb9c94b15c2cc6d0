"""The page of a sweep: scorecard, error against cost, convergence, creep, lift, worst traces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from markupsafe import Markup

from harness.core.trajectory import Trajectory
from harness.fidelity.kind import Figure, Row, release
from harness.fidelity.laws import DAMPING, MASS, SERVOS, STEP, STIFFNESS, WITHOUT_EFFECT
from harness.fidelity.matrix import TRAINED
from harness.fidelity.published import PUBLISHED, Published
from harness.fidelity.scores import COLUMNS, Card, badness, cards, front, points, settings_of
from harness.results.sweep import Convergence
from harness.show import blocks as b
from harness.show.numbers import engine_name, number
from harness.show.plots import Trace, axes, decades, dots, plain
from harness.show.report.effort import effort_section, efforts
from harness.show.report.glance import STEPS, glance_section, glances
from harness.show.report.scenarios import bodies_section, curves_section
from harness.show.sentences import about, sentences

ROUTES = {
    "joint": "Joint friction",
    "contact": "Contact friction: a box on a floor",
    "law": "The neutral clipped force law",
}
_COLORS = ("#e4632d", "#2b7fd6", "#1f9e77", "#a45bc2", "#b58900", "#d6457f", "#4bb3c4", "#7a8c2e", "#8c6d5a", "#777777")
_MARKS = {"as-shipped": "circle-open", "tuned": "diamond"}
_PERCENT = 100.0
_DRAWN = 1500
"""Samples of a curve of the worst rows."""
_UNITS = {"m_s": ("mm/s", 1e3), "m": ("mm", 1e3), "s": ("ms", 1e3)}
_FREE = "free decay"
_REPEATS = (
    "the same free decay once more: in another run, in sixteen worlds of a batch, on another device, where it has them;"
    " yes is the same to the last bit, else the largest difference of position"
)
_APART = (1e-12, 1e-9, 1e-6, 1e-3)
"""m at which the colour changes."""
_MARGIN = {"l": 70, "r": 16, "t": 64, "b": 44}
_SILENT = (
    "These are words and settings of friction that an engine takes and does not act on, or acts on unasked. The "
    "versions are those it was found in, and docs/fidelity.md names the test of each."
)


class Worst(NamedTuple):
    """A row that is far from exact. file : its trace. exact, engine : both motions."""

    row: Row
    file: str
    exact: Trajectory
    engine: Trajectory


@dataclass(frozen=True, slots=True)
class _Engines:
    """Names by engine and version: with the environment where there are two of an engine; each has its colour."""

    names: Mapping[tuple[str, str], str]

    def name(self, engine: str, version: str) -> str:
        return self.names[engine, version]

    def color(self, engine: str, version: str) -> str:
        return _COLORS[sorted(set(self.names.values())).index(self.names[engine, version]) % len(_COLORS)]

    def table(self, corner: str, columns: Sequence[b.Column], rows: Sequence[Row]) -> b.Table:
        """A line a row, each under its engine and, where the corner says so, its route."""
        return b.tabulated(
            corner,
            columns,
            rows,
            lambda row: self.name(row["engine"], row["version"]) + f" {row['route']}" * ("route" in corner),
            lambda row: f"{row['version']}, {settings_of(row)}",
            lambda row: self.color(row["engine"], row["version"]),
        )


def sweep_sections(
    rows: Sequence[Row], orders: Sequence[Convergence], worst: Sequence[Worst], notes: Sequence[str]
) -> list[b.Section]:
    """rows : of the suite's own sliders. orders : measured. worst : the worst of them. notes : what to say besides."""
    places = {(row["engine"], row["version"]): row["environment"] for row in rows}
    several = {name for name, _ in places if sum(name == other for other, _ in places) > 1}
    named = {
        (name, version): f"{name} ({place})" if place and name in several else name
        for (name, version), place in places.items()
    }
    engines, scored, every = _Engines(named), cards(rows), rows
    rows, effort = [row for row in rows if row["preset"] != TRAINED], efforts(rows)
    said = [*sentences(scored), *notes]
    here, swept = {row["name"] for row in every}, {engine_name(row["engine"]) for row in every}
    published = [_published(one) for one in PUBLISHED if one.row in here]
    silent = [one for one in WITHOUT_EFFECT if one.engine.split()[0] in swept]
    said_of = [f"{one.engine}: {one.what}." for one in silent]
    alike = _one_step_each(rows)
    lifting = [row for row in alike if row["scenario"].startswith("free-decay") and row["slider"]["f_k"] > 0.0]
    lifting = [row for row in lifting if row["metrics"].get("lift_m") is not None]
    return [
        glance_section(glances(every, scored, effort), engines.name, engines.color),
        _scorecard(scored, engines),
        b.verdict("", said, [about(card) for card in scored], "What to change, and what stays wrong"),
        _pareto(rows, engines),
        *([_orders(orders, engines)] if orders else []),
        _creep(alike, engines),
        *([_lift(lifting, engines)] if lifting else []),
        *bodies_section(every, engines.name, engines.color),
        *curves_section(every, engines.table),
        *effort_section(effort, engines.name),
        *([_worst(worst, engines)] if worst else []),
        _servos(),
        *([b.Section("What others publish", published)] if published else []),
        *(
            [b.verdict("", [*said_of, _SILENT], [one.engine for one in silent], "Words that do nothing")]
            if silent
            else []
        ),
    ]


def _published(one: Published) -> b.Text:
    row = one.row.replace("/", "/\u200b").replace(",", ",\u200b")  # a phone may part it there
    said = f"It is said that {one.says}: {one.verdict}. Here {one.why} (row {row})."
    return b.Text(said, link=(one.source, one.address))


def _one_step_each(rows: Sequence[Row]) -> list[Row]:
    """Of rows that differ in their step alone, those at the step nearest to 1 ms by ratio."""

    def settings(row: Row) -> tuple[str, ...]:
        # settings that follow the step are the same settings
        changed = {name: value for name, value in row["changed"].items() if not name.startswith(("solref", "solimp"))}
        return row["engine"], row["version"], row["route"], row["preset"], repr(changed), row["integrator"]

    steps: dict[tuple[str, ...], set[float]] = {}
    for row in rows:
        if row["dt_s"] is not None:
            steps.setdefault(settings(row), set()).add(row["dt_s"])
    nearest = {key: min(found, key=lambda dt: abs(np.log(dt / 1e-3))) for key, found in steps.items()}
    return [row for row in rows if row["dt_s"] is not None and row["dt_s"] == nearest[settings(row)]]


def _scorecard(scored: Sequence[Card], engines: _Engines) -> b.Section:
    caption = (
        "Distance from the exact answer, relative, as shipped beside tuned: green is as good as exact (below "
        "0.01 %), red is off by more than 5 %. Small, below it, the measured value. What a column means, and every "
        "setting behind a figure, shows on hovering."
    )
    tables: list[b.Block] = []
    for route, title in ROUTES.items():
        lines = [card for card in scored if card.route == route]
        heads = {id(card): f"{engines.name(card.engine, card.version)} {card.preset}" for card in lines}
        notes = [f"{heads[id(card)]}: {text}" for card in lines for text in card.errors]
        groups: dict[str, list[Figure]] = {}
        for scenario, figure in COLUMNS:
            if any(card.values.get(figure.label) is not None for card in lines):
                group = _FREE if scenario.startswith("free-decay") else "hold, belt, harmonic force"
                groups.setdefault(group, []).append(figure)
        for group, figures in groups.items():
            columns = [b.Column(one.label, b.by(one, _scored), "", one.good) for one in figures]
            if group == _FREE and any(_again(card) for card in lines):
                columns.append(b.Column("repeats", _repeats, hint=_REPEATS))
            table = b.tabulated(
                "engine",
                columns,
                lines,
                lambda card: heads[id(card)],  # noqa: B023  (called at once)
                lambda card: f"{card.version}, {'' if card.dt_s is None else f'{card.dt_s * 1e3:.4g} ms'}",
                lambda card: engines.color(card.engine, card.version),
                footnotes=notes,
            )
            tables.append(b.Folded(f"{title}: {group}", [table]))
            notes = []
    return b.Section("Scorecard", [b.Text(caption, "table-caption"), *tables] if tables else [])


def _again(card: Card) -> Row | None:
    """The row that was run again."""
    return next((row for row in card.rows.values() if row.get("apart_m") or row.get("not_again")), None)


def _repeats(card: Card) -> b.Cell:
    if (row := _again(card)) is None:
        return b.Cell(number(None))
    if failed := row.get("not_again"):
        return b.Cell("fails", (", ".join(failed),), len(_APART), "; ".join(failed.values()))
    far = max(row["apart_m"].values())
    return b.Cell("yes" if far == 0.0 else f"{far:.0e} m", (", ".join(row["apart_m"]),), b.grade(far, _APART))


def _scored(card: Card, figure: Figure) -> b.Cell:
    """The cell of a figure: its distance from exact, and the metric itself in a unit for people."""
    value = card.values.get(figure.label)
    text, metric = number(None) if value is None else f"{number(100.0 * value, 2)} %", figure.metric
    physical = card.rows[figure.label]["metrics"].get(metric) if figure.label in card.rows else None
    unit, factor = next((known for end, known in _UNITS.items() if metric.endswith(f"_{end}")), ("", 1.0))
    notes = () if physical is None else (f"{physical * factor:.4g} {unit}".rstrip(),)
    settings = next(iter(card.rows.values()))["settings"] if card.rows else {}
    hint = ", ".join(f"{name} {value}" for name, value in settings.items() if name not in ("route", "restoring"))
    return b.Cell(text, notes, b.grade(value, STEPS), hint)


def _pareto(rows: Sequence[Row], engines: _Engines) -> b.Section:
    """Score over cost of every set of settings."""
    figures, every = [], points(rows)
    caption = (
        "The score is the geometric mean of the figures of the scorecard over all scenarios of a setting "
        "(each at least 1e-6): lower is better. Open circles ship, diamonds are tuned, dots are other settings."
    )
    for route, title in ROUTES.items():
        here = [point for point in every if point.row["route"] == route]
        if not here:
            continue
        traces = list[Trace]()
        for name in dict.fromkeys(engines.name(p.row["engine"], p.row["version"]) for p in here):
            mine = [p for p in here if engines.name(p.row["engine"], p.row["version"]) == name]
            first = mine[0].row
            cost, score = np.array([point.cost for point in mine]), np.array([point.score for point in mine])
            hover = "%{text}<br>%{x:.3g}, %{y:.3g}<extra>" + f"{name} {first['version']}</extra>"
            marks = [_MARKS.get(point.row["preset"], "circle") for point in mine]
            marker = {"color": engines.color(first["engine"], first["version"]), "size": 9, "symbol": marks}
            text = [settings_of(point.row) for point in mine]
            traces.append(dots(f"{name} {first['version']}", cost, score, marker, hover, text=text))
        best = sorted(front(here), key=lambda point: point.cost)
        line = {"color": "muted", "width": 1, "dash": "dot", "shape": "hv"}
        cost, score = np.array([point.cost for point in best]), np.array([point.score for point in best])
        traces.append(plain("nothing is both cheaper and better", cost, score, "muted", line=line, hoverinfo="skip"))
        layout = axes("wall time for one second of motion / s", "score", margin=_MARGIN)
        layout["title"] = {"text": title, "font": {"size": 13}, "x": 0.01, "y": 0.99}
        for axis, across in (("xaxis", [p.cost for p in here]), ("yaxis", [p.score for p in here])):
            layout[axis] |= decades(across)
        figures.append(b.Figure(f"pareto-{route}", traces, layout, caption, height=400))
    return b.Section("Error against cost", figures)


def _orders(orders: Sequence[Convergence], engines: _Engines) -> b.Section:
    def color(one: Convergence) -> str:
        return engines.color(one.engine, one.version)

    drawn: list[b.Block] = []
    for scenario, what in (("free-decay-no-friction", "without friction"), ("free-decay", "with friction")):
        traces = [
            plain(
                f"{engines.name(one.engine, one.version)} {one.preset}, {one.integrator}",
                np.array(one.dt_s) * 1e3,
                np.array(one.error) * 1e3,
                color(one),
                mode="lines+markers",
                line={"color": color(one), "dash": "dash" if one.preset == "as-shipped" else "solid"},
                hovertemplate=f"{one.version}, order {one.order:.2f}<br>%{{x:.3g}} ms: %{{y:.3g}} mm",
            )
            for one in orders
            if one.scenario == scenario and one.route == "joint"
        ]
        layout = axes("step / ms", "largest position error / mm", margin=_MARGIN | {"t": 90})
        layout["xaxis"]["type"] = "log"
        layout["yaxis"] |= decades([error for one in orders for error in one.error])
        if traces:
            said = f"Free decay {what}, joint route."
            drawn.append(b.Figure(f"order-{scenario}", traces, layout, said, height=420))
    columns = [
        b.Column("scenario", lambda one: one.scenario),
        b.Column("metric", lambda one: one.metric),
        b.Column("order", lambda one: number(one.order, 3)),
        b.Column("scatter", lambda one: f"x{one.spread:.2g}"),
        b.Column("finest error", lambda one: number(one.error[-1], 2)),
    ]
    caption = (
        "error ~ step^order. Without friction the order is the scheme's; with friction a reversal falls somewhere "
        "between two steps, which leaves order 1 and a scatter: the largest factor between an error and the line."
    )
    table = b.tabulated(
        "setting",
        columns,
        orders,
        lambda one: f"{engines.name(one.engine, one.version)} {one.preset}",
        lambda one: f"{one.version}, {one.route}, {one.integrator}",
        color,
        caption=caption,
    )
    return b.Section("Convergence in the step", [*drawn, b.Folded("All measured orders", [table])])


def _creep(rows: Sequence[Row], engines: _Engines) -> b.Section:
    """Creep at both loads, a line for both rows of the same settings."""
    found: dict[tuple[str, ...], dict[str, Any]] = {}
    for row in rows:
        if row["scenario"] in ("hold-50", "hold-97") and row["route"] != "law" and row["error"] is None:
            key = (row["engine"], row["version"], row["route"], settings_of(row))
            found.setdefault(key, dict(row))[row["scenario"]] = row["metrics"]["creep_m_s"]

    def creep(row: Row, load: str) -> b.Cell:
        speed = row.get(load)
        shown = number(None if speed is None else speed * 1e6, 3)
        return b.Cell(shown, grade=b.grade(speed, (1e-9, 1e-7, 1e-6, 1e-4)))

    columns = [
        b.Column("at 50 %", b.by("hold-50", creep), "µm/s", "creep at half of the break-away force"),
        b.Column("at 97 %", b.by("hold-97", creep), "µm/s", "creep at 97 % of the break-away force"),
    ]
    said = "A slider held below break-away does not move; what moves here is the engine's. Colour: against 1 µm/s."
    table = engines.table("engine, route", columns, list(found.values()))
    return b.Section("Creep under a static load", [b.Text(said), b.Folded(f"All {len(found)} settings", [table])])


def _lift(rows: Sequence[Row], engines: _Engines) -> b.Section:
    """Where a box stays on its floor."""

    def shown(metric: str, factor: float, steps: tuple[float, float, float, float], relative: bool) -> Any:
        def cell(row: Row) -> b.Cell:
            value = row["metrics"][metric] if metric != "lift_m" else max(0.0, row["metrics"][metric])
            share = value / release(row) if relative else value
            return b.Cell(number((share if factor == _PERCENT else value) * factor, 3), grade=b.grade(share, steps))

        return cell

    columns = [
        b.Column("release", lambda row: number(release(row), 3), "m"),
        b.Column(
            "mu v / g",
            lambda row: number(row["metrics"]["mu_v_over_g_s"] * 1e3, 3),
            "ms",
            "largest coefficient of friction times speed over gravity",
        ),
        b.Column("lift", shown("lift_m", 1e3, STEPS, True), "mm", "largest height over the place of rest"),
        b.Column(
            "normal force off by",
            shown("normal_error", _PERCENT, (1e-3, 1e-2, 0.1, 1.0), False),
            "%",
            "largest |N/(m g) - 1|",
        ),
        b.Column("position error", shown("max_error_m", _PERCENT, STEPS, True), "%", "over the release"),
    ]
    said = (
        "A friction cone that is solved as one turns sliding into lift, at a rate of mu v against gravity. The same "
        "free decay at one, three and ten times the size: a box stays on the floor where lift stays green."
    )
    table = engines.table("engine", columns, rows)
    return b.Section("Contact: lift against mu v", [b.Text(said), b.Folded(f"All {len(rows)} rows", [table])])


def _worst(found: Sequence[Worst], engines: _Engines) -> b.Section:
    said = Markup(
        "The rows that are farthest from exact, with the exact motion over the engine's. Each is a trace that opens in"
        " the viewer: <code>harness view FILE</code>."
    )
    drawn: list[b.Block] = [b.Text(said)]
    for place, one in enumerate(found, 1):
        row, t = one.row, one.engine.t
        chosen = np.unique(np.linspace(0, t.size - 1, min(_DRAWN, t.size)).astype(np.int64))
        curves = [
            plain("exact", t[chosen], one.exact.x[chosen] * 1e3, "ink", 2.4),
            plain("engine", t[chosen], one.engine.x[chosen] * 1e3, engines.color(row["engine"], row["version"])),
        ]
        line = f"{settings_of(row)}: worst figure off by {number(100.0 * badness(row), 3)} %."
        file = f"traces/{one.file}"
        drawn += [
            b.Text(f"{place}. {row['engine']} {row['version']}, {row['route']}, {row['scenario']}", "heading"),
            b.Text(line, "table-caption", (file, file)),
            b.Figure(f"worst-{place}", curves, axes("time / s", "position / mm"), height=260),
        ]
    return b.Section("Worst rows", drawn)


def _servos() -> b.Section:
    about = (
        "What the way a servo is computed does to its damping, from the laws of docs/fidelity.md: stiffness "
        f"{STIFFNESS:g} N/m, step {STEP * 1e3:g} ms, {MASS:g} kg, {DAMPING:g} N s/m."
    )
    columns = [
        b.Column("false damping", lambda one: f"{one.false_damping:+.3g}" if one.false_damping else "0", "N s/m"),
        b.Column("ζ becomes", lambda one: b.Cell(number(one.zeta, 3), grade=b.grade(one.zeta / SERVOS[0].zeta - 1.0))),
    ]
    heads = [f"{'own drive' if one.own else 'held torque'}, n = {one.n}" for one in SERVOS]
    notes = [f"{head}: {one.who}." for head, one in zip(heads, SERVOS, strict=True)]
    named = dict(zip(SERVOS, heads, strict=True))
    table = b.tabulated("n sub-steps", columns, SERVOS, named.__getitem__, footnotes=notes)
    return b.Section("A robot's servo", [b.Text(about), b.Folded("False damping by how it is computed", [table])])
