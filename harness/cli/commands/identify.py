"""harness identify."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.diagnosis_tables import say_motion, show_repeated
from harness.cli.options import PATH, output_options, reading_options, refuse, trace_option
from harness.cli.output import Output, say, say_all, say_as_it_is, show_rows, this_line, with_error
from harness.core.bounded import check_file

if TYPE_CHECKING:
    from harness.results.common import Swing
    from harness.results.identify import IdentifyResult, RepeatedIdentifyResult
    from harness.results.run import Estimates


@click.command(short_help="Natural frequency, damping and friction from a recorded free decay.")
@click.argument("recordings", metavar="RECORDING...", nargs=-1, required=True, type=PATH)
@click.option(
    "--conditions",
    type=PATH,
    metavar="FILE",
    help="Of several: a CSV with a column file and numbers, such as temperature; trends over them are told.",
)
@click.option("--restoring", type=click.Choice(["spring", "pendulum"]), default="spring", help="What pulls it back.")
@reading_options
@trace_option
@output_options
def command(
    recordings: tuple[Path, ...],
    conditions: Path | None,
    restoring: "Swing",
    reading: dict[str, Any],
    trace: str | None,
    to: Output,
) -> int:
    """The estimators on a RECORDING of a free decay: omega_n, zeta and x_k, with standard errors.

    Several are of one machine: each is read by itself, then what all say, by how much they differ beyond their errors,
    and which stands out. One that cannot be used does not stop the rest (exit code 1).

    Formats: CSV and text of a dozen programs (also .gz, .zip), Parquet, MATLAB .mat, HDF5, .npz, JSON, .labx, .cmbl,
    .gambl, .wpilog, .uff, Excel and .tdms (extra files), .rrd of ours. Time and one or more of position, speed,
    acceleration, by names, units and numbers, or --columns; headers may carry units, as in "x [mm]". A driven
    recording is refused.

    \b
    Example: harness identify decay.csv
             harness identify swing.txt --columns "x=#1[deg]" --skip-rows 2 \\
                 --rate 1000 --from 0.4
             harness identify pendulum.csv --columns "t=t,x=enc[deg]" \\
                 --restoring pendulum
             harness identify rig.mat \\
                 --columns "t=time[ms],x=enc*0.004[mm],a=acc[g]" --json -
             harness identify run-1.csv run-2.csv run-3.csv
             harness identify day-*.csv --conditions days.csv
    """
    first, *more = recordings
    for path in (conditions, *(() if more else (first,))):
        if path is not None:
            check_file(path)
    if not more:
        refuse("given with one recording", "it goes with several", conditions=conditions)
    from harness.app.shared.reading import ReadOptions

    options = ReadOptions(**reading, angle=restoring == "pendulum")
    if more:
        refuse("given with several recordings", "it goes with one", join=reading["join"] or None)
        from harness.app.diagnose.conditions import read_conditions
        from harness.app.identify_together import identify_together

        with to.told() as progress:
            known = {} if conditions is None else read_conditions(conditions)
            several = identify_together(recordings, options, trace, to.out, progress, this_line(), restoring, known)
        to.give(several, _print_several)
        return 1 if several.failed else 0
    from harness.app.identify import identify

    with to.told() as progress:
        result = identify(first, options, trace, to.out, progress, this_line(), restoring)
    to.give(result, _print)
    return 0


def _print_several(result: "RepeatedIdentifyResult") -> None:
    say(result.statement)
    if result.estimates:
        _methods(result.estimates)
    # its trends are among the warnings
    of_method = {name: one for name, one in result.together.items() if name.startswith(f"{result.method}.")}
    show_repeated({name: one.model_copy(update={"trends": []}) for name, one in of_method.items()})
    say_all(result.warnings)
    say(f"{len(result.recordings)} recordings, {len(result.failed)} failed")
    say_as_it_is(f"report: {result.files['report']}")


def _methods(estimates: "Mapping[str, Estimates]") -> list[str]:
    """A row a method; returns why numbers are missing."""
    refused, rows = [], []
    for method, estimate in estimates.items():
        numbers = (estimate.omega_n, estimate.zeta, estimate.x_k)
        if all(number.value is None for number in numbers):
            refused.append(f"not used: {method}: {next(number.why for number in numbers)}")
            continue
        rows.append([method, *(with_error(number, "rad/s") for number in numbers), str(estimate.reversals)])
        reasons = dict.fromkeys(number.why for number in numbers if number.value is None and number.why)
        refused += [f"{method}: {reason}" for reason in reasons]
    show_rows(("method", "omega_n rad/s", "zeta", "x_k", "reversals"), rows)
    return refused


def _print(result: "IdentifyResult") -> None:
    found = result.recording
    channels = f"{found.samples} samples of {', '.join(found.channels)} at {found.rate_hz:.4g} Hz"
    say(f"{found.file}: {channels if found.speeds is None else f'{found.samples} steady speeds from {found.speeds}'}")
    say_motion(result.motion)
    refused = [] if result.slowing else _methods(result.estimates)
    if result.slowing:
        # a unit stands in the heading: "N m s/rad per kg m^2" in every cell is wider than a terminal
        first = next(iter(result.slowing.values()))
        both = [(method, with_error(one.f_k, one.f_k.unit), with_error(one.c, one.c.unit), f"{one.chi2_per_point:.3g}")
                for method, one in result.slowing.items()]  # fmt: skip
        show_rows(("method", f"f_k\n{first.f_k.unit}", f"c\n{first.c.unit}", "chi2\na point"), both)
    if result.sensor_phase_rad.value is not None:
        say(f"the accelerometer leads the displacement sensor by {with_error(result.sensor_phase_rad)}")
    if result.baseline is not None:
        chi2 = result.baseline.chi2_per_point
        say(f"viscous and Coulomb friction fitted to all channels: chi2 {chi2:.3g} a point (1 is the noise)")
    # what a note says in full is said once
    more = [one for one in result.warnings if not any(note.lower().startswith(one.lower()) for note in found.notes)]
    say_all([*more, *found.notes, *refused])
    say_as_it_is(f"report: {result.files['report']}")
