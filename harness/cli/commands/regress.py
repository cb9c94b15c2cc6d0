"""harness regress."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.options import PATH, engines_option, jobs_option, json_options, rows_options
from harness.cli.output import Output, figure, say, say_all, show_rows
from harness.core.bounded import check_file
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.sweep import Moved, RegressResult


@click.command(short_help="A sweep against a baseline: what moved, and whether that is a regression.")
@click.option("--baseline", type=PATH, metavar="FILE", help="Rows to compare with.")
@click.option("--update", is_flag=True, help="Write the rows to --baseline instead of comparing.")
@click.option("--traces", type=PATH, metavar="DIR", help="Recompute from .rrd files; no engine.")
@click.option("--junit", "junit_to", type=PATH, metavar="FILE", help="Write JUnit XML.")
@engines_option("all installed")
@click.option("--route", "routes", multiple=True, metavar="joint|contact|law", help="Route; may repeat.  [all]")
@click.option("--short", is_flag=True, help="What ships and what is tuned, at one step each: for every change.")
@rows_options
@click.option(
    "--github/--no-github",
    envvar="GITHUB_ACTIONS",
    help="Annotations for GitHub's page of a run.  [where GITHUB_ACTIONS is set]",
)
@jobs_option
@json_options
def command(
    baseline: Path | None,
    update: bool,
    traces: Path | None,
    junit_to: Path | None,
    engines: tuple[str, ...],
    routes: tuple[str, ...],
    short: bool,
    rows: dict[str, Any],
    github: bool,
    jobs: int | None,
    to: Output,
) -> int:
    """A sweep, or stored traces, against a baseline. Exit 1 when something got worse, fails or is gone.

    Speed never counts, nor does what --xfail names. A pattern is part of a row's name, or a whole one with *
    and ?. With --traces alone, every metric and estimate is recomputed from the .rrd files and has to be the stored one
    to the last bit.

    \b
    Example: harness regress --baseline reports/fidelity/baseline.json --short \\
                 --junit friction.xml
             harness regress --baseline mine.json --update --engine mujoco
             harness regress --baseline mine.json -k joint/tuned \\
                 --skip "*/harmonic" --xfail "mujoco@*/belt: known"
             harness regress --traces reports/fidelity/traces
    """
    if baseline is None and (update or traces is None):
        raise InputError("--baseline", "not given", "try: --baseline friction.json --update")
    if update and traces is not None:
        raise InputError("--update", "given with --traces", "one of them: a baseline is made by a sweep")
    if baseline is not None and not update:
        check_file(baseline, f"--baseline {baseline}", "try: --update", (".json",))
    from harness.app.shared.deliver import check_writable, write_text
    from harness.app.sweep import regress as room
    from harness.app.sweep.sweep import SweepOptions

    for target in (junit_to, baseline if update else None):
        if target is not None:
            check_writable(target)
    options = SweepOptions(engines, routes, short=short, jobs=jobs, **rows)
    if traces is not None:
        result, names = room.compared_traces(traces, baseline, options.rows), []
    else:
        assert baseline is not None
        if not update:
            room.load_baseline(baseline)
        with to.told() as progress:
            fresh = room.fresh_rows(options, progress)
        names = list(fresh)
        if update:
            written = room.update(baseline, fresh, options)
            to.give(written, lambda _: say(f"{baseline}: {len(written.rows)} rows"))
            return 0
        result = room.compared(baseline, fresh, options)
    if junit_to is not None:
        write_text(junit_to, room.junit(result, names))
    to.give(result, _print)
    for line in room.annotations(result) if github else ():
        click.echo(line, err=not to.tables)
    return 1 if result.regressions else 0


def _print(result: "RegressResult") -> None:
    if result.moved:
        heads = ("row", "metric", "baseline", "now", "verdict")
        rows = [
            (one.name, one.metric, figure(one.before, ".6g"), figure(one.after, ".6g"), f"{one.verdict}{_known(one)}")
            for one in result.moved
        ]
        show_rows(heads, rows, heads)
        say_all(dict.fromkeys(f"{moved.metric or moved.name}: {moved.why}" for moved in result.moved))
    say_all(f"{engine} is in the baseline but not installed here" for engine in result.not_run)
    say_all(f"no row has a name that the pattern {text} means" for text in result.unused)
    say_all(f"{name}: known to fail ({why}), and does not" for name, why in result.passed.items())
    skipped = f"{len(result.skipped)} skipped, " if result.skipped else ""
    say(f"{result.rows} rows compared, {skipped}{len(result.moved)} moves, {result.regressions} regressions")


def _known(one: "Moved") -> str:
    return "" if one.expected is None else f", known: {one.expected}"
