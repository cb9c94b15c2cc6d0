"""harness compare."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import output_options, reading_options
from harness.cli.output import check_json, emit_json, say, say_as_it_is, shows_tables, this_line, with_error
from harness.cli.progress import shown
from harness.cli.tables import show
from harness.core.bounded import check_file
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.compare import CompareResult


@click.command(short_help="Two traces of any origin: where they part, and in what way.")
@click.argument("sim", type=click.Path(path_type=Path))
@click.argument("real", type=click.Path(path_type=Path))
@reading_options
@click.option("--sim-columns", metavar="MAP", help="Columns of SIM, where they are not those of REAL.")
@click.option("--sim-trace", metavar="NAME", help="Which trace of SIM, where it is a .rrd of several.")
@click.option("--shift", type=float, metavar="S", help="Added to the times of SIM, s.  [found]")
@click.option("--no-shift", is_flag=True, help="The two are on one clock: as --shift 0.")
@output_options
def command(
    sim: Path,
    real: Path,
    columns: str | None,
    skip_rows: int,
    rate: float | None,
    start: float | None,
    stop: float | None,
    drop_nan: bool,
    trace: str | None,
    sim_columns: str | None,
    sim_trace: str | None,
    shift: float | None,
    no_shift: bool,
    out: Path | None,
    json_to: str | None,
    quiet: bool,
) -> int:
    """Where a simulated trace SIM and a recorded one REAL part, before any model is fitted.

    The two may be sampled differently and begin at different times: they are laid over each other first, release on
    release where they differ, and the difference is held against the noise found in both. Formats as for identify,
    .rrd of ours included.
    --columns, --skip-rows, --rate and --trace say how REAL is read; where SIM is a file of the same kind they hold for
    it too, unless --sim-columns or --sim-trace says otherwise. --from and --to cut REAL, --drop-nan holds for both.

    \b
    Example: harness compare simulated.csv measured.csv
             harness compare run/trace.rrd decay.csv \\
                 --sim-trace "mujoco tuned" --columns "t=t,x=pos[mm]"
    """
    for path in (sim, real):
        check_file(path)
    check_json(json_to)
    from harness.app.compare.compare import compare
    from harness.app.shared.reading import ReadOptions

    theirs = ReadOptions(columns, skip_rows, rate, start, stop, drop_nan)
    stored = [path.suffix.lower() == ".rrd" for path in (sim, real)]
    alike = stored[0] == stored[1]
    ours = (
        ReadOptions(sim_columns or columns, skip_rows, rate, drop_nan=drop_nan) if alike else ReadOptions(sim_columns)
    )
    taken = sim_trace or (trace if stored[0] else None)
    if no_shift and shift:
        raise InputError("--no-shift", f"given with --shift {shift:g}", "one of the two is accepted")
    shift = 0.0 if no_shift else shift
    if shift is not None and not math.isfinite(shift):
        raise InputError("--shift", f"{shift}", "a finite number of seconds is accepted")
    with shown(quiet) as progress:
        names = (taken, trace if stored[1] or not stored[0] else None)
        result = compare(sim, real, (ours, theirs), names, out, progress, this_line(), shift)
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
    return 0


def _print(result: "CompareResult") -> None:
    from rich.table import Table

    from harness.app.compare.compare import summary

    headline, rows = summary(result)
    say(headline)
    say(f"shift {with_error(result.aligned.shift_s)}")
    table = Table()
    for heading in ("", *result.traces, "difference / its error"):
        table.add_column(heading, justify="right" if heading else "left")
    for label, cells in rows:
        table.add_row(label, *cells)
    show(table)
    table = Table()
    for heading in ("channel", "fit / %", "rms difference", "noise"):
        table.add_column(heading, justify="left" if heading == "channel" else "right")
    for channel, rmse in result.rmse.items():
        noise = result.noise[channel]
        shown_noise = noise if isinstance(noise, str) else f"{noise:.4g}"
        table.add_row(channel, f"{result.fit_percent[channel]:.1f}", f"{rmse:.4g}", shown_noise)
    show(table)
    for where in result.where:
        if where.regime != "throughout":
            share = "" if where.share is None else f", {100.0 * where.share:.0f} % of the mismatch"
            say(f"- {where.regime}: {where.condition}{share}")
    read = {f"{Path(one.file).name}: {note}" for one in result.recordings for note in one.notes}
    for sentence in [*sorted(read), *result.sentences]:
        say(f"- {sentence}")
    say_as_it_is(f"report: {result.outputs['report']}")
