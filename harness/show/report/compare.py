"""Pages that compare: two traces, models on one recording, and a machine in two conditions."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import short_names
from harness.core.recording import Recording
from harness.results.compare import (
    ChangedNumber,
    ChangeResult,
    ComparedModel,
    CompareResult,
    Event,
    ModelsResult,
    Reading,
)
from harness.show import blocks as b
from harness.show import scene as s
from harness.show.blocks import Cell, Column, Figure, Page, Row, Section, Table, measured, tabulated, verdict
from harness.show.numbers import NONE, SHOWN, number, of_names, sentence_quantity, shown_number, shown_unit, shown_value
from harness.show.plots import ANGLES, CHANNELS, GROUP, axes, curve, dots, left_by, orbit, per, shades
from harness.show.report.page import made_with
from harness.show.sentences import SHOWS, difference_words, faster_words, figure_words, shows, telling

FIRST = "#e4632d"
_APART = "#2b7fd6"
_MOST_EVENTS = 24
_SAID = 2
"""Differences that the headline names."""
_READ = ("omega_n", "zeta", "x_k", "amplitude", "rest")


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


def compare_page(result: CompareResult, shown: Shown) -> Page:
    """shown : the traces, laid over each other."""
    assert result.machine is not None
    sections = [
        verdict(compare_headline(result), result.sentences, tuple(result.traces)),
        Section("The two traces, and their difference", channel_figures(shown, result)),
        _readings(result),
        Section("Phase portrait", [phase_figure(shown)]),
        _events(result),
        _places(result),
        made_with(result.machine, result.outputs, result.command),
    ]
    first, second = (PurePath(file).name for file in result.files)
    return Page(f"{first} against {second}", f"shift {sentence_quantity(result.aligned.shift_s)}", sections)


def compare_headline(result: CompareResult) -> str:
    """The verdict, and in what the two differ most."""
    first, second = result.traces
    shift, largest = result.aligned.shift_s, result.largest
    moved = shift.value and (not shift.stderr or abs(shift.value) > SHOWS * shift.stderr)
    after = f", {first} moved by {number(shift.value)} s" if moved else ""
    if result.verdict == "identical":
        return f"{first} and {second} are identical{after}: the same samples."
    if result.verdict != "different":
        return f"{first} and {second} are the same within noise{after}."
    value = shown_value(abs(largest.value), largest.unit)
    far = f"largest difference {value} in {largest.channel} at {number(largest.time_s, 3)} s"
    words = [difference_words(one).partition(" (")[0] for one in telling(result.differences)[:_SAID]]
    if not result.aligned.scale_applied:
        return f"{faster_words(result)}; {far}{after}."
    return f"{first} {'; '.join(words)}; {far}{after}." if words else f"{first} and {second} differ: {far}{after}."


def rows_of(result: CompareResult) -> list[tuple[str, list[str]]]:
    """Figures side by side: a label; the first's, the second's, and their distance in standard errors."""
    readings = list(result.traces.values())
    apart = {one.what: one.significance for one in result.differences}
    rows = []
    for what in _READ:
        far = apart.get(what)
        cells = [NONE if (p := getattr(one, what)).value is None else figure_words(p) for one in readings]
        rows.append((what, [*cells, NONE if far is None else number(far, 2)]))
    return [*rows, ("events", [*(str(len(one.events)) for one in readings), NONE])]


def _readings(result: CompareResult) -> Section:
    """What the estimators read from each."""
    differs = {one.what for one in result.differences if shows(one)}
    rows = [
        Row(label, [Cell(cell) for cell in cells], note="differs" if label in differs else "")
        for label, cells in rows_of(result)
    ]
    fits = [f"{value:.1f} % of {c}" for c, value in result.fit_percent.items()]
    columns = [Column(name, str) for name in result.traces]
    columns.append(Column("difference", str, "in standard errors"))
    notes = dict.fromkeys(
        f"{name}, {what}: {p.why}"
        for name, one in result.traces.items()
        for what in _READ
        if (p := getattr(one, what)).value is None
    )
    caption = f"With one standard error each. Fit: {', '.join(fits)} (NRMSE)."
    return Section("Side by side", [Table("figure", columns, rows, caption, "", list(notes))])


def channel_figures(shown: Shown, result: CompareResult) -> list[Figure]:
    """Both traces, and below their difference in units, with the places shaded."""
    local = [one for one in result.where if one.regime not in ("throughout", "channel")]
    shaded = shades(local[0].time_s) if local else []
    figures, names = [], shown.names
    apart = f"{names[1]} minus {names[0]}"
    for channel, (first, second) in shown.channels.items():
        name, unit, factor = (ANGLES if shown.angular else CHANNELS)[channel]
        both = [
            curve(names[1], shown.t, second * factor, "ink", unit, 1.4),
            curve(names[0], shown.t, first * factor, FIRST, unit, 1.4),
        ]
        below = [curve(apart, shown.t, (second - first) * factor, _APART, unit, 1.4)]
        caption = f"{name.capitalize()}: {apart}, in {unit}." + " The shaded stretches hold the mismatch." * bool(
            shaded
        )
        for what, traces, label, said, height in (
            ("compare", both, name, "", 340),
            ("difference", below, "difference", caption, 240),
        ):
            looks = {"hovermode": "closest", "shapes": shaded, "showlegend": True}
            layout = axes("time / s", f"{label} / {per(unit)}", **looks)
            figures.append(Figure(f"{what}-{channel}", traces, layout, said, GROUP, height))
    return figures


def phase_figure(shown: Shown) -> Figure:
    """Speed over position of both."""
    table = ANGLES if shown.angular else CHANNELS
    (place, unit, factor), (speed, by, speed_factor) = table["x"], table["v"]
    traces = [
        orbit(curve(name, shown.t, v, color, by, 1.4), shown.t, x * factor, v * speed_factor, f"%{{y:.6g}} {by}")
        for name, (x, v), color in zip(shown.names, shown.motion, (FIRST, "ink"), strict=True)
    ]
    both = "x" in shown.channels and "v" in shown.channels
    caption = "" if both else "What was not measured is differentiated or integrated from what was."
    layout = axes(f"{place} / {unit}", f"{speed} / ({by})", showlegend=True)
    return Figure("compare-phase", traces, layout, caption, "", 480)


def compare_scene(sim: Recording, real: Recording, shown: Shown, result: CompareResult) -> s.Scene:
    """Scene of a comparison; shown : both at shared times."""
    notes = s.notes_of(result.verdict, result.sentences, compare_headline(result))
    side = s.Rows([phase_figure(shown), s.Words("notes", notes)])
    layout = s.Columns([s.Rows(channel_figures(shown, result)), side], [3.0, 2.0])
    return s.of_result("comparison", layout, result, notes, {"recording": [sim, real]})


def _events(result: CompareResult) -> Section:
    """Release, reversals and stop of both, one beside the other."""
    readings: list[Reading] = list(result.traces.values())
    most, unit = max(len(one.events) for one in readings), readings[0].rest.unit
    if not most:
        return Section("Events", [])

    def cells(i: int) -> list[Cell]:
        return [c for one in readings for c in _event(one.events[i] if i < len(one.events) else None, unit)]

    columns = [
        c for name in result.traces for c in (Column(name, str, "s"), Column("at", str, SHOWN.get(unit, (unit,))[0]))
    ]
    rows = [Row(str(i + 1), cells(i)) for i in range(min(most, _MOST_EVENTS))]
    more = [f"{most - _MOST_EVENTS} more"] if most > _MOST_EVENTS else []
    return Section("Events", [Table("event", columns, rows, "Times by the clock of the second trace.", "", more)])


def _event(event: Event | None, unit: str) -> list[Cell]:
    if event is None:
        return [Cell(NONE), Cell(NONE)]
    at = NONE if event.value is None else shown_value(event.value, unit).split(" ")[0]
    return [Cell(number(event.time_s), [event.kind]), Cell(at)]


def _places(result: CompareResult) -> Section:
    """Where they differ, and whether the channels of each trace agree with one another."""
    tables = []
    if result.where:
        columns = [
            Column("regime", lambda one: one.regime),
            Column(
                "share",
                lambda one: NONE if one.share is None else f"{100.0 * one.share:.0f}",
                "%",
                "of the mean square mismatch above noise",
            ),
            Column("spans", lambda one: str(len(one.time_s))),
            Column("together", lambda one: number(sum(b - a for a, b in one.time_s)), "s"),
        ]
        tables.append(tabulated("condition", columns, result.where, lambda one: one.condition))
    pairs = [
        (f"{name}: {pair.replace('-', ' and ')}", found)
        for name, members in result.consistent_channels.items()
        for pair, found in members.items()
    ]
    if pairs:
        columns = [
            Column("gain", lambda one: sentence_quantity(one[1].gain)),
            Column("lag", lambda one: sentence_quantity(one[1].lag_s)),
            Column("offset", lambda one: sentence_quantity(one[1].offset)),
            Column("agree", lambda one: Cell("yes" if one[1].consistent else "no", [one[1].sentence])),
        ]
        caption = "What one channel of a trace says of another, from the data alone, with one standard error."
        tables.append(tabulated("channels", columns, pairs, lambda one: one[0], caption=caption))
    return Section("Where they differ", tables)


def models_page(result: ModelsResult, angular: bool = False) -> b.Page:
    """Residuals are the curves of the result."""
    colors = dict(zip((one.name for one in result.models), of_names(len(result.models)), strict=True))
    first = result.models[0]
    columns = [
        b.Column("terms", lambda one: ", ".join(one.terms) or "none"),
        b.Column("fitted", lambda one: str(one.fitted), "", "numbers that were fitted"),
        b.Column("chi-square per point", lambda one: number(one.chi2_per_point, 4), "", "1 when only noise is left"),
        b.Column("worse by", lambda one: number(one.delta_bic, 3), "BIC"),
        b.Column("weight", lambda one: number(one.weight, 2), "", "probability among these models"),
        *(
            b.Column(
                n,
                b.by(n, lambda one, n: b.measured(one.parameters.get(n))),
                shown_unit(p.unit),
            )
            for n, p in first.parameters.items()
        ),
    ]

    def color(one: ComparedModel) -> str:
        return colors[one.name]

    table = b.tabulated("model", columns, result.models, lambda one: one.name, lambda one: one.note, color)
    figures = []
    for c in first.rmse:
        label, unit, factor = (ANGLES if angular else CHANNELS)[c]
        traces = [
            curve(name, own["t"], own[c] * factor, colors[name], unit, 1.2) for name, own in result.curves.items()
        ]
        caption, band = left_by("model", result.recording.noise.get(c), unit, factor)
        layout = axes("time / s", f"residual of {label} / {per(unit)}", shapes=band, showlegend=True)
        figures.append(b.Figure(f"residual-{c}", traces, layout, caption, GROUP, 300))
    about = result.recording
    sections = [b.verdict(result.statement), b.Section("Ranking", [table]), b.Section("Residuals", figures)]
    return b.Page(
        f"Models of {PurePath(about.file).name}", f"{about.samples} samples, {about.duration_s:.4g} s", sections
    )


_MOVED, _SAME = "#e4632d", "#667080"


def change_page(result: ChangeResult) -> Page:
    """The page of what changed between two conditions."""
    sections = [
        verdict(result.statement, result.warnings),
        Section("After over before", [_ratios(result.numbers)]),
        Section("Every number", [_table(result.numbers)]),
        made_with(result.machine, result.files, result.command),
    ]
    names = short_names([one.file for group in (result.before, result.after) for one in group])
    files = [", ".join(names[one.file] for one in group) for group in (result.before, result.after)]
    return Page("What changed", f"before: {files[0]}; after: {files[1]}", sections)


def _ratios(numbers: Sequence[ChangedNumber]) -> Figure:
    """Ratios with two standard errors, what changed in another colour."""
    traces = []
    for changed, color, name in ((True, _MOVED, "changed"), (False, _SAME, "as before")):
        of = [one for one in numbers if one.changed is changed and one.ratio.value is not None]
        if of:
            ratio = np.array([one.ratio.value for one in of], dtype=np.float64)
            error = 2.0 * np.array([one.ratio.stderr for one in of], dtype=np.float64)
            bars = {"type": "data", "array": error, "color": color}
            marker = {"color": color, "size": 10}
            hover = "%{y}: %{x:.4g} times<extra></extra>"
            traces.append(dots(name, ratio, [one.said for one in of], marker, hover, error_x=bars))
    line = {"type": "line", "x0": 1.0, "x1": 1.0, "yref": "paper", "y0": 0.0, "y1": 1.0, "line": {"color": "rule"}}
    layout = axes("after over before", "", shapes=[line])
    caption = "Bars are two standard errors, which count what repeats differ by."
    return Figure("ratios", traces, layout, caption, height=120 + 45 * len(numbers))


def _table(numbers: Sequence[ChangedNumber]) -> Table:
    columns = [
        Column("before", lambda one: measured(one.before), "", "all recordings before, jointly"),
        Column("after", lambda one: measured(one.after), "", "as before where it did not change"),
        Column("after over before", lambda one: measured(one.ratio), "", "as if it might have changed"),
        Column("changed", lambda one: Cell("yes" if one.changed else "no")),
        Column(
            "repeats differ by",
            lambda one: shown_number(one.repeats, _unit(one), 2),
            "",
            "standard deviation beyond errors",
        ),
    ]
    return tabulated("", columns, numbers, lambda one: ", ".join(filter(None, (one.said, shown_unit(_unit(one))))))


def _unit(one: ChangedNumber) -> str:
    return "1" if one.before is None else one.before.unit
