"""Plots and tables of a proof: figures with their intervals, what was said of what was hidden, way by way, by machine.

Of a proof on every way that gives a verdict the curve of detection, and what probabilities are worth; of one on real
machines what their files could not be asked.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from harness.results.prove import Detection, PathLevel, PathResult, PathsResult, ProofFigure, RateResult, RealResult
from harness.show import blocks as b
from harness.show.blocks import Cell, Figure, Section
from harness.show.numbers import number
from harness.show.plots import Trace, axes, dots, plain

GOOD, BAD = "#1f9e77", "#d1495b"
NOTHING, CANNOT_TELL, ABSENT, SEVERAL = "nothing", "cannot tell", "no result", "several names"
OUTSIDE = "alien-"
Rate = RateResult | ProofFigure


def _bounds(rates: Sequence[Rate], width: int) -> Trace:
    """Bars of exact intervals, in per cent."""
    looks = {"type": "data", "symmetric": False, "color": "muted", "thickness": 1.4, "width": width}
    return looks | {
        "array": [100.0 * ((one.high or 0.0) - (one.value or 0.0)) for one in rates],
        "arrayminus": [100.0 * ((one.value or 0.0) - (one.low or 0.0)) for one in rates],
    }


def intervals(name: str, rows: Sequence[tuple[str, Rate, str, str]], caption: str) -> Figure:
    """Shares as dots with their intervals, one a line; rows : label, share, colour, note, the first on top."""
    shown = [row for row in rows if row[1].value is not None]
    trace = dots(
        "",
        np.array([100.0 * (rate.value or 0.0) for _, rate, _, _ in shown]),
        [label for label, *_ in shown],
        {"color": [color for _, _, color, _ in shown], "size": 8},
        "%{y}: %{x:.1f} %<br>%{text}<extra></extra>",
        error_x=_bounds([rate for _, rate, _, _ in shown], 3),
        text=[note for *_, note in shown],
        showlegend=False,
    )
    del trace["name"]
    layout = {
        "xaxis": {"title": {"text": "%"}, "range": [-2, 102], "zeroline": False},
        "yaxis": {"autorange": "reversed", "type": "category", "ticks": ""},
        "margin": {"l": 64, "r": 16, "t": 12, "b": 42},
    }
    return Figure(name, [trace], layout, caption, height=90 + 22 * len(shown))


def confusion(counts: Mapping[str, Mapping[str, int]], order: Sequence[str]) -> Section:
    """counts : what was hidden -> what was said -> recordings. order : names of the catalogue in their order."""
    alone: dict[str, dict[str, int]] = {}
    for true, said in counts.items():
        if " + " not in true:
            row = alone.setdefault(true, {})
            for label, count in said.items():
                column = label if label in (NOTHING, CANNOT_TELL, ABSENT) or label in order else SEVERAL
                row[column] = row.get(column, 0) + count
    rows = [name for name in (NOTHING, *order) if name in alone] + sorted(n for n in alone if n.startswith(OUTSIDE))
    seen = {column for row in alone.values() for column in row}
    columns = [NOTHING, *(name for name in order if name in seen or name in alone)]
    columns += [name for name in (SEVERAL, CANNOT_TELL, ABSENT) if name in seen or name == CANNOT_TELL]
    notes = [
        {"x": column, "y": row, "text": str(count), "showarrow": False, "font": {"size": 11, "color": "ink"}}
        for row in rows
        for column, count in alone[row].items()
    ]

    def heat(right: bool, color: str) -> Trace:
        """Shares of each line that are right, or wrong."""
        red, green, blue = (int(color[i : i + 2], 16) for i in (1, 3, 5))
        shares = []
        for row in rows:
            good, total = CANNOT_TELL if row.startswith(OUTSIDE) else row, sum(alone[row].values())
            shares.append(
                [alone[row][c] / total if c in alone[row] and (c == good) == right else None for c in columns]
            )
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
    traces = [heat(True, GOOD), heat(False, BAD)]
    figure = Figure("confusion", traces, layout, caption, height=190 + 21 * len(rows), least=230 + 24 * len(columns))
    return Section("What was hidden, what was said", [figure])


def detection(curve: Detection) -> Section:
    """The same cases under growing noise."""
    levels = [level for level in curve.levels if level.named.value is not None]
    rates = [level.named for level in levels]
    traces = [
        plain(
            "named",
            np.array([level.loss for level in levels]),
            np.array([100.0 * (rate.value or 0.0) for rate in rates]),
            GOOD,
            2,
            mode="lines+markers",
            error_y=_bounds(rates, 4),
            text=[f"{rate.hits} of {rate.cases}" for rate in rates],
            hovertemplate="loss %{x:.4g}: %{y:.0f} %<br>%{text}<extra></extra>",
            marker={"size": 8},
        )
    ]
    for name, at, dash, color in (
        ("half are named", curve.half, "dash", GOOD),
        ("what BIC charges", curve.limit, "dot", "ink"),
    ):
        if at is not None:
            traces.append(plain(name, [at, at], [0, 100], color, line={"color": color, "width": 1.4, "dash": dash}))
    layout = axes("likelihood loss without the effect", "named / %")
    layout["xaxis"] |= {"type": "log", "exponentformat": "power"}
    layout["yaxis"]["range"] = [-3, 103]
    said = "The curve does not cross a half."
    if curve.half is not None:
        said = f"Half are named at a loss of {curve.half:.0f} ({curve.low:.0f} to {curve.high:.0f})."
    caption = (
        "The same cases under growing noise, from right to left. What a recording holds of an effect is the "
        "chi-square that the best model without it loses; below the dotted line BIC charges more for its numbers "
        f"than that, and nobody who goes by BIC can name it. {said}"
    )
    return Section("Where naming stops", [Figure("detection", traces, layout, caption, height=380)])


def rated(rate: RateResult) -> Cell:
    """Hits of cases, with the interval."""
    if rate.value is None or rate.low is None or rate.high is None:
        return Cell(number(None))
    return Cell(f"{rate.hits} of {rate.cases}", (f"{100.0 * rate.low:.1f} to {100.0 * rate.high:.1f} %",))


_SAID = {"named": GOOD, "listed": "#8ac6b0", "silent": "#7a8594", "wrong": BAD}


def curve(found: PathsResult) -> b.Section:
    """What was said against what an effect is worth, and the limit of the likelihood."""
    # in the middle of each class, in its logarithm; the first reaches down to nothing
    at = np.array([math.sqrt(max(one.low, 0.1) * one.high) for one in found.levels])
    traces = []
    for name, color in _SAID.items():
        share = np.array([100.0 * (getattr(one, name).value or 0.0) for one in found.levels])
        traces.append(plain(name, at, share, color, 2, mode="lines+markers", marker={"size": 8}))
    # a law of two numbers pays 2 ln N of chi-square for them, half of that of likelihood
    limit = math.log(2000.0)
    style = {"color": "ink", "width": 1.4, "dash": "dot"}
    traces.append(plain("what BIC charges for two numbers", [limit, limit], [0, 100], "ink", line=style))
    layout = axes("worth / effective samples", "of the effects / %")
    layout["xaxis"] |= {"type": "log", "exponentformat": "power"}
    layout["yaxis"]["range"] = [-3, 103]
    caption = (
        "What an effect is worth is the log-likelihood that the base model is expected to lose. Left of the dotted "
        "line nobody who goes by BIC can name it; it is drawn for 2000 samples."
    )
    columns = [
        b.Column("effects", lambda one: str(one.cases)),
        *(b.Column(name, b.by(name, lambda one, key: rated(getattr(one, key)))) for name in _SAID),
    ]
    table = b.tabulated("worth", columns, found.levels, _between, caption="With exact 95 % intervals.")
    return b.Section("What is told of an effect", [b.Figure("paths", traces, layout, caption, height=380), table])


def _between(level: PathLevel) -> str:
    low, high = (float(f"{one:.3g}") for one in (level.low, level.high))
    return f"{low:g} to {high:g}" if high > low else f"above {low:g}"  # the last level has no end


_WAYS = {
    "told": "told, worth above 20",
    "bare": "the same without options",
    "wrong": "effects called others",
    "misled": "unknown effects named",
    "alarms": "false alarms",
    "covered": "within two errors",
}


def ways(found: PathsResult) -> b.Section:
    """Way by way, then the probabilities."""
    columns = [b.Column(head, b.by(key, lambda one, name: rated(getattr(one, name)))) for key, head in _WAYS.items()]
    said = b.tabulated("way", columns, found.ways, _name, caption="With exact 95 % intervals.")
    bins = [
        b.Column("verdicts", lambda one: str(one.held.cases)),
        b.Column("mean probability", lambda one: f"{one.said:.2f}"),
        b.Column("held", lambda one: rated(one.held)),
    ]
    caption = "The likeliest explanation of each verdict that gives one, by its probability."
    sure = b.tabulated(
        "probability", bins, found.reliability, lambda one: f"{one.low:.1f} to {one.high:.1f}", caption=caption,
        title="What probabilities are worth",
    )  # fmt: skip
    return b.Section("Way by way", [said, sure])


def _name(way: PathResult) -> str:
    return way.path


_HEADS = {
    "told": "constructed laws named or listed",
    "moved": "constructed gain, clock, damping: its number alone moved",
    "wrong": "constructed, called another",
    "alarms": "delays called anything",
    "switched": "switched causes first, alone",
    "switched_wrong": "switched, another cause",
    "repeats": "repeats called different",
}


def machines(found: RealResult) -> b.Section:
    columns = [
        b.Column("files", lambda one: str(one.files)),
        *(b.Column(head, b.by(key, lambda one, name: rated(getattr(one, name)))) for key, head in _HEADS.items()),
    ]
    caption = "With exact 95 % intervals; those of the figures above are resampled over machines."
    table = b.tabulated("machine", columns, found.machines, lambda one: one.machine, caption=caption)
    missing = [b.Items(found.not_run)] if found.not_run else []
    return b.Section("Machine by machine", [table, *missing])
