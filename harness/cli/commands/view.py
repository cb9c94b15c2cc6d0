"""harness view."""

from pathlib import Path

import click

from harness.cli.options import PATH


@click.command(short_help="Open runs in the rerun viewer.")
@click.argument("places", metavar="DIR|FILE.rrd...", nargs=-1, required=True, type=PATH)
@click.option("--web", is_flag=True, help="In the browser instead of a window.")
@click.option(
    "--save",
    metavar="FILE.rrd",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write several laid over each other to a file, and open nothing.",
)
def command(places: tuple[Path, ...], web: bool, save: Path | None) -> int:
    """Open the .rrd in DIR, or FILE.rrd, in the rerun viewer; several are laid over each other in the same plots.

    \b
    Example: harness view reports/free-decay-20260101-120000
             harness view trace.rrd --web
             harness view shipped tuned --save both.rrd
    """
    from harness.app.view import overlay, view
    from harness.core.errors import InputError

    if save is None:
        return view(places, web)
    if save.suffix.lower() != ".rrd":
        raise InputError("--save", str(save), "a name that ends in .rrd")
    if save.exists():
        raise InputError("--save", f"{save} exists already", "the name of a new file")
    overlay(places, save)
    click.echo(f"trace: {save.absolute()}")
    return 0
