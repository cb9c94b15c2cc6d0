"""harness compare."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.options import PATH, output_options, reading_options, trace_option
from harness.cli.output import Output, say, say_all, say_as_it_is, show_rows, this_line, with_error
from harness.core.bounded import check_file
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.compare import CompareResult


@click.command(short_help="Two traces of any origin: where they differ, and how.")
@click.argument("sim", type=PATH)
@click.argument("real", type=PATH)
@reading_options
@trace_option
@click.option("--sim-columns", metavar="MAP", help="Columns of SIM, where they are not those of REAL.")
@click.option("--sim-trace", metavar="NAME", help="Which trace of SIM, where it is a .rrd of several.")
@click.option("--shift", type=float, metavar="S", help="Added to the times of SIM, s.  [found]")
@click.option("--no-shift", is_flag=True, help="The two are on one clock: as --shift 0.")
@output_options
def command(
    sim: Path,
    real: Path,
    reading: dict[str, Any],
    trace: str | None,
    sim_columns: str | None,
    sim_trace: str | None,
    shift: float | None,
    no_shift: bool,
    to: Output,
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
    from harness.app.compare import compare
    from harness.app.shared.reading import ReadOptions

    theirs = ReadOptions(**reading)
    stored = [path.suffix.lower() == ".rrd" for path in (sim, real)]
    ours = ReadOptions(sim_columns)
    if stored[0] == stored[1]:
        ours = ReadOptions(sim_columns or theirs.columns, theirs.skip_rows, theirs.rate, drop_nan=theirs.drop_nan)
    if no_shift and shift:
        raise InputError("--no-shift", f"given with --shift {shift:g}", "one of the two")
    shift = 0.0 if no_shift else shift
    if shift is not None and not math.isfinite(shift):
        raise InputError("--shift", f"{shift}", "a finite number of seconds")
    names = sim_trace or (trace if stored[0] else None), trace if stored[1] or not stored[0] else None
    with to.told() as progress:
        result = compare(sim, real, (ours, theirs), names, to.out, progress, this_line(), shift)
    to.give(result, _print)
    return 0


def _plain(text: str) -> str:
    """As a terminal has it everywhere."""
    return text.replace("\u00b1", "+-")


def _print(result: "CompareResult") -> None:
    from harness.app.compare import summary

    headline, rows = summary(result)
    say(_plain(headline))
    say(f"shift {with_error(result.aligned.shift_s)}")
    show_rows(("", *result.traces, "difference / its error"), [[label, *map(_plain, cells)] for label, cells in rows])
    turned = "rad" in result.largest.unit
    units = {"x": "rad", "v": "rad/s", "a": "rad/s^2"} if turned else {"x": "m", "v": "m/s", "a": "m/s^2"}
    said = {channel: noise if isinstance(noise, str) else f"{noise:.4g}" for channel, noise in result.noise.items()}
    show_rows(
        ("channel", "fit / %", "rms difference", "noise"),
        [
            [f"{c} / {units[c]}", f"{result.fit_percent[c]:.1f}", f"{rmse:.4g}", said[c]]
            for c, rmse in result.rmse.items()
        ],
    )
    for where in result.where:
        if where.regime != "throughout":
            share = "" if where.share is None else f", {100.0 * where.share:.0f} % of the mismatch"
            say(f"- {where.regime}: {where.condition}{share}")
    read = {f"{Path(one.file).name}: {note}" for one in result.recordings for note in one.notes}
    # what the headline has is said once
    more = [
        one
        for one in result.sentences
        if one.partition(" (")[0].removeprefix(f"{next(iter(result.traces))} ") not in headline
    ]
    say_all([*sorted(read), *(_plain(one) for one in more if not one.startswith("largest difference"))])
    say_as_it_is(f"report: {result.outputs['report']}")
