"""harness dataset."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import PATH, jobs_option, output_options
from harness.cli.output import Output, figure, say, say_all, say_as_it_is, show_rows, this_line
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.dataset import DatasetResult, MachinesResult


@click.command(short_help="Published recordings: what others found beside ours.")
@click.argument("name", metavar="emps|machines", type=click.Choice(["emps", "machines"]))
@click.option("--from", "folder", type=PATH, metavar="DIR", help="Folder of the files.")
@click.option("--download", "into", type=PATH, metavar="DIR", help="emps: download them here first.")
@jobs_option
@output_options
def command(name: str, folder: Path | None, into: Path | None, jobs: int | None, to: Output) -> int:
    """Published recordings, diagnosed beside what others found.

    emps: the drive axis of the nonlinear benchmarks, one file diagnosed and validated on the other; DIR holds
    DATA_EMPS.mat and DATA_EMPS_PULSES.mat from nonlinearbenchmark.org, and both are checked to be those. --download
    needs the extra: pip install 'friction-harness[emps]'.

    machines: recordings of pendulums, a wheel and cylinders, as many as DIR holds; a machines.toml in DIR lists more.

    \b
    Example: harness dataset emps --from downloads/EMPS
             harness dataset machines --from recordings
    """
    if name == "machines":
        if into is not None:
            accepted = f"try: harness dataset machines --from {shlex.quote(str(into))}"
            raise InputError("--download", "given with machines, whose files are fetched by hand", accepted)
        if folder is None:
            raise InputError("--from", "not given; it is the folder with the recordings", "try: harness dataset --help")
        from harness.app.dataset import dataset_machines

        with to.told() as progress:
            machines = dataset_machines(folder, to.out, progress, this_line(), jobs)
        to.give(machines, _print_machines)
        return 1 if any(row.verdict == "error" for row in machines.rows) else 0
    if jobs is not None:
        raise InputError("--jobs", "given with emps, which is one recording", "it goes with machines")
    from harness.app.dataset import dataset_emps, download_emps

    if (folder is None) == (into is None):
        if into is None:
            raise InputError("--from, --download", "neither", "try: --download emps")
        raise InputError("--from, --download", "both", "one of the two")
    with to.told() as progress:
        if folder is None:
            assert into is not None
            folder = download_emps(into)
        result = dataset_emps(folder, to.out, progress, this_line())
    to.give(result, _print)
    return 0


def _print_machines(result: "MachinesResult") -> None:
    rows = [
        (
            row.name,
            row.verdict,
            "\n".join(f"{m.name} ({m.grade})" for m in row.found) or "-",
            "\n".join(figure(m.share, ".0f", " %", 100.0) for m in row.found) or "-",
            "\n".join(figure(m.holdout, ".2g", before="x ") for m in row.found) or "-",
        )
        for row in result.rows
    ]
    heads = ("machine", "verdict", "named or listed", "explains", "held out")
    show_rows(heads, rows, heads[:3])
    say_all(f"{row.name}: {row.said}" for row in result.rows if row.verdict == "error")
    if result.absent:
        say(f"- not in the folder: {', '.join(result.absent)}")
    say_as_it_is(f"report: {result.files['page']}")


def _print(result: "DatasetResult") -> None:
    rows = [
        (
            row.label,
            figure(row.mass_kg),
            ", ".join(figure(value) for value in row.viscous),
            *(figure(value) for value in (row.dry_n, row.offset_n, row.fit_error_percent, row.cross_error_percent)),
        )
        for row in result.rows
    ]
    show_rows(("model", "mass kg", "viscous N s/m", "dry N", "offset N", "fit %", "cross %"), rows)
    say_all([*result.found, result.unexplained])
    say_as_it_is(f"report: {result.files['page']}")
