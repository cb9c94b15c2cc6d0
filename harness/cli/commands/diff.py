"""harness diff."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.options import PATH, jobs_option, output_options, rows_options
from harness.cli.output import Output, say, say_all, say_as_it_is, show_rows
from harness.core.bounded import check_file

if TYPE_CHECKING:
    from harness.results.sweep import DiffResult

_MOST = 4
"""Settings of which one side has rows alone, in the terminal."""


@click.command(short_help="Two engines, versions, interpreters or sweeps: what moved from one to the other.")
@click.argument("a")
@click.argument("b")
@click.option("--baseline", type=PATH, metavar="FILE", help="Where the rows of NAME@VERSION are taken from.")
@click.option("--route", "routes", multiple=True, metavar="joint|contact|law", help="Route; may repeat.  [all]")
@click.option("--short", is_flag=True, help="What ships and what is tuned, at one step each.")
@rows_options
@jobs_option
@output_options
def command(
    a: str,
    b: str,
    baseline: Path | None,
    routes: tuple[str, ...],
    short: bool,
    rows: dict[str, Any],
    jobs: int | None,
    to: Output,
) -> int:
    """What moved from A to B beyond its tolerance, what is new, and what was skipped because one of them lacks it.

    A and B are engines (NAME, NAME@VERSION, NAME@PYTHON), or sweeps (a folder, its result.json, a baseline). Exit 1
    when something got worse, fails or is gone.

    \b
    Example: harness diff mujoco@old/bin/python mujoco --short
             harness diff mujoco@3.3.7 mujoco -k joint/ \\
                 --baseline reports/fidelity/baseline.json
             harness diff reports/before reports/after
    """
    if baseline is not None:
        check_file(baseline, f"--baseline {baseline}", "a file of harness regress --update", (".json",))
    from harness.app.sweep.diff import diff
    from harness.app.sweep.sweep import SweepOptions

    options = SweepOptions(routes=routes, short=short, jobs=jobs, **rows)
    with to.told() as progress:
        result = diff(a, b, options, baseline, to.out, progress)
    to.give(result, _print)
    return 1 if result.regressions else 0


def _print(result: "DiffResult") -> None:
    from harness.app.sweep.diff import diff_lines, uncompared

    lines = diff_lines(result)
    if lines:
        heads = ("settings", "scenario", "metric", "before", "after", "x allowed", "verdict")
        rows = [(o.settings, o.scenario, o.metric, o.before, o.after, o.times, o.verdict) for o in lines]
        show_rows(heads, rows, (*heads[:3], heads[-1]))
        say_all(dict.fromkeys(one.why for one in lines if one.why))
    for what, names in uncompared(result).items():
        more = f"; {len(names) - _MOST} more on the page" if len(names) > _MOST else ""
        say_all([f"{what}: {'; '.join(names[:_MOST])}{more}"])
    say_all(f"no row has a name that the pattern {text} means" for text in result.unused)
    say_all(f"{name}: known to fail ({why}), and does not" for name, why in result.passed.items())
    say(result.statement)
    say_as_it_is(f"report: {result.files['report']}")
