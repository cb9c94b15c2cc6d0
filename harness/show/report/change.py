"""The page of a change: what changed, what did not, every number before and after."""

from collections.abc import Sequence
from pathlib import PurePath

import numpy as np

from harness.results.change import ChangedNumber, ChangeResult
from harness.show.blocks import Cell, Column, Figure, Page, Section, Table, measured, tabulated, verdict
from harness.show.numbers import NONE, number
from harness.show.plots import axes, dots
from harness.show.report.page import made_with

_MOVED, _SAME = "#e4632d", "#667080"


def change_page(result: ChangeResult) -> Page:
    """The page of what changed between two conditions."""
    sections = [
        verdict(result.statement, result.warnings),
        Section("After over before", [_ratios(result.numbers)]),
        Section("Every number", [_table(result.numbers)]),
        made_with(result.machine, result.files, result.command),
    ]
    files = [", ".join(PurePath(one.file).name for one in group) for group in (result.before, result.after)]
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
        Column("repeats differ by", lambda one: number(one.repeats, 2), "", "standard deviation beyond errors"),
    ]
    return tabulated("", columns, numbers, lambda one: one.said + _unit(one))


def _unit(one: ChangedNumber) -> str:
    unit = NONE if one.before is None else one.before.unit
    return "" if unit in (NONE, "1", "") else f", {unit}"
