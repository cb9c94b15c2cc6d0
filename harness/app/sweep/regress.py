"""A sweep, or stored traces, against a baseline."""

import re
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.app.sweep.report import recomputed
from harness.app.sweep.sweep import SweepOptions, sweep
from harness.core.bounded import MOST_DOCUMENT_BYTES, read_bytes
from harness.core.errors import InputError
from harness.engines import registry
from harness.fidelity.compare import REGRESSIONS, kept, moves
from harness.io.store import write_text
from harness.results.sweep import Baseline, BaselineRow, Moved, RegressResult

Rows = dict[str, dict[str, Any]]
Version = tuple[str, str, str]
"""Engine, version, environment."""


def load_baseline(path: Path) -> Baseline:
    """Read a baseline; raises InputError for what is none."""
    try:
        return Baseline.model_validate_json(read_bytes(path, MOST_DOCUMENT_BYTES))
    except InputError as error:
        raise InputError(f"--baseline {path}", error.found, "a file --update wrote is accepted") from None
    except ValidationError:
        raise InputError(f"--baseline {path}", "no harness.baseline/1", "a file --update wrote is accepted") from None


def fresh_rows(options: SweepOptions, progress: Progress = SILENT) -> Rows:
    """Sweep in a folder that goes away; rows by name, what a baseline keeps of them."""
    with tempfile.TemporaryDirectory(prefix="friction-harness-") as folder:
        result = sweep(options, Path(folder) / "sweep", progress)
        return {row["name"]: kept(row) for row in result.rows()}


def update(path: Path, rows: Rows) -> Baseline:
    """Write rows as the baseline; those of engines and versions that were not run stay. Raises StoreError."""
    found = dict(rows)
    if path.is_file():
        run = {_version(row) for row in rows.values()}
        old = {name: row.model_dump() for name, row in load_baseline(path).rows.items()}
        found |= {name: row for name, row in old.items() if _version(row) not in run}
    baseline = Baseline(
        machine=this_machine(), rows={name: BaselineRow.model_validate(found[name]) for name in sorted(found)}
    )
    # a row a line, so that a version control system can show what changed
    lines = ",\n  ".join(f'"{name}": {row.model_dump_json()}' for name, row in baseline.rows.items())
    head = f'{{\n "schema": "harness.baseline/1",\n "machine": {baseline.machine.model_dump_json()},\n "rows": {{\n  '
    write_text(path, f"{head}{lines}\n }}\n}}\n")
    return baseline


def _version(row: Mapping[str, Any]) -> Version:
    return str(row["engine"]), str(row["version"]), str(row["environment"])


def _rest(name: str) -> str:
    """What a row's name holds besides its engine and version."""
    return name.partition("/")[2]


def counterpart(of: Version, known: Iterable[Version]) -> Version | None:
    """Which engine and version of a baseline to hold against this one.

    The same; else the same version of another environment; else the newest version of the engine; None without any.
    """
    same = [version for version in known if version[0] == of[0]]

    def order(version: Version) -> tuple[Any, ...]:
        numbers = [int(part) for part in re.findall(r"\d+", version[1])]
        return version == of, version[1] == of[1], not version[2], numbers, version[2]

    return max(same, key=order, default=None)


def _held(path: Path) -> dict[Version, Rows]:
    """Rows of a baseline by engine and version, each by what its name holds besides."""
    found: dict[Version, Rows] = {}
    for name, row in load_baseline(path).rows.items():
        found.setdefault(_version(row.model_dump()), {})[_rest(name)] = row.model_dump()
    return found


def _against(held: Mapping[Version, Rows], fresh: Rows) -> Rows:
    """The counterpart of every row that has one, by the fresh row's name."""
    found: Rows = {}
    for name, row in fresh.items():
        version = counterpart(_version(row), held)
        if version is not None and _rest(name) in held[version]:
            found[name] = held[version][_rest(name)]
    return found


def compared(path: Path, rows: Rows, options: SweepOptions) -> RegressResult:
    """Rows of a fresh sweep against the baseline, version against the same version or, without one, the newest.

    Rows that only the baseline has are missing, unless the options leave them out or their version was not run.
    """
    held = _held(path)
    before = _against(held, rows)
    if not (options.short or options.presets or options.steps or options.routes):
        labels = {_version(row): name.partition("/")[0] for name, row in rows.items()}
        every = {f"{label}/{rest}": row for of, label in labels.items() for rest, row in held.get(of, {}).items()}
        before |= {name: row for name, row in every.items() if name not in rows}
    absent = {engine for engine, _, _ in held} - {row["engine"] for row in rows.values()}
    not_run = sorted(absent & {name for name, why in registry.available().items() if why is not None})
    return _result(str(path), before, rows, not_run, sorted(set(before) | set(rows)))


def _result(
    path: str, before: Mapping[str, Mapping[str, Any]], after: Rows, not_run: list[str], names: Iterable[str]
) -> RegressResult:
    found = [move for name in names for move in moves(name, before.get(name), after.get(name))]
    versions = {
        name.partition("/")[0]: {"baseline": row["version"], "now": after[name]["version"]}
        for name, row in before.items()
        if name in after
    }
    return RegressResult(
        baseline=path,
        rows=len(after),
        moved=found,
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
        after = {row["name"]: kept(row) for row, _ in rows}
        return _result(str(baseline), _against(_held(baseline), after), after, [], sorted(after))
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


def sentence(moved: Moved) -> str:
    if not moved.metric:
        return f"{moved.verdict}: {moved.why}"
    return f"{moved.metric} {moved.verdict}: {moved.before} -> {moved.after}, allowed {moved.why}"
