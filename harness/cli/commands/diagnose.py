"""harness diagnose."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from harness.cli.diagnosis_tables import say_diagnosis, say_many
from harness.cli.options import engines_option, jobs_option, output_options, reading_options, robot_options
from harness.cli.output import (
    STANDARD_OUTPUT,
    check_json,
    emit_json,
    say_left_out,
    shows_tables,
    this_line,
)
from harness.cli.progress import shown
from harness.core.bounded import check_file
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.app.diagnose.options import DiagnoseOptions

STANDARD_INPUT = "-"


@click.command(short_help="Which physics a simulation leaves out of a recording, and the model that has it.")
@click.argument("recordings", metavar="RECORDING...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "--model", type=click.Path(path_type=Path), metavar="FILE", help="Your simulation: model.json, MJCF or URDF."
)
@click.option("--sim", type=click.Path(path_type=Path), metavar="TRACE", help="A trace of your own simulation.")
@click.option("--sim-columns", metavar="MAP", help="Columns of --sim, as --columns.")
@click.option("--sim-skip-rows", type=int, default=0, metavar="N", help="Lines before the header of --sim.")
@click.option("--sim-rate", type=float, metavar="HZ", help="Sampling rate of --sim without times.")
@click.option("--validate", type=click.Path(path_type=Path), metavar="RECORDING", help="Try both models on this one.")
@click.option("--horizon", type=float, metavar="S", help="Driven: windows, each its own start.  [whole, or 1]")
@click.option("--zero", metavar="spring|free", help="What x is measured from.  [chosen at the base fit]")
@click.option(
    "--covariate",
    "covariates",
    multiple=True,
    metavar="NAME[:KIND]",
    help="A column that acts: force, friction or damping; may repeat.  [KIND chosen at the base fit]",
)
@click.option("--mass", type=float, metavar="KG", help="Mass, where it is known: forces in N.")
@click.option("--restoring", metavar="spring|pendulum|none", help="What pulls it back.  [chosen at the base fit]")
@robot_options
@click.option(
    "--gain",
    metavar="A[,B,...]",
    help="Of efforts in amperes or another unit: N m per A at the joint; one, one a joint, or NAME=A,..",
)
@click.option("--names", metavar="MAP", help="The model's names of the log's joints: \"shoulder_link=joint1,..\"")
@click.option("--flip", metavar="NAME,..", help="Joints that turn the other way than in the model.")
@click.option("--offset", metavar="NAME=RAD,..", help="Added to positions: where the model's zero is another.")
@click.option("--angle-unit", metavar="UNIT", help="Of a robot's positions that say none, such as deg.  [rad]")
@click.option("--payload", type=float, metavar="KG", help="What the arm carried, where all of it moves.")
@click.option("--sensor", metavar="link|motor", help="Side of the gearbox on which torque is measured.  [motor]")
@engines_option("mujoco, pybullet")
@click.option("--preset", metavar="as-shipped|tuned", help="Settings of the engines.  [tuned]")
@click.option("--dt", type=float, metavar="S", help="Step of the tuned preset, s.  [one that suits the recording]")
@click.option("--budget", type=float, metavar="S", help="Work of trying laws, s of a usual processor.  [120]")
@reading_options
@click.option("--together", is_flag=True, help="The recordings are of one machine: one set of physics.")
@click.option("--resume", is_flag=True, help="Go on with the files that --out does not hold yet.")
@jobs_option
@click.option(
    "--cluster", metavar="ADDRESS", help="A dask scheduler that sees the files, such as tcp://127.0.0.1:8786."
)
@click.option(
    "--conditions",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Of logs of one robot: a CSV with a column file and numbers, such as temperature.",
)
@output_options
def command(
    recordings: tuple[Path, ...],
    columns: str | None,
    skip_rows: int,
    rate: float | None,
    start: float | None,
    stop: float | None,
    drop_nan: bool,
    together: bool,
    resume: bool,
    jobs: int | None,
    cluster: str | None,
    conditions: Path | None,
    out: Path | None,
    json_to: str | None,
    quiet: bool,
    engines: tuple[str, ...],
    sim: Path | None,
    sim_columns: str | None,
    sim_skip_rows: int,
    sim_rate: float | None,
    robot: Path | None,
    joint: str | None,
    gravity: tuple[float, float, float] | None,
    gain: str | None,
    names: str | None,
    flip: str | None,
    offset: str | None,
    angle_unit: str | None,
    payload: float | None,
    sensor: str | None,
    **chosen: Any,
) -> int:
    """Where a simulation and a RECORDING differ, which physics was left out, and the model that has it.

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
             harness diagnose decay.csv --model slider.xml
             harness diagnose decay.csv --model mine.json \\
                 --engine mujoco --preset as-shipped
             harness diagnose log.csv --robot arm.urdf --joint elbow
             harness diagnose day-*.mcap --robot arm.urdf \\
                 --conditions days.csv
    """
    # a log of joints may be a folder
    _check_files(recordings, (sim, chosen["model"], chosen["validate"], robot, conditions), resume or robot is not None)
    check_json(json_to)
    from harness.app.diagnose.options import DiagnoseOptions
    from harness.app.diagnose.robot_options import RobotOptions, names_by_name, numbers, numbers_by_joint
    from harness.app.shared.reading import ReadOptions

    for option, value in (("columns", sim_columns), ("skip-rows", sim_skip_rows or None), ("rate", sim_rate)):
        if value is not None and sim is None:
            raise InputError(f"--sim-{option}", "given without --sim", "it is accepted with --sim TRACE")
    options = DiagnoseOptions.chosen(
        ReadOptions(columns, skip_rows, rate, start, stop, drop_nan),
        sim_reading=ReadOptions(sim_columns, sim_skip_rows, sim_rate, drop_nan=drop_nan),
        engines=engines or None,
        sim=sim,
        robot=RobotOptions.chosen(
            robot,
            joint=joint,
            gain=numbers("--gain", gain),
            gravity=gravity,
            payload=payload,
            sensor=sensor,
            names=names_by_name("--names", names),
            flip=tuple(name.strip() for name in flip.split(",")) if flip else (),
            offset=numbers_by_joint("--offset", offset),
            angle_unit=angle_unit,
        ),
        **chosen,
    )
    several = (len(recordings) > 1 or resume) and not together
    if conditions is not None and (robot is None or not several):
        raise InputError("--conditions", "given", "it is accepted with several logs and --robot FILE")
    if options.robot is not None and several:
        options = replace(options, robot=replace(options.robot, any_joint=joint is None))
    if cluster is not None:
        _check_cluster(cluster, several, jobs)
    with _named(recordings) as named:
        if together:
            _refuse_beside_together(resume, jobs)
            code = _together(named, options, out, json_to, quiet)
        elif len(named) > 1 or resume:
            code = _many(named, options, out, jobs, resume, json_to, quiet, cluster, conditions)
        else:
            code = _one(named[0], options, out, json_to, quiet)
    if shows_tables(json_to, quiet) and not engines:
        say_left_out()
    return code


def _check_files(recordings: tuple[Path, ...], others: tuple[Path | None, ...], later: bool) -> None:
    """Refuse files that are not there; of several recordings one that is not is an entry among the answers.

    later : recordings are looked at where they are read.
    """
    alone = recordings if len(recordings) == 1 and not later else ()
    for path in (*alone, *others):
        if path is not None and str(path) != STANDARD_INPUT:
            check_file(path)


@contextmanager
def _named(recordings: tuple[Path, ...]) -> Iterator[list[tuple[Path, str]]]:
    """Path and label of each recording; standard input is put into a file for the while."""
    from harness.app.shared.reading import spooled

    if sum(str(path) == STANDARD_INPUT for path in recordings) > 1:
        raise InputError("recording", "- given twice", "standard input can be read once")
    if Path(STANDARD_INPUT) not in recordings:
        yield [(path, str(path)) for path in recordings]
        return
    if sys.stdin is None or sys.stdin.isatty():
        raise InputError("-", "standard input is a terminal or closed", "CSV on a pipe is accepted")
    with spooled(sys.stdin.buffer) as file:
        yield [(file if str(path) == STANDARD_INPUT else path, str(path)) for path in recordings]


def _one(
    named: tuple[Path, str], options: "DiagnoseOptions", out: Path | None, json_to: str | None, quiet: bool
) -> int:
    from harness.app.diagnose.many import diagnose

    with shown(quiet) as progress:
        result = diagnose(named[0], options, out, progress, this_line(), named[1])
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        say_diagnosis(result)
    return 0


def _refuse_beside_together(resume: bool, jobs: int | None) -> None:
    for option, given in (("--resume", resume), ("--jobs", jobs is not None)):
        if given:
            raise InputError(option, "given with --together", "it is accepted with several that are diagnosed each")


def _check_cluster(cluster: str, several: bool, jobs: int | None) -> None:
    if not several:
        raise InputError(f"--cluster {cluster}", "given with one diagnosis", "it is accepted with several recordings")
    if jobs is not None:
        raise InputError("--jobs", "given with --cluster", "one of the two is accepted")


def _together(
    named: list[tuple[Path, str]], options: "DiagnoseOptions", out: Path | None, json_to: str | None, quiet: bool
) -> int:
    from harness.app.diagnose.together import diagnose_together

    with shown(quiet) as progress:
        result = diagnose_together(named, options, out, progress, this_line())
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        say_diagnosis(result)
    return 0


def _many(
    named: list[tuple[Path, str]],
    options: "DiagnoseOptions",
    out: Path | None,
    jobs: int | None,
    resume: bool,
    json_to: str | None,
    quiet: bool,
    cluster: str | None,
    conditions: Path | None,
) -> int:
    from harness.app.diagnose.fleet import read_conditions
    from harness.app.diagnose.many import diagnose_all
    from harness.app.shared.deliver import write_json_text

    known = None if conditions is None else read_conditions(conditions)
    with shown(quiet) as progress:
        many = diagnose_all(named, options, out, jobs, resume, progress, this_line(), cluster=cluster, conditions=known)
    if json_to == STANDARD_OUTPUT:
        sys.stdout.write(many.json())
        sys.stdout.flush()
    elif json_to is not None:
        write_json_text(many.json(), Path(json_to))
    if shows_tables(json_to, quiet):
        say_many(many)
    return 1 if many.failed else 0
