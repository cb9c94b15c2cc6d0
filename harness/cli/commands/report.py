"""harness report."""

from pathlib import Path

import click

from harness.cli.options import PATH, json_options
from harness.cli.output import Output, say_as_it_is


@click.command(short_help="Make a page again, from its .rrd alone.")
@click.argument("place", metavar="DIR|FILE.rrd", type=PATH)
@click.option("--out", type=PATH, metavar="FILE", help="The page, a new file.")
@json_options
def command(place: Path, out: Path | None, to: Output) -> int:
    """Make an HTML page again from the .rrd in DIR, or from FILE.rrd alone.

    Metrics and estimates are computed anew from the samples it holds. The page is DIR/report.html, or FILE.html.

    \b
    Example: harness report reports/free-decay-20260101-120000
             harness report trace.rrd --out page.html
    """
    from harness.app.view import find_trace

    find_trace(place)  # before what reads it is loaded
    from harness.app.report import rebuild

    result, page = rebuild(place, out)
    to.give(result, lambda _: say_as_it_is(f"report: {page}"))
    return 0
