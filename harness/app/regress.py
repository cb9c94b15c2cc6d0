"""A sweep, or stored traces, against a baseline."""

import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from harness.app.machine import this_machine
from harness.app.progress import SILENT, Progress
from harness.app.sweep import SweepOptions, engines_for, sweep
from harness.app.sweep_traces import recomputed
from harness.core.errors import InputError
from harness.engines import registry
from harness.fidelity.compare import REGRESSIONS, kept, moves
from harness.io.store import write_text
from harness.results.regress import Baseline, BaselineRow, Moved, RegressResult

Rows = dict[str, dict[str, Any]]


def load_baseline(path: Path) -> Baseline:
    """Read a baseline; raises InputError for what is none."""
    try:
        return Baseline.model_validate_json(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(
            f"--baseline {path}", error.strerror or str(error), "a file --update wrote is accepted"
        ) from None
    except (ValidationError, UnicodeDecodeError):
        raise InputError(f"--baseline {path}", "no harness.baseline/1", "a file --update wrote is accepted") from None


def fresh_rows(options: SweepOptions, progress: Progress = SILENT) -> Rows:
    """Sweep in a folder that goes away; rows by name, what a baseline keeps of them."""
    with tempfile.TemporaryDirectory(prefix="friction-harness-") as folder:
        result = sweep(options, Path(folder) / "sweep", progress)
        return {row["name"]: kept(row) for row in result.rows()}


def update(path: Path, rows: Rows, options: SweepOptions) -> Baseline:
    """Write rows as the baseline; those of engines that were not asked for stay as they are. Raises StoreError."""
    found = dict(rows)
    if options.engines and path.is_file():
        old = load_baseline(path)
        found |= {n: row.model_dump() for n, row in old.rows.items() if row.engine not in options.engines}
    baseline = Baseline(
        machine=this_machine(), rows={name: BaselineRow.model_validate(found[name]) for name in sorted(found)}
    )
    write_text(path, _one_row_a_line(baseline))
    return baseline


def _one_row_a_line(baseline: Baseline) -> str:
    """JSON that a version control system can show the changes of."""
    rows = ",\n  ".join(f'"{name}": {row.model_dump_json()}' for name, row in baseline.rows.items())
    machine = baseline.machine.model_dump_json()
    return f'{{\n "schema": "harness.baseline/1",\n "machine": {machine},\n "rows": {{\n  {rows}\n }}\n}}\n'


def compared(path: Path, rows: Rows, options: SweepOptions) -> RegressResult:
    """Rows of a fresh sweep against the baseline.

    Rows that only the baseline has are missing, unless the options leave them out or their engine is not installed.
    """
    baseline = load_baseline(path)
    installed = set(engines_for(options))
    partial = bool(options.short or options.presets or options.steps or options.routes)
    before = {
        name: row.model_dump()
        for name, row in baseline.rows.items()
        if name in rows or (row.engine in installed and not partial)
    }
    absent = {row.engine for row in baseline.rows.values()} - installed
    not_run = sorted(absent & {name for name, why in registry.available().items() if why is not None})
    return _result(str(path), before, rows, not_run, sorted(set(before) | set(rows)))


def _result(
    path: str, before: Mapping[str, Mapping[str, Any]], after: Rows, not_run: list[str], names: Iterable[str]
) -> RegressResult:
    found = [move for name in names for move in moves(name, before.get(name), after.get(name))]
    versions = {
        row["engine"]: {"baseline": row["version"], "now": after[name]["version"]}
        for name, row in before.items()
        if name in after
    }
    return RegressResult(
        baseline=path,
        rows=len(after),
        moved=[Moved(**asdict(move)) for move in found],
        regressions=sum(move.verdict in REGRESSIONS for move in found),
        not_run=not_run,
        versions=versions,
        machine=this_machine(),
    )


def compared_traces(folder: Path, baseline: Path | None) -> RegressResult:
    """Metrics and estimates recomputed from every .rrd below a folder, without any engine.

    Against a baseline they are held to its tolerances; without one, to the very bits that were stored. Raises
    InputError when there is no trace of a sweep.
    """
    files = sorted(folder.rglob("*.rrd"))
    if not files:
        raise InputError(f"--traces {folder}", "no .rrd files", "the traces folder of a sweep is accepted")
    rows = [recomputed(file) for file in files]
    if baseline is not None:
        known = load_baseline(baseline).rows
        before = {row["name"]: known[row["name"]].model_dump() for row, _ in rows if row["name"] in known}
        after = {row["name"]: kept(row) for row, _ in rows}
        return _result(str(baseline), before, after, [], sorted(after))
    found = []
    for row, stored in rows:
        for metric in dict.fromkeys([*stored, *row["metrics"]]):
            old, new = stored.get(metric), row["metrics"].get(metric)
            if old != new:
                why = "without a baseline not one bit may differ"
                found.append(Moved(name=row["name"], metric=metric, before=old, after=new, verdict="worse", why=why))
    return RegressResult(
        baseline="what the traces hold", rows=len(rows), moved=found, regressions=len(found), machine=this_machine()
    )


def junit(result: RegressResult, names: Iterable[str]) -> str:
    """The result as JUnit XML: one test case a row, its regressions as a failure."""
    from lxml import etree

    bad: dict[str, list[Moved]] = {}
    for moved in result.moved:
        if moved.verdict in REGRESSIONS:
            bad.setdefault(moved.name, []).append(moved)
    cases = sorted(set(names) | set(bad))
    suite = etree.Element(
        "testsuite", name="friction fidelity", tests=str(len(cases)), failures=str(len(bad)), errors="0"
    )
    for name in cases:
        engine, _, rest = name.partition("/")
        case = etree.SubElement(suite, "testcase", classname=f"friction.{engine}", name=rest)
        if name in bad:
            lines = [sentence(moved) for moved in bad[name]]
            etree.SubElement(case, "failure", message=lines[0]).text = "\n".join(lines)
    root = etree.Element("testsuites")
    root.append(suite)
    return str(etree.tostring(root, xml_declaration=True, encoding="utf-8", pretty_print=True).decode())


def write_junit(path: Path, result: RegressResult, names: Iterable[str]) -> None:
    """Write ``junit`` to a file, whole or not at all; raises StoreError."""
    write_text(path, junit(result, names))


def sentence(moved: Moved) -> str:
    """One move in a line."""
    if not moved.metric:
        return f"{moved.verdict}: {moved.why}"
    return f"{moved.metric} {moved.verdict}: {moved.before} -> {moved.after}, allowed {moved.why}"
