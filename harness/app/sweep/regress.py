"""A sweep, or stored traces, against a baseline."""

import re
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.app.sweep.report import recomputed
from harness.app.sweep.sweep import SweepOptions, engines_for, sweep
from harness.core.bounded import MOST_DOCUMENT_BYTES, read_bytes
from harness.core.errors import InputError
from harness.engines import registry
from harness.fidelity.compare import REGRESSIONS, is_regression, kept, moved_rows
from harness.fidelity.select import Selection
from harness.io.store import write_text
from harness.results.sweep import Baseline, BaselineRow, Moved, RegressResult

Rows = dict[str, dict[str, Any]]
_ANOTHER = "try: --baseline friction.json --update"
Version = tuple[str, str, str]
"""Engine, version, environment."""


def load_baseline(path: Path) -> Baseline:
    """Read a baseline; raises InputError for what is none."""
    try:
        return Baseline.model_validate_json(read_bytes(path, MOST_DOCUMENT_BYTES))
    except InputError as error:
        raise InputError(f"--baseline {path}", error.found, _ANOTHER) from None
    except ValidationError:
        raise InputError(f"--baseline {path}", "no harness.baseline/1", _ANOTHER) from None


def fresh_rows(options: SweepOptions, progress: Progress = SILENT) -> Rows:
    """Sweep in a folder that goes away; rows by name, what a baseline keeps of them.

    Raises InputError where no row has a name that was asked for.
    """
    with tempfile.TemporaryDirectory(prefix="friction-harness-") as folder:
        result = sweep(options, Path(folder) / "sweep", progress)
        found = {row["name"]: kept(row) for row in result.rows()}
    if not found and options.rows != Selection():
        name = next(iter(matrix_names(options)), "mujoco/joint/tuned")
        raise InputError("-k, --skip", "no row is left", f"try: -k {name}")
    return found


def matrix_names(options: SweepOptions) -> list[str]:
    """Names of all rows there are, run or skipped."""
    matrix = replace(options.matrix, rows=Selection())
    return [spec.name for spec in matrix.specs(engines_for(options))]


def update(path: Path, rows: Rows, options: SweepOptions) -> Baseline:
    """Write rows as the baseline; what these options did not run stays. Raises StoreError."""
    found = dict(rows)
    if path.is_file():
        run = {version_of(row) for row in rows.values()}
        old = {name: row.model_dump() for name, row in load_baseline(path).rows.items()}
        rerun = {name for name, row in old.items() if version_of(row) in run and options.rows.runs(name)}
        found = {name: row for name, row in old.items() if not options.whole or name not in rerun} | found
    baseline = Baseline(
        machine=this_machine(), rows={name: BaselineRow.model_validate(found[name]) for name in sorted(found)}
    )
    # a row a line, so that a version control system can show what changed
    lines = ",\n  ".join(f'"{name}": {row.model_dump_json()}' for name, row in baseline.rows.items())
    head = f'{{\n "schema": "harness.baseline/1",\n "machine": {baseline.machine.model_dump_json()},\n "rows": {{\n  '
    write_text(path, f"{head}{lines}\n }}\n}}\n")
    return baseline


def version_of(row: Mapping[str, Any]) -> Version:
    return str(row["engine"]), str(row["version"]), str(row["environment"])


def rest_of(name: str) -> str:
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


def by_version(rows: Rows) -> dict[Version, Rows]:
    """Rows by engine and version, each by what its name holds besides."""
    found: dict[Version, Rows] = {}
    for name, row in rows.items():
        found.setdefault(version_of(row), {})[rest_of(name)] = row
    return found


def held(path: Path) -> dict[Version, Rows]:
    """Rows of a baseline by engine and version. Raises InputError for what is none."""
    return by_version({name: row.model_dump() for name, row in load_baseline(path).rows.items()})


def against(held: Mapping[Version, Rows], fresh: Rows, pairs: Mapping[Version, Version | None] | None = None) -> Rows:
    """The counterpart of every row that has one, by the fresh row's name. pairs : None for those of ``counterpart``."""
    found: Rows = {}
    for name, row in fresh.items():
        own = version_of(row)
        version = counterpart(own, held) if pairs is None else pairs[own]
        if version is not None and rest_of(name) in held[version]:
            found[name] = held[version][rest_of(name)]
    return found


def known_rows(held: Mapping[Version, Rows], labels: Mapping[Version, str]) -> Rows:
    """Rows of these versions by their whole names. labels : what a name begins with, by version."""
    return {f"{label}/{rest}": row for of, label in labels.items() for rest, row in held.get(of, {}).items()}


def compared(path: Path, rows: Rows, options: SweepOptions) -> RegressResult:
    """Rows of a fresh sweep against the baseline, version against the same version or, without one, the newest.

    Rows that only the baseline has are missing, unless the options leave them out or their version was not run.
    """
    known = held(path)
    before = against(known, rows)
    if options.whole:
        labels = {version_of(row): name.partition("/")[0] for name, row in rows.items()}
        every = known_rows(known, labels)
        before |= {name: row for name, row in every.items() if name not in rows and options.rows.runs(name)}
    absent = {engine for engine, _, _ in known} - {row["engine"] for row in rows.values()}
    missing = {} if options.engines else registry.available()
    not_run = sorted(absent & {name for name, why in missing.items() if why is not None})
    if options.rows == Selection():
        return _result(str(path), before, rows, not_run)
    return _result(str(path), before, rows, not_run, options.rows, matrix_names(options))


def _result(
    path: str,
    before: Rows,
    after: Rows,
    not_run: list[str],
    rows: Selection | None = None,
    names: Iterable[str] = (),
) -> RegressResult:
    """rows : known to fail, or skipped. names : of all rows there are."""
    rows, names = rows or Selection(), [*names]
    found = moved_rows(before, after, rows)
    failing = {move.name for move in found if move.verdict in REGRESSIONS}
    skipped = ((name, rows.skipped(name)) for name in names if rows.chosen(name))
    passed = ((name, rows.expected(name)) for name in after if name in before and name not in failing)
    versions = {
        name.partition("/")[0]: {"baseline": row["version"], "now": after[name]["version"]}
        for name, row in before.items()
        if name in after
    }
    return RegressResult(
        baseline=path,
        rows=len(after),
        moved=found,
        regressions=sum(map(is_regression, found)),
        not_run=not_run,
        skipped={name: why for name, why in skipped if why is not None},
        passed={name: why for name, why in passed if why is not None},
        unused=rows.unused(names),
        versions=versions,
        machine=this_machine(),
    )


def compared_traces(folder: Path, baseline: Path | None, rows: Selection | None = None) -> RegressResult:
    """Metrics and estimates recomputed from every .rrd below a folder, without any engine.

    Against a baseline they are held to its tolerances; without one, to the very bits that were stored. Raises
    InputError when there is no trace of a sweep. rows : which are looked at, and which are known to fail.
    """
    files = sorted(folder.rglob("*.rrd"))
    if not files:
        raise InputError(f"--traces {folder}", "no .rrd files", "the traces folder of a sweep")
    rows = rows or Selection()
    found = {row["name"]: (row, stored) for row, stored in map(recomputed, files) if rows.runs(row["name"])}
    if baseline is not None:
        after = {name: kept(row) for name, (row, _) in found.items()}
        return _result(str(baseline), against(held(baseline), after), after, [], rows, found)
    moved = []
    for name, (row, stored) in found.items():
        for metric in dict.fromkeys([*stored, *row["metrics"]]):
            old, new = stored.get(metric), row["metrics"].get(metric)
            if old != new:
                why, known = "without a baseline not one bit may differ", rows.expected(name)
                one = Moved(name=name, metric=metric, before=old, after=new, verdict="worse", why=why, expected=known)
                moved.append(one)
    return RegressResult(
        baseline="what the traces hold",
        rows=len(found),
        moved=moved,
        regressions=sum(map(is_regression, moved)),
        machine=this_machine(),
    )
