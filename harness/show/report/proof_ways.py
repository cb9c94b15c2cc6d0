"""Of a proof on every way that gives a verdict, and of one on real machines.

The curve of detection, way by way, and what probabilities are worth; machine by machine, and what their files could not
be asked.
"""

import math

import numpy as np

from harness.results.prove import PathLevel, PathResult, PathsResult, RealResult
from harness.show import blocks as b
from harness.show.plots import axes, plain
from harness.show.report.proof_figures import BAD, GOOD, rated

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
    return f"{low:g} to {high:g}"


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
