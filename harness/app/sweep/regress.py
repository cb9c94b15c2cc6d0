"""A sweep, or stored traces, against a baseline, and what a gate found as systems of continuous integration read it."""

import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
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
        result = sweep(options, Path(folder) / "sweep", progress, stays=False)
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
    path: str, before: Rows, after: Rows, not_run: list[str], rows: Selection | None = None, names: Iterable[str] = ()
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
        raise InputError(f"--traces {folder}", "no .rrd files", "try: harness sweep --keep-traces worst:10")
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


MOST = 10
"""Annotations of a kind that GitHub shows for a step."""


def sentence(moved: Moved) -> str:
    if not moved.metric:
        return f"{moved.verdict}: {moved.why}"
    return f"{moved.metric} {moved.verdict}: {moved.before} -> {moved.after}, allowed {moved.why}"


def by_row(moved: Iterable[Moved]) -> dict[str, list[Moved]]:
    """What got worse, known or not, by the row's name."""
    bad: dict[str, list[Moved]] = {}
    for one in moved:
        if one.verdict in REGRESSIONS:
            bad.setdefault(one.name, []).append(one)
    return bad


def junit(result: RegressResult, names: Iterable[str]) -> str:
    """JUnit XML: one test case a row, its regressions as a failure; skipped and known to fail as pytest writes them."""
    from lxml import etree

    bad = by_row(result.moved)
    cases = sorted({*names, *bad, *result.skipped})
    failures = [name for name, found in bad.items() if any(map(is_regression, found))]
    counts = {"tests": len(cases), "failures": len(failures), "errors": 0}
    suite = etree.Element("testsuite", name="friction fidelity", **{name: str(n) for name, n in counts.items()})
    suite.set("skipped", str(len(result.skipped) + len(bad) - len(failures)))
    for name in cases:
        engine, _, rest = name.partition("/")
        case = etree.SubElement(suite, "testcase", classname=f"friction.{engine}", name=rest)
        if name in result.skipped:
            etree.SubElement(case, "skipped", type="pytest.skip", message=result.skipped[name])
        elif name in bad:
            lines, known = [sentence(moved) for moved in bad[name]], bad[name][0].expected
            if known is None:
                etree.SubElement(case, "failure", message=lines[0]).text = "\n".join(lines)
            else:
                etree.SubElement(case, "skipped", type="pytest.xfail", message=known).text = "\n".join(lines)
    root = etree.Element("testsuites")
    root.append(suite)
    return str(etree.tostring(root, xml_declaration=True, encoding="utf-8", pretty_print=True).decode())


def annotations(result: RegressResult) -> list[str]:
    """Workflow commands: errors of rows that got worse, warnings of what was not compared, notices of what passed."""
    bad = {name: found for name, found in by_row(result.moved).items() if any(map(is_regression, found))}
    errors = [_command("error", name, "\n".join(map(sentence, found))) for name, found in bad.items()]
    absent = [_command("warning", name, "in the baseline but not installed here") for name in result.not_run]
    unused = [_command("warning", text, "no row has a name that this pattern means") for text in result.unused]
    passed = [_command("notice", name, f"known to fail ({why}), and does not") for name, why in result.passed.items()]
    return [*_some("error", errors), *_some("warning", [*absent, *unused]), *_some("notice", passed)]


def _some(kind: str, lines: Sequence[str]) -> Iterator[str]:
    """As many as are shown, the last of which says how many there are besides."""
    yield from lines if len(lines) <= MOST else lines[: MOST - 1]
    if len(lines) > MOST:
        yield _command(kind, f"{len(lines) - MOST + 1} more", "the log of this step has them all")


def _command(kind: str, title: str, text: str) -> str:
    def escaped(value: str, marks: str) -> str:
        return "".join(f"%{ord(letter):02X}" if letter in marks else letter for letter in value)

    lines = "%\r\n"
    return f"::{kind} title={escaped(f'friction {title}', f'{lines}:,')}::{escaped(text, lines)}"
