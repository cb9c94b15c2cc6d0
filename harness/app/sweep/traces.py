"""Traces of a sweep's rows: the engine's motion and the exact one over each other, and the row recomputed from them."""

import heapq
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from harness.app.shared.progress import SILENT, Progress
from harness.app.sweep.sweep import TRACES, Sweep, SweepOptions, engines_for
from harness.core.errors import InputError
from harness.core.writing import explained
from harness.fidelity.kind import kind_of
from harness.fidelity.row import Spec, describe, measure_row, scenario_of, task
from harness.fidelity.scores import badness, settings_of
from harness.show.report.run_scene import run_scene
from harness.show.stored import read_trace
from harness.show.trace import write_trace

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
            write_row_trace(folder / name, engines[spec.engine].simulate, spec, row)
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


def write_row_trace(path: Path, simulate: Callable[..., Any], spec: Spec, row: dict[str, Any]) -> None:
    """Write one row's motion with the exact one; raises StoreError, SimulationError."""
    trace = simulate(task(spec))
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
        raise InputError(str(path), "no trace of a sweep", "a .rrd that --keep-traces wrote is accepted") from None
    before = dict(row["metrics"])
    row["metrics"] = measure_row(stored.trajectories[1], scenario)
    return row, before
