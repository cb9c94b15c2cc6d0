"""harness report."""

from pathlib import Path

import click

from harness.cli.options import json_option, quiet_option
from harness.cli.output import check_json, emit_json, say_as_it_is, shows_tables


@click.command(short_help="Make a page again, from its .rrd alone.")
@click.argument("place", metavar="DIR|FILE.rrd", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), metavar="FILE", help="The page, a new file.")
@json_option
@quiet_option
def command(place: Path, out: Path | None, json_to: str | None, quiet: bool) -> int:
    """Make an HTML page again from the .rrd in DIR, or from FILE.rrd alone.

    Metrics and estimates are computed anew from the samples it holds. The page is DIR/report.html, or FILE.html.

    \b
    Example: harness report reports/free-decay-20260101-120000
             harness report trace.rrd --out page.html
    """
    from harness.app.report.view import find_trace

    find_trace(place)  # before what reads it is loaded
    check_json(json_to)
    from harness.app.report.rebuild import rebuild

    result, page = rebuild(place, out)
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        say_as_it_is(f"report: {page}")
    return 0
