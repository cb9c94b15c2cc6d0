"""harness compare."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import output_options, reading_options
from harness.cli.output import check_json, emit_json, show, shows_tables, this_line, with_error
from harness.cli.progress import shown

if TYPE_CHECKING:
    from harness.results.compare import CompareResult


@click.command(short_help="Two traces of any origin: where they part, and in what way.")
@click.argument("sim", type=click.Path(path_type=Path))
@click.argument("real", type=click.Path(path_type=Path))
@reading_options
@click.option("--sim-columns", metavar="MAP", help="Columns of SIM, where they are not those of REAL.")
@click.option("--sim-trace", metavar="NAME", help="Which trace of SIM, where it is a .rrd of several.")
@output_options
def command(
    sim: Path,
    real: Path,
    columns: str | None,
    skip_rows: int,
    rate: float | None,
    start: float | None,
    stop: float | None,
    trace: str | None,
    sim_columns: str | None,
    sim_trace: str | None,
    out: Path | None,
    json_to: str | None,
    quiet: bool,
) -> int:
    """Where a simulated trace SIM and a recorded one REAL part, before any model is fitted.

    The two may be sampled differently and begin at different times; the shift between them is estimated, and the
    difference is held against the noise found in both. Formats as for identify, .rrd of ours included.
    --columns, --skip-rows, --rate and --trace say how REAL is read; where SIM is a file of the same kind they hold for
    it too, unless --sim-columns or --sim-trace says otherwise. --from and --to cut REAL.

    \b
    Example: harness compare simulated.csv measured.csv
             harness compare run/trace.rrd decay.csv --sim-trace "mujoco tuned" --columns "t=t,x=pos[mm]"
    """
    check_json(json_to)
    from harness.app.compare import compare
    from harness.app.reading import ReadOptions

    theirs = ReadOptions(columns, skip_rows, rate, start, stop)
    stored = [path.suffix.lower() == ".rrd" for path in (sim, real)]
    alike = stored[0] == stored[1]
    ours = ReadOptions(sim_columns or columns, skip_rows, rate) if alike else ReadOptions(sim_columns)
    taken = sim_trace or (trace if stored[0] else None)
    with shown(quiet) as progress:
        names = (taken, trace if stored[1] or not stored[0] else None)
        result = compare(sim, real, (ours, theirs), names, out, progress, this_line())
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
    return 0


def _print(result: "CompareResult") -> None:
    from rich.table import Table

    click.echo(f"{result.verdict}: {result.files[0]} and {result.files[1]}")
    click.echo(f"shift {with_error(result.aligned['shift_s'])}")
    table = Table()
    for heading in ("channel", "rms difference", "noise"):
        table.add_column(heading, justify="left" if heading == "channel" else "right")
    for channel, rmse in result.rmse.items():
        noise = result.noise[channel]
        table.add_row(channel, f"{rmse:.4g}", noise if isinstance(noise, str) else f"{noise:.4g}")
    show(table)
    for where in result.where:
        share = "" if where.share is None else f", {100.0 * where.share:.0f} % of the mismatch"
        click.echo(f"- {where.regime}: {where.condition}{share}")
    for sentence in result.sentences:
        click.echo(f"- {sentence}")
    click.echo(f"report: {result.outputs['report']}")
