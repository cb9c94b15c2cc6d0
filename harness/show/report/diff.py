"""The page of a comparison of two engines or sweeps: one table of what moved, what is new, what was skipped."""

from collections.abc import Iterable
from dataclasses import dataclass

from harness.fidelity.compare import is_regression
from harness.results.sweep import DiffResult, DiffSide, Moved
from harness.show.blocks import Cell, Column, Page, Section, tabulated, verdict
from harness.show.numbers import number
from harness.show.report.page import made_with

_GRADES = {"better": 0, "gained": 0}
_WORST = 4


@dataclass(frozen=True, slots=True)
class Line:
    """settings : a row's name without its scenario. times : the change over what is allowed."""

    settings: str
    scenarios: tuple[str, ...]
    metric: str = ""
    before: str = ""
    after: str = ""
    times: str = ""
    verdict: str = ""
    why: str = ""
    grade: int | None = None

    @property
    def about(self) -> str:
        """Its scenario, or how many."""
        if not self.scenarios:
            return "every row"
        return self.scenarios[0] if len(self.scenarios) == 1 else f"{len(self.scenarios)} scenarios"


def diff_lines(result: DiffResult) -> list[Line]:
    """What moved, the worst first; then what is new and what was skipped, scenarios of the same settings together."""
    one = len(result.after.engines) == len(result.before.engines) == 1
    lines = [_moved(found, one) for found in result.moved] + _together(result.new, "new", "", one)
    for why in dict.fromkeys(result.skipped.values()):
        lines += _together([name for name, own in result.skipped.items() if own == why], "skipped", why, one)
    return lines


def _moved(found: Moved, one: bool) -> Line:
    known = "" if found.expected is None else f"known: {found.expected}"
    grade = _WORST if is_regression(found) else _GRADES.get(found.verdict)
    before, after = ("" if value is None else f"{value:.6g}" for value in (found.before, found.after))
    times = number(found.times, 3) if found.times is not None else ""
    settings, _, scenario = _shown(found.name, one).rpartition("/")
    why = known or ("" if found.metric else found.why)
    return Line(settings, (scenario,), found.metric, before, after, times, found.verdict, why, grade)


def _together(names: Iterable[str], verdict: str, why: str, one: bool) -> list[Line]:
    groups: dict[str, list[str]] = {}
    for name in names:
        settings, _, scenario = _shown(name, one).rpartition("/")
        groups.setdefault(settings or scenario, []).extend([scenario] if settings else [])
    return [Line(settings, tuple(own), verdict=verdict, why=why) for settings, own in groups.items()]


def _shown(name: str, one: bool) -> str:
    """A row's name, without its engine where there is one alone."""
    return name.partition("/")[2] or name if one else name


def diff_page(result: DiffResult) -> Page:
    """The page."""

    def note(line: Line) -> str:
        settings = line.settings.replace("/", " / ").replace(",", ", ")
        several = f": {', '.join(line.scenarios)}" if len(line.scenarios) > 1 else ""
        return f"{settings}{several}{f'; {line.why}' if line.why else ''}"

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
    table = tabulated("row", columns, diff_lines(result), lambda line: line.about, note, caption=caption)
    said = [f"{name}: known to fail ({why}), and does not." for name, why in result.passed.items()]
    said += [f"No row has a name that the pattern {text} means." for text in result.unused]
    sections = [
        verdict(result.statement, said),
        Section("What moved, what is new, what was skipped", [table] if table.rows else []),
        made_with(result.machine, result.files, ""),
    ]
    title = f"From {side_name(result.before)} to {side_name(result.after)}"
    return Page(title, f"{result.rows} rows that both have", sections)


def side_name(side: DiffSide) -> str:
    """One of two in sentences: its engine where it has one alone, else what it was given as."""
    return side.engines[0] if len(side.engines) == 1 else side.given
