"""harness view."""

from pathlib import Path

import click


@click.command(short_help="Open a run in the rerun viewer.")
@click.argument("place", metavar="DIR|FILE.rrd", type=click.Path(path_type=Path))
@click.option("--web", is_flag=True, help="In the browser instead of a window.")
def command(place: Path, web: bool) -> int:
    """Open the .rrd in DIR, or FILE.rrd, in the rerun viewer.

    \b
    Example: harness view reports/free-decay-20260101-120000
             harness view trace.rrd --web
    """
    from harness.app.report.view import view

    return view(place, web)
