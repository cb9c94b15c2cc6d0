"""The page of a comparison of two engines or sweeps: what moved, and how far; what is new, what was skipped."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from harness.fidelity.compare import is_regression
from harness.results.sweep import DiffResult, DiffSide, Moved
from harness.show.blocks import Cell, Column, Figure, Folded, Items, Page, Section, tabulated, verdict
from harness.show.numbers import number
from harness.show.plots import axes, decades, dots
from harness.show.report.page import made_with

_GRADES = {"better": 0, "gained": 0}
_WORST = 4
_COLORS, _SYMBOLS = {"worse": "#e4632d", "better": "#2b7fd6"}, {"worse": "circle", "better": "diamond"}
_FEWEST = 3
"""Points of a plot."""


@dataclass(frozen=True, slots=True)
class Line:
    """settings : a row's name without its scenario. times : the change over what is allowed."""

    settings: str
    scenario: str
    metric: str
    before: str
    after: str
    times: str
    verdict: str
    why: str
    grade: int | None


def diff_lines(result: DiffResult) -> list[Line]:
    """What moved, the worst first."""
    one = _one_each(result)
    return [_moved(found, one) for found in result.moved]


def uncompared(result: DiffResult) -> dict[str, list[str]]:
    """What one side alone has, and what was skipped: by what it is, settings with their scenarios."""
    one = _one_each(result)
    groups = {"new": result.new}
    for why in dict.fromkeys(result.skipped.values()):
        groups[f"skipped ({why})"] = [name for name, own in result.skipped.items() if own == why]
    return {what: _together(names, one) for what, names in groups.items() if names}


def _one_each(result: DiffResult) -> bool:
    return len(result.after.engines) == len(result.before.engines) == 1


def _moved(found: Moved, one: bool) -> Line:
    known = "" if found.expected is None else f"known: {found.expected}"
    grade = _WORST if is_regression(found) else _GRADES.get(found.verdict)
    before, after = ("" if value is None else f"{value:.4g}" for value in (found.before, found.after))
    times = number(found.times, 3) if found.times is not None else ""
    settings, _, scenario = _shown(found.name, one).rpartition("/")
    why = known or ("" if found.metric else found.why)
    return Line(settings, scenario, found.metric, before, after, times, found.verdict, why, grade)


def _together(names: Iterable[str], one: bool) -> list[str]:
    groups: dict[str, list[str]] = {}
    for name in names:
        settings, _, scenario = _shown(name, one).rpartition("/")
        groups.setdefault(settings or scenario, []).extend([scenario] if settings else [])
    return [f"{settings}{': ' if own else ''}{', '.join(own)}" for settings, own in groups.items()]


def _shown(name: str, one: bool) -> str:
    """A row's name, without its engine where there is one alone."""
    return name.partition("/")[2] or name if one else name


def diff_page(result: DiffResult) -> Page:
    """The page."""

    def note(line: Line) -> str:
        settings = line.settings.replace("/", " / ").replace(",", ", ")
        return f"{settings}{f'; {line.why}' if line.why else ''}"

    columns = [
        Column("metric", lambda line: line.metric),
        Column("before", lambda line: line.before),
        Column("after", lambda line: line.after),
        Column("change", lambda line: line.times, "x allowed", "over what the metric may move by"),
        Column("verdict", lambda line: Cell(line.verdict, grade=line.grade)),
    ]
    caption = (
        "Better is nearer to the exact answer, worse farther from it; what stays within its tolerance is not listed."
    )
    table = tabulated("row", columns, diff_lines(result), lambda line: line.scenario, note, caption=caption)
    others = [Folded(f"{what}: {len(names)}", [Items(names)]) for what, names in uncompared(result).items()]
    said = [f"{name}: known to fail ({why}), and does not." for name, why in result.passed.items()]
    said += [f"No row has a name that the pattern {text} means." for text in result.unused]
    sections = [
        verdict(result.statement, said),
        Section("What moved", [*_far(result), table] if table.rows else []),
        Section("New or skipped", others),
        made_with(result.machine, result.files, ""),
    ]
    title = f"From {side_name(result.before)} to {side_name(result.after)}"
    return Page(title, f"{result.rows} rows that both have", sections)


def _far(result: DiffResult) -> list[Figure]:
    """How far each figure moved, a line a metric; one alone is in the table."""
    moved = [found for found in result.moved if found.times is not None and found.verdict in _COLORS]
    if len(moved) < _FEWEST:
        return []
    metrics = sorted({found.metric for found in moved}, key=lambda name: max(_times(moved, name)))
    traces = []
    for verdict_, color in _COLORS.items():
        own = [found for found in moved if found.verdict == verdict_]
        marker = {"color": color, "size": 9, "symbol": _SYMBOLS[verdict_]}
        x, y = [found.times for found in own], [found.metric for found in own]
        text = [found.name for found in own]
        traces.append(
            dots(verdict_, x, y, marker, "%{text}<br>%{x:.3g} times what is allowed<extra></extra>", text=text)
        )
    layout = axes("change over what is allowed", "", showlegend=True)
    layout["xaxis"] |= decades([found.times or 0.0 for found in moved])
    layout["yaxis"] |= {"categoryorder": "array", "categoryarray": metrics, "type": "category"}
    return [Figure("moved", traces, layout, "Each point is a figure of a row.", height=110 + 26 * len(metrics))]


def _times(moved: Sequence[Moved], metric: str) -> list[float]:
    return [found.times or 0.0 for found in moved if found.metric == metric]


def side_name(side: DiffSide) -> str:
    """One of two in sentences: its engine where it has one alone, else what it was given as."""
    return side.engines[0] if len(side.engines) == 1 else side.given
