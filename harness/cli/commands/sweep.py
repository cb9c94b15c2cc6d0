"""harness sweep."""

from typing import TYPE_CHECKING, Any

import click

from harness.cli.options import cluster_option, engines_option, jobs_option, output_options
from harness.cli.output import Output, say, say_all, say_as_it_is, show_rows, this_line

if TYPE_CHECKING:
    from harness.app.sweep.sweep import Sweep


def _worst(context: click.Context, option: click.Parameter, value: str | None) -> int:
    """The N of worst:N."""
    if value is None:
        return 0
    kind, _, count = value.partition(":")
    if kind != "worst" or not count.isdigit() or int(count) < 1:
        raise click.BadParameter(f"{value!r}; expected worst:N with N of 1 or more")
    return int(count)


@click.command(short_help="The friction-fidelity matrix: engines x route x settings x step x scenario.")
@engines_option("all installed")
@click.option("--route", "routes", multiple=True, metavar="joint|contact|law", help="Route; may repeat.  [all]")
@click.option("--preset", "presets", multiple=True, metavar="NAME", help="Settings; may repeat.  [all there are]")
@click.option("--dt", "steps", multiple=True, type=float, metavar="S", help="Step, s; may repeat.  [a table's own]")
@click.option("--sliders", type=click.IntRange(min=0), default=0, metavar="N", help="Random sliders besides.  [0]")
@click.option("--short", is_flag=True, help="What ships and what is tuned, at one step each.")
@click.option("--keep-traces", "keep", callback=_worst, metavar="worst:N", help="Keep the worst N rows as .rrd.")
@cluster_option
@click.option("--resume", is_flag=True, help="Go on with the rows that --out holds; nothing is computed again.")
@jobs_option
@output_options
def command(to: Output, **chosen: Any) -> int:
    """The friction-fidelity matrix: every engine, route, setting, step and scenario against exact answers.

    Rows go to Parquet files in the output folder as they are done, and from there into result.json and report.html.

    \b
    Example: harness sweep
             harness sweep --engine mujoco --route joint --dt 0.002 --json -
             harness sweep --out reports/mine --resume --keep-traces worst:10
    """
    from harness.app.sweep.report import finish
    from harness.app.sweep.sweep import Sweep, SweepOptions, sweep

    options = SweepOptions(**chosen)
    with to.told() as progress:
        result = sweep(options, to.out, progress, this_line())
        finish(result, options, progress)
    to.give(result, _print, Sweep.json)
    return 1 if result.failed else 0


def _print(result: "Sweep") -> None:
    from harness.app.sweep.report import summary

    heads, lines = summary(result)
    show_rows(heads, lines, heads[:3], "as shipped and tuned against exact, the suite's own sliders")
    say_all(result.notes)
    rate = f"{60.0 * result.computed / result.wall_s:.0f} rows a minute"
    say(f"{result.total} rows, {result.computed} computed now ({rate}), {result.failed} could not be run")
    say_as_it_is(f"report: {result.folder / 'report.html'}")
