"""harness diagnose."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from harness.cli.options import engines_option, jobs_option, output_options, reading_options, robot_options
from harness.cli.output import (
    STANDARD_OUTPUT,
    check_json,
    emit_json,
    say,
    say_as_it_is,
    say_left_out,
    shows_tables,
    this_line,
    with_error,
)
from harness.cli.progress import shown
from harness.cli.tables import show
from harness.core.bounded import check_file
from harness.core.errors import InputError

if TYPE_CHECKING:
    from rich.table import Table

    from harness.app.diagnose.many import Many
    from harness.app.diagnose.options import DiagnoseOptions
    from harness.results.diagnosis import (
        AttributionResult,
        DiagnosisResult,
        FitResult,
        MechanismResult,
        PredictionResult,
    )
    from harness.results.robot import RobotResult

STANDARD_INPUT = "-"


@click.command(short_help="Which physics a simulation leaves out of a recording, and the model that has it.")
@click.argument("recordings", metavar="RECORDING...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--model", type=click.Path(path_type=Path), metavar="FILE", help="model.json of the simulation you have.")
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
@click.option("--gain", type=float, metavar="NM_PER_A", help="Of efforts in amperes: N m per A at the joint.")
@click.option("--payload", type=float, metavar="KG", help="What the arm carried, where all of it moves.")
@click.option("--sensor", metavar="link|motor", help="Side of the gearbox on which torque is measured.  [motor]")
@engines_option("mujoco, pybullet")
@click.option("--preset", metavar="as-shipped|tuned", help="Settings of the engines.  [tuned]")
@click.option("--dt", type=float, metavar="S", help="Step of the tuned preset, s.  [one that suits the recording]")
@reading_options
@click.option("--together", is_flag=True, help="The recordings are of one machine: one set of physics.")
@click.option("--resume", is_flag=True, help="Go on with the files that --out does not hold yet.")
@jobs_option
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
    gain: float | None,
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
             harness diagnose decay.csv --model mine.json \\
                 --engine mujoco --preset as-shipped
             harness diagnose log.csv --robot arm.urdf --joint elbow
    """
    # a log of joints may be a folder
    _check_files(recordings, (sim, chosen["model"], chosen["validate"], robot), resume or robot is not None)
    check_json(json_to)
    from harness.app.diagnose.options import DiagnoseOptions
    from harness.app.diagnose.robot_options import RobotOptions
    from harness.app.shared.reading import ReadOptions

    for option, value in (("columns", sim_columns), ("skip-rows", sim_skip_rows or None), ("rate", sim_rate)):
        if value is not None and sim is None:
            raise InputError(f"--sim-{option}", "given without --sim", "it is accepted with --sim TRACE")
    options = DiagnoseOptions.chosen(
        ReadOptions(columns, skip_rows, rate, start, stop, drop_nan),
        sim_reading=ReadOptions(sim_columns, sim_skip_rows, sim_rate, drop_nan=drop_nan),
        engines=engines or None,
        sim=sim,
        robot=RobotOptions.chosen(robot, joint=joint, gain=gain, gravity=gravity, payload=payload, sensor=sensor),
        **chosen,
    )
    with _named(recordings) as named:
        if together:
            _refuse_beside_together(resume, jobs)
            code = _together(named, options, out, json_to, quiet)
        elif len(named) > 1 or resume:
            code = _many(named, options, out, jobs, resume, json_to, quiet)
        elif jobs is not None:
            raise InputError("--jobs", "given with one recording", "it is accepted with several")
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
    from harness.app.diagnose.one import diagnose

    with shown(quiet) as progress:
        result = diagnose(named[0], options, out, progress, this_line(), named[1])
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
    return 0


def _refuse_beside_together(resume: bool, jobs: int | None) -> None:
    for option, given in (("--resume", resume), ("--jobs", jobs is not None)):
        if given:
            raise InputError(option, "given with --together", "it is accepted with several that are diagnosed each")


def _together(
    named: list[tuple[Path, str]], options: "DiagnoseOptions", out: Path | None, json_to: str | None, quiet: bool
) -> int:
    from harness.app.diagnose.together import diagnose_together

    with shown(quiet) as progress:
        result = diagnose_together(named, options, out, progress, this_line())
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
    return 0


def _many(
    named: list[tuple[Path, str]],
    options: "DiagnoseOptions",
    out: Path | None,
    jobs: int | None,
    resume: bool,
    json_to: str | None,
    quiet: bool,
) -> int:
    from harness.app.diagnose.many import diagnose_all
    from harness.app.shared.deliver import write_json_text

    with shown(quiet) as progress:
        many = diagnose_all(named, options, out, jobs, resume, progress, this_line())
    if json_to == STANDARD_OUTPUT:
        sys.stdout.write(many.json())
        sys.stdout.flush()
    elif json_to is not None:
        write_json_text(many.json(), Path(json_to))
    if shows_tables(json_to, quiet):
        _print_many(many)
    return 1 if many.failed else 0


def _print(result: "DiagnosisResult") -> None:
    for line in result.recording.notes:
        say(f"- {line}")
    say(result.statement)
    show(_fits(result))
    if result.own:
        show(_own(result))
        for one in result.own:
            for line in one.differs:
                say(f"- {Path(one.file).name}: {line}")
    graded = [m for m in result.mechanisms if m.grade != "explains"]
    if graded:
        show(_grades(graded))
        say("of misfit: share of the mean square beyond noise that it takes off alone")
        say("held out: error after over before, blocks of cycles; free run: the last 40 %")
    if result.holdout.given:
        say(f"- held out: {_held_out(result)}; {', '.join(result.holdout.given)} given, not predicted")
    for mechanism in result.mechanisms:
        if mechanism.grade == "explains":
            say(f"- {mechanism.name}: BIC {mechanism.delta_bic:.0f} in favour")
        if mechanism.alternatives:
            others = ", ".join(f"{a.name} (by {a.delta_bic:.1f})" for a in mechanism.alternatives)
            say(f"- not ruled out in place of {mechanism.name}: {others}")
    if result.robot is not None:
        _print_robot(result.robot)
    if result.attribution is not None and (result.settings.get("sim") or result.settings.get("model")):
        _print_shares(result.attribution)
    for line in [*([result.next_experiment] if result.next_experiment else []), *result.warnings]:
        say(f"- {line}")
    say_as_it_is(f"report: {result.files['report']}")


def _print_robot(found: "RobotResult") -> None:
    """The joint's own equation, and what to paste."""
    if found.reduction is not None:
        say(f"- {found.reduction.said}")
    if found.confounded:
        say(f"- this log cannot tell apart: {'; '.join(' and '.join(pair) for pair in found.confounded)}")
    say("to paste into your model (MJCF; URDF with PyBullet's calls):")
    for line in (found.paste.mjcf, *found.paste.urdf.splitlines()):
        say_as_it_is(f"  {line}")


def _held_out(result: "DiagnosisResult") -> str:
    """Errors on what took no part in the fits, before and after."""
    held = result.holdout
    both = (f"rmse {c} {y:.4g} to {held.refined_rmse[c]:.4g}" for c, y in held.baseline_rmse.items())
    return ", ".join(both) or "no figure"


def _print_shares(found: "AttributionResult") -> None:
    """Whose mismatch it is, what the simulation reads beside the recording, and what to change in it."""
    from rich.table import Table

    say("whose mismatch it is, % of the mean square:")
    table = Table()
    shares = {
        "parameters and engine" if found.why else "parameters": found.parameters,
        **({} if found.why else {"engine": found.engine}),
        "missing physics": found.missing_physics,
        "unexplained": found.unexplained,
        "noise": found.noise,
    }
    for heading in shares:
        table.add_column(heading, justify="right")
    table.add_row(*(f"{100.0 * share:.1f}" for share in shares.values()))
    show(table)
    if found.reads is not None:
        table = Table()
        for heading in ("", "your trace reads", "the recording reads"):
            table.add_column(heading, justify="right" if heading else "left", no_wrap=True)
        for name, own in found.reads.items():
            if name in found.recording:
                table.add_row(name, with_error(own), with_error(found.recording[name]))
        show(table)
    for sentence in found.sentences:
        say(f"- {sentence}")
    if found.changes:
        say("to change in your simulation:")
        for change in found.changes:
            say(f"- {change.said}")


def _fits(result: "DiagnosisResult") -> "Table":
    """Both models side by side: a column each, so that a terminal of 80 columns holds every digit."""
    from rich.table import Table

    fits = [result.baseline, *([result.refined] if result.mechanisms else [])]
    table = Table()
    table.add_column("", no_wrap=True)
    for heading in ("viscous and Coulomb", "refined")[: len(fits)]:
        table.add_column(heading, justify="right", no_wrap=True)
    if result.mechanisms:
        # several that explain are in one model together; of several that are graded the best alone, or a table
        added = dict.fromkeys(term.name for term in result.refined_model.terms)
        table.add_row("term", "-", "\n".join(added) or "-")
    table.add_row("chi2 a point", *(_chi2(fit) for fit in fits))
    if result.fit_percent is not None:
        sides = [result.fit_percent.baseline, result.fit_percent.refined]
        for c in result.fit_percent.baseline:
            table.add_row(f"fit of {c}", *(f"{side[c]:.4g} %" for side in sides[: len(fits)]))
    for c in result.baseline.rmse:
        table.add_row(f"rmse {c}", *(f"{fit.rmse[c]:.4g}" for fit in fits))
    for name in dict.fromkeys(name for fit in fits for name in fit.parameters):
        table.add_row(name, *(with_error(f.parameters[name]) if name in f.parameters else "-" for f in fits))
    return table


def _own(result: "DiagnosisResult") -> "Table":
    """A line a recording: where it starts, its zero, and what both models leave of it."""
    from rich.table import Table

    table = Table()
    channel = next(iter(result.baseline.rmse))
    columns = ["recording", "x0", *(["zero"] if result.own[0].zero else []), f"noise {channel}"]
    for heading in (*columns, f"rmse {channel}", *(["refined"] if result.mechanisms else [])):
        table.add_column(heading, justify="left" if heading == "recording" else "right", no_wrap=heading != "recording")
    for one in result.own:
        noise = one.noise[channel]
        cells = [Path(one.file).name, f"{one.start['x0'].value:.4g} {one.start['x0'].unit}"]
        cells += [f"{one.zero.value:.4g}"] if one.zero else []
        cells += [noise if isinstance(noise, str) else f"{noise:.3g}", f"{one.baseline_rmse[channel]:.3g}"]
        table.add_row(*cells, *([f"{one.rmse[channel]:.3g}"] if result.mechanisms else []))
    return table


def _grades(mechanisms: list["MechanismResult"]) -> "Table":
    """A line a mechanism: how much of what is missing it is, and how it predicts."""
    from rich.table import Table

    table = Table()
    for heading in ("mechanism", "grade", "of misfit", "held out", "free run"):
        justify: Literal["left", "right"] = "left" if heading in ("mechanism", "grade") else "right"
        table.add_column(heading, justify=justify, no_wrap=True)
    for m in mechanisms:
        share = "-" if m.share is None else f"{100.0 * m.share:.0f} %"
        table.add_row(m.name, m.grade, share, _ratio(m.holdout), _ratio(m.forward))
    return table


def _ratio(found: "PredictionResult | None") -> str:
    """Error after over before, of the channel where it is largest."""
    if found is None:
        return "-"
    ratios = [found.refined_rmse[c] / before for c, before in found.baseline_rmse.items() if before > 0.0]
    return f"x {max(ratios):.2g}" if ratios else "-"


def _chi2(fit: "FitResult") -> str:
    return "-" if fit.chi2_per_point is None else f"{fit.chi2_per_point:.4g}"


def _print_many(many: "Many") -> None:
    from rich.table import Table

    from harness.results.diagnosis import FailedDiagnosis

    table = Table()
    for heading in ("recording", "verdict", "left out", "chi2 a point before", "after"):
        table.add_column(heading, justify="right" if "chi2" in heading or heading == "after" else "left")
    for answer in many.answers:
        name = Path(answer.recording.file).name
        if isinstance(answer, FailedDiagnosis):
            table.add_row(name, "error", answer.error, "", "")
            continue
        left_out = ", ".join(m.name for m in answer.mechanisms) or "-"
        table.add_row(name, answer.verdict, left_out, _chi2(answer.baseline), _chi2(answer.refined))
    show(table)
    say(f"{len(many.answers)} recordings, {many.failed} failed")
    say_as_it_is(f"report: {many.folder / 'index.html'}")
