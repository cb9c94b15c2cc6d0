"""harness dataset."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import output_options
from harness.cli.output import check_json, emit_json, say, say_as_it_is, shows_tables, this_line
from harness.cli.progress import shown
from harness.cli.tables import show
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.dataset import DatasetResult


@click.command(short_help="A published case: its figures beside ours.")
@click.argument("name", metavar="emps", type=click.Choice(["emps"]))
@click.option("--from", "folder", type=click.Path(path_type=Path), metavar="DIR", help="Folder of the two files.")
@click.option(
    "--download", "into", type=click.Path(path_type=Path), metavar="DIR", help="Download them into this folder first."
)
@output_options
def command(
    name: str, folder: Path | None, into: Path | None, out: Path | None, json_to: str | None, quiet: bool
) -> int:
    """The published drive-axis case (EMPS): the diagnosis of one file, validated on the other.

    DIR holds DATA_EMPS.mat and DATA_EMPS_PULSES.mat from nonlinearbenchmark.org; both are checked to be those.
    --download needs the extra: pip install 'friction-harness[emps]'.

    \b
    Example: harness dataset emps --from downloads/EMPS
    """
    check_json(json_to)
    from harness.app.dataset.download import download_emps
    from harness.app.dataset.emps import dataset_emps

    if (folder is None) == (into is None):
        raise InputError("--from, --download", "neither" if into is None else "both", "one of the two is accepted")
    with shown(quiet) as progress:
        if folder is None:
            assert into is not None
            folder = download_emps(into)
        result = dataset_emps(folder, out, progress, this_line())
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
    return 0


def _print(result: "DatasetResult") -> None:
    from rich.table import Table

    table = Table()
    for heading in ("model", "mass kg", "viscous N s/m", "dry N", "offset N", "fit %", "cross %"):
        table.add_column(heading, justify="left" if heading == "model" else "right")
    for row in result.rows:
        numbers = (row.dry_n, row.offset_n, row.fit_error_percent, row.cross_error_percent)
        table.add_row(
            row.label,
            _said(row.mass_kg),
            ", ".join(_said(value) for value in row.viscous),
            *(_said(value) for value in numbers),
        )
    show(table)
    for sentence in result.found:
        say(f"- {sentence}")
    say(f"- {result.unexplained}")
    say_as_it_is(f"report: {result.files['page']}")


def _said(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"
