"""Two engines, versions, interpreters or sweeps: what moved from one to the other."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from harness.app.shared.leaving import FILES, leave, leaving
from harness.app.shared.machine import this_machine
from harness.app.shared.progress import SILENT, Progress
from harness.app.sweep.regress import Rows, Version, against, by_version, counterpart, fresh_rows, version_of
from harness.app.sweep.sweep import RESULT, SweepOptions
from harness.core.bounded import MOST_DOCUMENT_BYTES, read_bytes
from harness.core.errors import InputError, SimulationError, did_you_mean
from harness.engines import registry
from harness.fidelity.compare import REGRESSIONS, is_regression, kept, moved_rows
from harness.fidelity.select import Selection
from harness.results.sweep import Baseline, DiffResult, DiffSide, Moved, SweepResult
from harness.show.report.diff import diff_lines, diff_page, side_name, uncompared

__all__ = ["diff", "diff_lines", "uncompared"]


@dataclass(frozen=True, slots=True)
class Side:
    """given : as it was named. rows : by name."""

    given: str
    rows: Rows

    @property
    def about(self) -> DiffSide:
        engines = sorted({_called(version_of(row)) for row in self.rows.values()})
        return DiffSide(given=self.given, engines=engines, rows=len(self.rows))

    @property
    def name(self) -> str:
        return side_name(self.about)


def _called(version: Version) -> str:
    engine, number, place = version
    return f"{engine} {number}" + (f" ({place})" if place else "")


def stored_rows(path: Path) -> Rows:
    """Rows of a sweep, its folder or its result, or of a baseline, by name. Raises InputError for what is neither."""
    accepted = "a folder or result of harness sweep, or a baseline"
    inside = [path / RESULT, path / "baseline.json"] if path.is_dir() else [path]
    file = next((one for one in inside if one.is_file()), None)
    if file is None:
        raise InputError(str(path), f"no {' and no '.join(one.name for one in inside)} in this folder", accepted)
    data = read_bytes(file, MOST_DOCUMENT_BYTES)
    try:
        if b"harness.baseline/1" in data[:200]:
            return {name: row.model_dump() for name, row in Baseline.model_validate_json(data).rows.items()}
        return {row.name: kept(row.model_dump()) for row in SweepResult.model_validate_json(data).rows}
    except ValidationError:
        raise InputError(str(file), "no harness.sweep/1 and no harness.baseline/1", accepted) from None


def side(given: str, options: SweepOptions, baseline: Path | None, progress: Progress = SILENT) -> Side:
    """Rows of NAME, NAME@PYTHON or NAME@VERSION, run as the options say, or of a file.

    baseline : has the rows of versions. Raises InputError for what is none of these.
    """
    name, _, rest = given.partition("@")
    if name not in registry.names():
        if not Path(given).exists():
            known = registry.names()
            accepted = f"one of {', '.join(known)}, or a sweep's folder{did_you_mean(name, known)}"
            raise InputError(given, "no engine, no file and no folder", accepted)
        return Side(given, _wanted(stored_rows(Path(given)), options))
    if not rest or Path(rest).exists() or "/" in rest:
        return Side(given, fresh_rows(replace(options, engines=(given,)), progress))
    if baseline is not None:
        own = {n: row for n, row in stored_rows(baseline).items() if (row["engine"], row["version"]) == (name, rest)}
        if own:
            return Side(given, _wanted(own, options))
    try:
        here = registry.load(name).version()
    except SimulationError:
        here = "none"
    if here != rest:
        lacks = "" if baseline is None else f", and {baseline} has no rows of it"
        raise InputError(given, f"{here} is installed{lacks}", f"try: {_made(name, rest)}")
    return Side(given, fresh_rows(replace(options, engines=(name,)), progress))


def _made(name: str, version: str) -> str:
    """How an interpreter with a version of an engine is made, and named."""
    packages = f"{name}=={version} scipy numba platformdirs lxml"
    return f"python3 -m venv old && old/bin/pip install {packages}, then {name}@old/bin/python in its place"


def _wanted(rows: Rows, options: SweepOptions) -> Rows:
    routes = options.routes or tuple({row["route"] for row in rows.values()})
    return {name: row for name, row in rows.items() if row["route"] in routes and options.rows.runs(name)}


def compared(before: Side, after: Side, rows: Selection) -> DiffResult:
    """Every row of ``after`` against the same of ``before``; rows : known to fail, or skipped."""
    old, paired, lacking = _matched(before, after)
    moved, new = list[Moved](), list[str]()
    for one in moved_rows(old, paired, rows):
        if one.verdict == "new":
            new.append(one.name)
        elif one.verdict == "works":
            lacking[one.name] = f"{before.name} lacks it: {old[one.name]['error']}"
        elif one.verdict == "fails" and old[one.name]["engine"] != paired[one.name]["engine"]:
            lacking[one.name] = f"{after.name} lacks it: {one.why}"
        else:
            moved.append(one)
    failing = {one.name for one in moved if one.verdict in REGRESSIONS}
    passed = {name: why for name in paired if name not in failing and (why := rows.expected(name)) is not None}
    result = DiffResult(
        statement="",
        before=before.about,
        after=after.about,
        rows=sum(name in paired and name not in lacking for name in old),
        moved=sorted(moved, key=_worst_first),
        new=new,
        skipped=lacking,
        passed=passed,
        unused=rows.unused([*after.rows, *old]),
        regressions=sum(map(is_regression, moved)),
        machine=this_machine(),
    )
    return result.model_copy(update={"statement": _statement(result, before.name, after.name)})


def _matched(before: Side, after: Side) -> tuple[Rows, Rows, dict[str, str]]:
    """Rows of ``before`` by the names of ``after``, those to hold against them, and what one of them lacks, and why.

    Two engines are matched as two versions of one are.
    """
    held, fresh = by_version(before.rows), by_version(after.rows)
    pairs = {version: counterpart(version, held) for version in fresh}
    if len(held) == len(fresh) == 1:
        pairs = {next(iter(fresh)): next(iter(held))}
    old = against(held, after.rows, pairs)
    lacking = {_called(one): f"{after.name} has no rows of it" for one in held if one not in pairs.values()}
    labels = {version_of(row): name.partition("/")[0] for name, row in after.rows.items()}
    for own, other in pairs.items():
        if other is None:
            lacking[_called(own)] = f"{before.name} has no rows of it"
            continue
        for rest in held[other].keys() - fresh[own].keys():
            row, name = held[other][rest], f"{labels[own]}/{rest}"
            if own[0] == other[0] and _was_run(rest, row, fresh[own]):
                old[name] = row
            else:
                lacking[name] = f"{after.name} was not run with it"
    paired = {name: row for name, row in after.rows.items() if pairs[version_of(row)] is not None}
    return old, paired, dict(sorted(lacking.items()))


def _worst_first(moved: Moved) -> tuple[bool, bool, float, str]:
    """What fails, then what is known to, then the rest, the largest move of each first."""
    return not is_regression(moved), moved.verdict not in REGRESSIONS, -(moved.times or math.inf), moved.name


def _was_run(rest: str, row: Mapping[str, Any], others: Rows) -> bool:
    """Whether the settings of a row, and its scenario on that route, stand among others."""
    settings = rest.rpartition(row["scenario"])[0]
    alike = any(one["route"] == row["route"] and one["scenario"] == row["scenario"] for one in others.values())
    return alike and any(other.startswith(settings) for other in others)


def _statement(result: DiffResult, before: str, after: str) -> str:
    """What came out, in two sentences."""
    bad = [one for one in result.moved if is_regression(one)]
    better = sum(one.verdict in ("better", "gained") for one in result.moved)
    worst = f" (first {bad[0].metric or 'all'} of {bad[0].name.partition('/')[2]})" if bad else ""
    said = f"{len(bad)} figure{'s are' if len(bad) != 1 else ' is'} worse{worst}, {better} better"
    said = said if result.moved else "nothing moved"
    counts = (("new", len(result.new)), ("skipped", len(result.skipped)))
    rest = "".join(f" {what.capitalize()}: {count}." for what, count in counts if count)
    return f"From {before} to {after}: of {result.rows} rows that both have, {said}.{rest}"


def diff(
    a: str,
    b: str,
    options: SweepOptions,
    baseline: Path | None = None,
    out: Path | None = None,
    progress: Progress = SILENT,
) -> DiffResult:
    """What moved from ``a`` to ``b``, each an engine, NAME@VERSION, NAME@PYTHON, or the folder or file of a sweep.

    out : folder for result.json and report.html, None for reports/diff-TIME here. Raises InputError, StoreError.
    """
    with leaving("diff", out) as output:
        before, after = (side(given, options, baseline, progress) for given in (a, b))
        for one in (before, after):
            if not one.rows:
                raise InputError(one.given, "has no such rows", "other patterns, or none")
        there = {name: output.at(FILES[name]) for name in ("result", "report", "log")}
        result = compared(before, after, options.rows).model_copy(update={"files": there})
        result = result.drawn(partial(diff_page))
        leave(output, result, diff_page(result))
    return result
