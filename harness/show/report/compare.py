"""The page of two traces: what each of them reads, how far they are apart, and where."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.results.common import P
from harness.results.compare import CompareResult, Difference
from harness.show.decimate import keep
from harness.show.numbers import NONE, number, quantity, sentence_quantity, shown_value
from harness.show.report.identify import ANGLES, CHANNELS
from harness.show.report.motion import GROUP, POINTS
from harness.show.report.section import Cell, Column, Figure, Row, Section, Table
from harness.show.report.verdict import made_with_section, verdict_section
from harness.show.sentences.compare import SHOWS, difference_words, faster_words, figure_words, shows, telling

FIRST = "#e4632d"
_APART = "#2b7fd6"
_SHADE = "rgba(228, 99, 45, 0.12)"
_MOST_SHADES = 80
_MOST_EVENTS = 24
_SAID = 2
"""Differences that the headline names."""
_LABELS = {"omega_n": "omega_n", "zeta": "zeta", "x_k": "x_k", "amplitude": "amplitude", "rest": "rest"}


@dataclass(frozen=True)
class Shown:
    """t : shared times (n,), s. channels : (first, second) of each, (n,). motion : position and speed of each.
    names : of the traces.
    """

    t: FloatArray
    channels: Mapping[str, tuple[FloatArray, FloatArray]]
    motion: tuple[tuple[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
    names: tuple[str, str]
    angular: bool


def compare_title(result: Mapping[str, Any]) -> tuple[str, str]:
    """Title and subtitle."""
    first, second = (PurePath(file).name for file in result["files"])
    return f"{first} against {second}", f"shift {sentence_quantity(result['aligned']['shift_s'])}"


def compare_sections(shown: Shown, result: Mapping[str, Any]) -> list[Section]:
    """Sections of a comparison. result : CompareResult.model_dump(by_alias=True)."""
    return [
        verdict_section(compare_headline(result), result["sentences"], tuple(result["traces"])),
        readings_section(result),
        overlay_section(shown, result["where"]),
        phase_section(shown),
        event_table_section(result),
        places_section(result),
        made_with_section(result["machine"], result["outputs"], result["command"]),
    ]


def compare_headline(result: Mapping[str, Any]) -> str:
    """The verdict, and in what the two differ most."""
    first, second = result["traces"]
    shift = result["aligned"]["shift_s"]
    moved = shift["value"] and (not shift["stderr"] or abs(shift["value"]) > SHOWS * shift["stderr"])
    after = f", {first} moved by {number(shift['value'])} s" if moved else ""
    if result["verdict"] == "identical":
        return f"{first} and {second} are identical{after}: the same samples."
    if result["verdict"] != "different":
        return f"{first} and {second} are the same within noise{after}."
    apart = telling([Difference.model_validate(one) for one in result["differences"]])
    largest = result["largest"]
    value = shown_value(abs(largest["value"]), largest["unit"])
    far = f"at most {value} apart in {largest['channel']}, at {number(largest['time_s'], 3)} s"
    words = [difference_words(one).partition(" (")[0] for one in apart[:_SAID]]
    if not result["aligned"]["scale_applied"]:
        return f"{faster_words(CompareResult.model_validate(result))}; {far}{after}."
    return f"{first} {'; '.join(words)}; {far}{after}." if words else f"{first} and {second} differ: {far}{after}."


def rows_of(result: Mapping[str, Any]) -> list[tuple[str, list[str]]]:
    """Figures side by side: a label; the first's, the second's, and their distance in standard errors."""
    readings = list(result["traces"].values())
    apart = {one["what"]: one["significance"] for one in result["differences"]}
    rows = []
    for what, label in _LABELS.items():
        cells = [figure_words(P.model_validate(one[what])) for one in readings]
        significance = apart.get(what)
        rows.append((label, [*cells, NONE if significance is None else number(significance, 2)]))
    rows.append(("events", [*(str(len(one["events"])) for one in readings), NONE]))
    return rows


def readings_section(result: Mapping[str, Any]) -> Section:
    """What the estimators read from each."""
    rows = [
        Row(label, [Cell(cell) for cell in cells], note="differs" if _shows(result, label) else "")
        for label, cells in rows_of(result)
    ]
    fits = [f"{value:.1f} % of {c}" for c, value in result["fit_percent"].items()]
    columns = [Column(name) for name in result["traces"]]
    columns.append(Column("apart", "", "in standard errors of the difference"))
    notes = [
        f"{name}, {what}: {one[what]['why']}"
        for name, one in result["traces"].items()
        for what in _LABELS
        if one[what]["value"] is None
    ]
    caption = f"With one standard error each. Fit: {', '.join(fits)} (NRMSE)."
    return Section(
        "Side by side",
        "table.html.j2",
        {"tables": [Table("figure", columns, rows, caption, "", list(dict.fromkeys(notes)))]},
    )


def _shows(result: Mapping[str, Any], label: str) -> bool:
    differences = (Difference.model_validate(one) for one in result["differences"])
    return any(one.what == label and shows(one) for one in differences)


def overlay_section(shown: Shown, where: Sequence[Mapping[str, Any]]) -> Section:
    """Both traces, and their difference below in units, with the places shaded."""
    figures = []
    shades = _shades(where)
    budget = POINTS // (5 * len(shown.channels))
    names = shown.names
    for channel, (first, second) in shown.channels.items():
        name, unit, factor = (ANGLES if shown.angular else CHANNELS)[channel]
        written = f"({unit})" if "/" in unit else unit
        chosen = keep(shown.t, (first, second, second - first), np.empty(0), budget)
        t = shown.t[chosen]
        layout = {
            "xaxis": {"title": {"text": "time / s"}, "anchor": "y2"},
            "yaxis": {"title": {"text": f"{name} / {written}"}, "domain": [0.42, 1.0]},
            "yaxis2": {"title": {"text": f"difference / {written}"}, "domain": [0.0, 0.33], "zeroline": True},
            "hovermode": "closest",
            "shapes": shades,
            "showlegend": True,
        }
        traces = [
            _line(names[1], t, second[chosen] * factor, "ink", unit),
            _line(names[0], t, first[chosen] * factor, FIRST, unit),
            _line(f"{names[1]} minus {names[0]}", t, (second - first)[chosen] * factor, _APART, unit) | {"yaxis": "y2"},
        ]
        caption = f"Below: {names[1]} minus {names[0]}, in {unit}."
        caption += " The shaded stretches hold the mismatch." * bool(shades)
        figures.append(Figure(f"compare-{channel}", traces, layout, caption, GROUP, 520))
    return Section(
        "The two traces, and their difference", "motion.html.j2", {"figures": figures, "buttons": [], "group": GROUP}
    )


def _shades(where: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    local = [one for one in where if one["regime"] not in ("throughout", "channel")]
    spans = local[0]["time_s"][:_MOST_SHADES] if local else []
    looks = {"type": "rect", "y0": 0, "y1": 1, "yref": "paper", "fillcolor": _SHADE, "layer": "below"}
    return [looks | {"x0": a, "x1": b, "line": {"width": 0}} for a, b in spans]


def phase_section(shown: Shown) -> Section:
    """Speed over position of both."""
    table = ANGLES if shown.angular else CHANNELS
    (place, unit, factor), (speed, per, speed_factor) = table["x"], table["v"]
    chosen = keep(shown.t, [y for pair in shown.motion for y in pair], np.empty(0), POINTS // 10)
    traces = [
        _line(name, x[chosen] * factor, v[chosen] * speed_factor, color, per, unit)
        for name, (x, v), color in zip(shown.names, shown.motion, (FIRST, "ink"), strict=True)
    ]
    layout = {
        "xaxis": {"title": {"text": f"{place} / {unit}"}},
        "yaxis": {"title": {"text": f"{speed} / ({per})"}},
        "showlegend": True,
    }
    measured = [c for c in ("x", "v") if c in shown.channels]
    caption = "" if len(measured) == len("xv") else "What was not measured is smoothed or summed from what was."
    return Section(
        "Phase portrait", "figures.html.j2", {"figures": [Figure("compare-phase", traces, layout, caption, "", 480)]}
    )


def event_table_section(result: Mapping[str, Any]) -> Section:
    """Release, reversals and stop of both, one beside the other."""
    names, readings = list(result["traces"]), list(result["traces"].values())
    events = [one["events"] for one in readings]
    if not any(events):
        return Section("Events", "table.html.j2", {"tables": []})
    unit = readings[0]["rest"]["unit"]
    rows = [
        Row(str(i + 1), [cell for one in events for cell in _event_cells(one[i] if i < len(one) else None, unit)])
        for i in range(min(max(map(len, events)), _MOST_EVENTS))
    ]
    shown_unit = quantity({"value": 0.0, "stderr": None, "unit": unit})[2]
    columns = [column for name in names for column in (Column(name, "s"), Column("at", shown_unit))]
    more = max(map(len, events)) - _MOST_EVENTS
    caption = "Times by the clock of the second trace."
    return Section(
        "Events",
        "table.html.j2",
        {"tables": [Table("event", columns, rows, caption, "", [f"{more} more"] if more > 0 else [])]},
    )


def _event_cells(event: Mapping[str, Any] | None, unit: str) -> list[Cell]:
    if event is None:
        return [Cell(NONE), Cell(NONE)]
    at = NONE if event["value"] is None else shown_value(event["value"], unit).split(" ")[0]
    return [Cell(number(event["time_s"]), [event["kind"]]), Cell(at)]


def places_section(result: Mapping[str, Any]) -> Section:
    """Where they part, and whether the channels of each trace agree with one another."""
    tables = []
    rows = [
        Row(
            one["condition"],
            [
                Cell(one["regime"]),
                Cell(NONE if one["share"] is None else f"{100.0 * one['share']:.0f}"),
                Cell(str(len(one["time_s"]))),
                Cell(number(sum(b - a for a, b in one["time_s"]))),
            ],
        )
        for one in result["where"]
    ]
    if rows:
        hint = "of the mean square mismatch above noise"
        columns = [Column("regime"), Column("share", "%", hint), Column("spans"), Column("together", "s")]
        tables.append(Table("condition", columns, rows))
    pairs = [
        Row(
            f"{name}: {pair.replace('-', ' and ')}",
            [Cell(sentence_quantity(found[key])) for key in ("gain", "lag_s", "offset")]
            + [Cell("yes" if found["consistent"] else "no", [found["sentence"]])],
        )
        for name, members in result["consistent_channels"].items()
        for pair, found in members.items()
    ]
    if pairs:
        columns = [Column("gain"), Column("lag"), Column("offset"), Column("agree")]
        caption = "What one channel of a trace says of another, from the data alone, with one standard error."
        tables.append(Table("channels", columns, pairs, caption))
    return Section("Where they part", "table.html.j2", {"tables": tables})


def _line(name: str, x: FloatArray, y: FloatArray, color: str, unit: str, x_unit: str = "s") -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": x,
        "y": y,
        "line": {"color": color, "width": 1.4},
        "hovertemplate": f"%{{y:.6g}} {unit}<br>%{{x:.6f}} {x_unit}",
    }
