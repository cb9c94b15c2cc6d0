"""What is made of a finished sweep: result.json, traces of the worst rows, the page, a table for people."""

from harness.app.shared.progress import SILENT, Progress
from harness.app.sweep.sweep import PAGE, RESULT, TRACES, Sweep, SweepOptions
from harness.app.sweep.traces import keep_worst
from harness.fidelity.scores import Card, cards
from harness.io.store import write_text
from harness.show.blocks import Page
from harness.show.report.page import made_with, write_report
from harness.show.report.sweep import Worst, sweep_sections
from harness.show.sentences.sweep import percent
from harness.show.stored import read_trace

BRIEF = ("position", "x_k wide", "x_k narrow", "zeta", "creep 97 %", "belt period", "forced", "lift")
"""Figures of the table in the terminal."""


def finish(result: Sweep, options: SweepOptions, progress: Progress = SILENT) -> None:
    """Write traces/, result.json and report.html into the folder; raises StoreError."""
    kept = keep_worst(result, options, progress)
    progress("writing result.json and report.html", result.total, result.total)
    write_page(result, kept)
    write_text(result.folder / RESULT, result.json())


def write_page(result: Sweep, kept: dict[str, str]) -> None:
    """The page; kept : names of trace files by the name of their row."""
    rows = [row for row in result.rows() if not row["draw"]]
    by_name = {row["name"]: row for row in rows}
    worst = []
    for name, file in sorted(kept.items(), key=lambda item: item[1]):
        exact, engine = read_trace(result.folder / TRACES / file).trajectories
        worst.append(Worst(by_name[name], file, exact, engine))
    versions = ", ".join(dict.fromkeys(f"{row['engine']} {row['version']}" for row in rows))
    failed = f", {result.failed} of them could not be run" if result.failed else ""
    subtitle = f"{result.total} rows{failed}: {versions}; every figure against an exact answer"
    sections = [
        *sweep_sections(rows, result.convergence(), worst, result.notes),
        made_with(result.machine, {"rows": "rows", "result": "result.json"}, result.command),
    ]
    write_report(result.folder / PAGE, Page("What engine settings do to Coulomb friction", subtitle, sections))


def summary(result: Sweep) -> tuple[tuple[str, ...], list[list[str]]]:
    """Heads and lines of the table: what ships and what is tuned, by engine and route, distances from exact."""
    lines = []
    found = cards(result.rows())
    kinds = {(card.engine, card.version, card.environment) for card in found}
    for card in found:
        values = [_share(card.values.get(label)) for label in BRIEF]
        alone = sum(card.engine == engine for engine, _, _ in kinds) == 1
        lines.append([card.engine if alone else _named(card), card.route, card.preset, *values])
    return ("engine", "route", "settings", *BRIEF), lines


def _named(card: Card) -> str:
    """An engine of which there are two, told apart."""
    return f"{card.engine} {card.version}" + (f" ({card.environment})" if card.environment else "")


def _share(value: float | None) -> str:
    return "-" if value is None else percent(value).replace("less than ", "<")
