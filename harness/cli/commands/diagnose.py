"""harness diagnose."""

import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from harness.cli.diagnosis_tables import say_change, say_diagnosis, say_many
from harness.cli.options import (
    PATH,
    Joint,
    Several,
    calibration_option,
    engines_option,
    group,
    jobs_option,
    output_options,
    reading_options,
    refuse,
    robot_options,
    topic_option,
    trace_option,
)
from harness.cli.output import Output, say_left_out, this_line
from harness.core.bounded import check_file
from harness.core.errors import InputError

STANDARD_INPUT = "-"


@click.command(short_help="Which physics of a recording a simulation misses, and the model that has it.")
@click.argument("recordings", metavar="RECORDING...", nargs=-1, type=PATH)
@click.option("--model", type=PATH, metavar="FILE", help="Your simulation: model.json, MJCF or URDF.")
@click.option("--sim", type=PATH, metavar="TRACE", help="A trace of your own simulation.")
@group(
    "sim_reading",
    dict,
    click.option("--sim-columns", metavar="MAP", help="Columns of --sim, as --columns."),
    click.option("--sim-skip-rows", type=int, default=0, metavar="N", help="Lines before the header of --sim."),
    click.option("--sim-rate", type=float, metavar="HZ", help="Sampling rate of --sim without times."),
)
@click.option("--validate", type=PATH, metavar="RECORDING", help="Try both models on this one.")
@click.option("--horizon", type=float, metavar="S", help="Driven: windows, each its own start.  [whole, or 1]")
@click.option("--zero", metavar="spring|free", help="What x is measured from.  [chosen at the base fit]")
@click.option(
    "--covariate",
    "covariates",
    multiple=True,
    metavar="NAME[:KIND]",
    help="A column that acts: force, friction or damping; may repeat.  [KIND chosen at the base fit]",
)
@click.option(
    "--mass", "--inertia", "mass", type=float, metavar="KG", help="Mass, or kg m^2, where it is known: forces in N."
)
@click.option("--restoring", metavar="spring|pendulum|none", help="What pulls it back.  [chosen at the base fit]")
@robot_options
@group(
    "known",
    dict,
    click.option(
        "--gain",
        metavar="A[,B,...]",
        help="Of efforts in amperes or another unit: N m per A at the joint; one, one a joint, or NAME=A,..",
    ),
    click.option(
        "--names", metavar="MAP", help='Of the log\'s joints the model\'s: "a=b,..", "a_joint{i}=b_joint{i}", "*=*"'
    ),
    click.option(
        "--flip",
        metavar="NAME,..",
        help="Joints that turn the other way than in the model; with --together files that went the other way.",
    ),
    click.option("--offset", metavar="NAME=RAD,..", help="Added to positions: where the model's zero is another."),
    click.option("--angle-unit", metavar="UNIT", help="Of a robot's positions that say none, such as deg.  [rad]"),
    calibration_option,
    topic_option,
    click.option("--payload", type=float, metavar="KG", help="What the arm carried, where all of it moves."),
    click.option("--servo", metavar="NAME[:GAIN,..]", help="Whose goals and positions are logged: sts3215:16, xl330.."),
    click.option("--sensor", metavar="link|motor", help="Side of the gearbox on which torque is measured.  [motor]"),
)
@engines_option("mujoco, pybullet")
@click.option("--preset", metavar="as-shipped|tuned", help="Settings of the engines.  [tuned]")
@click.option("--dt", type=float, metavar="S", help="Step of the tuned preset, s.  [one that suits the recording]")
@click.option("--budget", type=float, metavar="S", help="Work of trying laws, s of a usual processor.  [120]")
@reading_options
@trace_option
@group(
    "conditions_of",
    dict,
    click.option(
        "--before",
        cls=Several,
        multiple=True,
        type=PATH,
        metavar="FILE...",
        help="Recordings of a machine in one condition; with --after.",
    ),
    click.option(
        "--after",
        cls=Several,
        multiple=True,
        type=PATH,
        metavar="FILE...",
        help="The same machine in another: says what changed, and what did not.",
    ),
)
@click.option("--together", is_flag=True, help="The recordings are of one machine: one set of physics.")
@click.option("--resume", is_flag=True, help="Go on with the files that --out does not hold yet.")
@jobs_option
@click.option(
    "--cluster", metavar="ADDRESS", help="A dask scheduler that sees the files, such as tcp://127.0.0.1:8786."
)
@click.option(
    "--conditions",
    type=PATH,
    metavar="FILE",
    help="Of logs of one robot, or of files --together: a CSV with a column file and numbers, such as temperature.",
)
@output_options
def command(
    recordings: tuple[Path, ...],
    reading: dict[str, Any],
    sim: Path | None,
    sim_reading: dict[str, Any],
    robot: Joint | None,
    known: dict[str, Any],
    engines: tuple[str, ...],
    conditions_of: dict[str, tuple[Path, ...]],
    together: bool,
    resume: bool,
    jobs: int | None,
    cluster: str | None,
    conditions: Path | None,
    to: Output,
    **chosen: Any,
) -> int:
    """Where a simulation and a RECORDING differ, which physics it misses, and the model that has it.

    Viscous and Coulomb friction are fitted first; what they leave is located, named from the catalogue (or said to be
    unknown, or to be nothing), fitted, and shown before and after in the reference and in the engines. "-" reads CSV
    from standard input. With several files each has a folder of its own, and one that fails does not stop the rest
    (exit code 1).

    \b
    Example: harness diagnose decay.csv
             harness diagnose rig/*.csv --jobs 4 --json results.json
             harness diagnose swing.txt --columns "x=#1[deg]" --rate 1000 \\
                 --restoring pendulum
             harness diagnose from-20-mm.csv from-60-mm.csv --together
             harness diagnose empty.csv loaded.csv --together --restoring none
             harness diagnose air-*.csv --together --conditions densities.csv
             harness diagnose north.csv south.csv --together --flip south.csv
             harness diagnose --before dry-1.csv dry-2.csv --after oiled-1.csv
             harness diagnose decay.csv --model slider.xml
             harness diagnose decay.csv --model mine.json \\
                 --engine mujoco --preset as-shipped
             harness diagnose log.csv --robot arm.urdf
             harness diagnose log.csv --robot arm.urdf --joint elbow
             harness diagnose log.csv --servo sts3215:16 \\
                 --robot so101.xml --joint elbow_flex
             harness diagnose day-*.mcap --robot arm.urdf \\
                 --conditions days.csv
    """
    before, after = conditions_of["before"], conditions_of["after"]
    _refuse_conditions(recordings, before, after)
    several = (len(recordings) > 1 or resume) and not together
    # of several recordings one that is not there is an entry among the answers; a log of joints may be a folder
    alone = recordings if len(recordings) == 1 and not resume and robot is None else ()
    if alone and alone[0].is_dir():
        from harness.app.diagnose.many import check_folder

        check_folder(alone[0])
        alone = ()
    for path in (*alone, *before, *after, sim, chosen["model"], chosen["validate"], conditions):
        if path is not None and str(path) != STANDARD_INPUT:
            check_file(path)
    if sim is None:
        given = sim_reading | {"sim_skip_rows": sim_reading["sim_skip_rows"] or None}
        refuse("given without --sim", "it goes with --sim TRACE", **given)
    from harness.app.diagnose.options import DiagnoseOptions, RobotOptions, ServoOptions
    from harness.app.shared.reading import ReadOptions

    file, joint, gravity = robot or (None, None, None)
    # without a robot it is of a servo's goals and positions: what else has angles says so in its columns
    servo = ServoOptions.chosen(known.pop("servo"), known.pop("angle_unit") if file is None else None)
    turned = (known.pop("flip") or "").split(",") if together and file is None else []
    options = DiagnoseOptions.chosen(
        ReadOptions(**reading),
        sim_reading=ReadOptions(
            sim_reading["sim_columns"],
            sim_reading["sim_skip_rows"],
            sim_reading["sim_rate"],
            drop_nan=reading["drop_nan"],
        ),
        engines=engines or None,
        sim=sim,
        servo=servo,
        robot=RobotOptions.chosen(file, joint=joint, gravity=gravity, join=robot and reading["join"], **known),
        **chosen,
    )
    if conditions is not None and together:
        from harness.app.diagnose.conditions import read_conditions

        options = replace(options, conditions=read_conditions(conditions))
    neither = conditions if not together and (robot is None or not several) else None
    refuse("given", "it goes with --together, and with several logs and --robot FILE", conditions=neither)
    refuse("given with several logs", "it goes with one", join=(several and reading["join"]) or None)
    _refuse_beside(cluster, several, together, resume, jobs, of_arm=file is not None and servo is None)
    if before:
        refuse("given with --before", "it goes without", together=together or None, resume=resume, jobs=jobs)
        from harness.app.diagnose.change import change

        with to.told() as progress:
            earlier, later = ([(path, str(path)) for path in group] for group in (before, after))
            changed = change(earlier, later, options, to.out, progress, this_line())
        to.give(changed, say_change)
        return 0
    from harness.app.diagnose import many as room

    with _named(recordings) as named, to.told() as progress:
        if several:
            many = room.diagnose_all(
                named, options, to.out, jobs, resume, progress, this_line(), cluster=cluster, conditions=conditions
            )
        elif together:
            one = room.diagnose_together(named, options, to.out, progress, this_line(), [*filter(None, turned)])
        else:
            one = room.diagnose(named[0][0], options, to.out, progress, this_line(), named[0][1])
    if several:
        to.give(many, say_many, room.Many.json)
    else:
        to.give(one, say_diagnosis)
    if to.tables and not engines:
        say_left_out()
    return 1 if several and many.failed else 0


def _refuse_beside(
    cluster: str | None, several: bool, together: bool, resume: bool, jobs: int | None, *, of_arm: bool
) -> None:
    """Raise InputError for what is of several that are diagnosed each, and of processes here."""
    if cluster is not None and not several:
        raise InputError(f"--cluster {cluster}", "given with one diagnosis", "it goes with several recordings")
    if cluster is not None:
        refuse("given with --cluster", "one of the two", jobs=jobs)
    if together and of_arm:
        accepted = "it goes with recordings of one motion; logs of a robot are diagnosed one by one and compared"
        raise InputError("--together", "given with --robot", accepted)
    if together:
        accepted = "it goes with several that are diagnosed one by one"
        refuse("given with --together", accepted, resume=resume, jobs=jobs)


def _refuse_conditions(recordings: tuple[Path, ...], before: tuple[Path, ...], after: tuple[Path, ...]) -> None:
    """Raise InputError for conditions that lack one another, or stand beside recordings; for nothing at all."""
    for name, given, other in (("--before", before, after), ("--after", after, before)):
        if given and not other:
            wanted = "--after" if name == "--before" else "--before"
            alone = shlex.join(["harness", "diagnose", *map(str, given)])
            raise InputError(name, f"given without {wanted} FILE", f"try: {alone}")
    if before and recordings:
        accepted = "every recording behind one of the two"
        raise InputError(str(recordings[0]), "neither before nor after", accepted)
    if not before and not recordings:
        raise click.UsageError("Missing argument 'RECORDING...'.")


@contextmanager
def _named(recordings: tuple[Path, ...]) -> Iterator[list[tuple[Path, str]]]:
    """Path and label of each recording; standard input is put into a file for the while."""
    from harness.app.shared.reading import spooled

    if sum(str(path) == STANDARD_INPUT for path in recordings) > 1:
        raise InputError("recording", "- given twice", "each input once: standard input cannot be read again")
    if Path(STANDARD_INPUT) not in recordings:
        yield [(path, str(path)) for path in recordings]
        return
    if sys.stdin is None or sys.stdin.isatty():
        raise InputError("-", "standard input is a terminal or closed", "CSV on a pipe")
    with spooled(sys.stdin.buffer) as file:
        yield [(file if str(path) == STANDARD_INPUT else path, str(path)) for path in recordings]
