"""What is made of a finished sweep: result.json, the page, a table for people, and traces of rows.

A trace has the engine's motion and the exact one over each other, and the row can be recomputed from it.
"""

import heapq
import re
from pathlib import Path
from typing import Any

from harness.app.shared.progress import SILENT, Progress
from harness.app.sweep.sweep import PAGE, RESULT, TRACES, Sweep, SweepOptions, engines_for
from harness.core.errors import InputError
from harness.core.writing import explained
from harness.engines.base import Engine
from harness.fidelity.kind import kind_of
from harness.fidelity.row import Spec, describe, measure_row, scenario_of, task
from harness.fidelity.scores import Card, badness, cards, settings_of
from harness.io.store import write_text
from harness.show.blocks import Page
from harness.show.report.motion import run_scene
from harness.show.report.page import made_with, write_report
from harness.show.report.sweep import Worst, sweep_sections
from harness.show.sentences import percent
from harness.show.stored import read_trace
from harness.show.trace import write_trace

BRIEF = ("position", "x_k wide", "x_k narrow", "zeta", "creep 97 %", "belt period", "forced", "lift")
"""Figures of the table in the terminal."""


def finish(result: Sweep, options: SweepOptions, progress: Progress = SILENT) -> Page:
    """Write traces/, result.json and report.html into the folder; returns the page. Raises StoreError."""
    kept = keep_worst(result, options, progress)
    progress("writing result.json and report.html", result.total, result.total)
    page = _page(result, kept)
    write_report(result.folder / PAGE, page)
    write_text(result.folder / RESULT, result.json())
    return page


def _page(result: Sweep, kept: dict[str, str]) -> Page:
    """kept : names of trace files by the name of their row."""
    rows = [row for row in result.rows() if not row["draw"]]
    by_name = {row["name"]: row for row in rows}
    worst = []
    for name, file in sorted(kept.items(), key=lambda item: item[1]):
        exact, engine = read_trace(result.folder / TRACES / file).trajectories
        worst.append(Worst(by_name[name], file, exact, engine))
    versions = ", ".join(dict.fromkeys(f"{row['engine']} {row['version']}" for row in rows))
    failed = f", of which {result.failed} could not be run" if result.failed else ""
    subtitle = f"{versions}: {result.total} rows{failed}; every figure against an exact answer"
    sections = [
        *sweep_sections(rows, result.convergence(), worst, result.notes),
        made_with(result.machine, {"rows": "rows", "result": "result.json"}, result.command),
    ]
    return Page("What engine settings do to Coulomb friction", subtitle, sections)


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


SCHEMA = "harness.sweep-trace/1"

_Ranked = tuple[float, str, dict[str, Any]]


def keep_worst(result: Sweep, options: SweepOptions, progress: Progress = SILENT) -> dict[str, str]:
    """Simulate the worst rows once more, bitwise the same, and write each as traces/NUMBER-NAME.rrd.

    Nothing is kept while rows are computed, so that memory stays flat. Returns files by the row's name.
    """
    if not options.keep:
        return {}
    places = {row["key"]: (place, row) for place, row in enumerate(worst_rows(result, options.keep), 1)}
    engines = engines_for(options)
    folder = result.folder / TRACES
    with explained(folder):
        folder.mkdir(exist_ok=True)
    written: dict[str, str] = {}
    for spec in options.matrix.specs(engines):
        found = places.get(spec.key)
        if found is not None:
            place, row = found
            progress("traces written", len(written), len(places))
            name = f"{place:03d}-{re.sub(r'[^A-Za-z0-9.-]+', '-', row['name'])[:120]}.rrd"
            write_row_trace(folder / name, engines[spec.engine], spec, row)
            written[row["name"]] = name
    return written


def worst_rows(result: Sweep, count: int) -> list[dict[str, Any]]:
    """The worst row of each engine, route and scenario, the worst first; when there are not enough, the next worst."""
    firsts: dict[tuple[str, ...], _Ranked] = {}
    others: list[_Ranked] = []
    for row in result.rows():
        if row["error"] is not None:
            continue
        ranked = (badness(row), row["name"], row)
        group = (row["engine"], row["version"], row["environment"], row["route"], row["scenario"])
        first = firsts.get(group)
        if first is None or ranked[:2] > first[:2]:
            firsts[group], ranked = ranked, first or ranked
        if first is not None:
            others = heapq.nlargest(count, [*others, ranked], key=_by_badness)
    leaders = heapq.nlargest(count, firsts.values(), key=_by_badness)
    return [row for _, _, row in [*leaders, *others][:count]]


def _by_badness(entry: _Ranked) -> tuple[float, str]:
    return entry[0], entry[1]


def write_row_trace(path: Path, engine: Engine, spec: Spec, row: dict[str, Any]) -> None:
    """Write one row's motion with the exact one; raises StoreError, SimulationError."""
    trace = engine.simulate(task(engine, spec))
    exact = kind_of(spec.scenario).exact(spec.scenario, trace.t)
    notes = "\n".join(
        [f"# {row['engine']} {row['version']}, {row['scenario']}", "", settings_of(row), ""]
        + [f"- {name}: {value}" for name, value in row["metrics"].items()]
    )
    about = {"schema": SCHEMA, "row": row}
    write_trace(path, run_scene([exact, trace], describe(spec.scenario), about, notes))


def recomputed(path: Path) -> tuple[dict[str, Any], dict[str, float | None]]:
    """The row of a stored trace with metrics and estimates computed again, and the metrics it was stored with.

    Raises InputError for a trace that no sweep wrote.
    """
    stored = read_trace(path)
    try:
        about = stored.properties["result"]
        if about["schema"] != SCHEMA:
            raise KeyError(about["schema"])
        row = {"environment": ""} | about["row"]  # traces of before it was told
        scenario = scenario_of(stored.properties["scenario"])
    except (KeyError, TypeError):
        raise InputError(str(path), "no trace of a sweep", "a .rrd that --keep-traces wrote") from None
    before = dict(row["metrics"])
    row["metrics"] = measure_row(stored.trajectories[1], scenario)
    return row, before
