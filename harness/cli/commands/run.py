"""harness run."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import engine_options, output_options, robot_options
from harness.cli.output import check_json, emit_json, say, say_as_it_is, say_left_out, shows_tables, this_line
from harness.cli.progress import shown
from harness.cli.tables import show
from harness.core.bounded import check_file
from harness.core.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from harness.results.run import RunResult


@click.command(short_help="One slider in the exact reference, MuJoCo and PyBullet, with estimators and report.")
@click.argument("scenario", required=False)
@click.option("--m", type=float, metavar="KG", help="Mass.  [1]")
@click.option("--c", type=float, metavar="NS/M", help="Viscous damping.  [1]")
@click.option("--k", type=float, metavar="N/M", help="Stiffness.  [100]")
@click.option("--f-k", "f_k", type=float, metavar="N", help="Kinetic friction.  [3]")
@click.option("--f-s", "f_s", type=float, metavar="N", help="Break-away friction.  [that of --f-k]")
@click.option("--x0", type=float, metavar="M", help="Position at release.  [1]")
@click.option("--v0", type=float, metavar="M/S", help="Speed at release.  [0]")
@click.option("--restoring", metavar="spring|pendulum", help="What pulls it back; a pendulum turns, in rad.  [spring]")
@click.option("--duration", type=float, metavar="S", help="Length of the run.  [3, or until it rests]")
@click.option(
    "--model",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Run this model, model.json as harness diagnose writes it or an MJCF or URDF of one joint with --x0.",
)
@robot_options
@engine_options
@output_options
def command(
    scenario: str | None,
    model: Path | None,
    robot: Path | None,
    joint: str | None,
    gravity: tuple[float, float, float] | None,
    restoring: str | None,
    engines: tuple[str, ...],
    preset: str | None,
    dt: float | None,
    out: Path | None,
    json_to: str | None,
    quiet: bool,
    **given: float | None,
) -> int:
    """The main job: the exact reference, MuJoCo and PyBullet, each as shipped and tuned, on one scenario.

    Estimates friction and damping from every trace, and leaves result.json, trace.rrd, report.html and the models
    in the output folder. SCENARIO is free-decay, the paper's case unless parameters are given, or any other of the
    fidelity suite (hold-97, belt, harmonic, ...; an unknown name lists them), with the figures it is about.

    \b
    Example: harness run
             harness run belt
             harness run --engine mujoco --preset tuned --dt 5e-4
             harness run --model model.json
             harness run --model slider.xml --x0 0.05
             harness run --restoring pendulum --x0 1.2 --f-k 2
             harness run --robot arm.xml --joint elbow
             harness run --m 2.42 --k 2310 --c 4.79 --f-k 0.351 --x0 0.01 --json -
    """
    for path in (model, robot):
        if path is not None:
            check_file(path)
    check_json(json_to)
    if robot is not None:
        beside = {"SCENARIO": scenario, "--model": model, "--restoring": restoring, **given}
        return _joint(robot, joint, gravity, beside, engines, preset, dt, out, json_to, quiet)
    for option, value in (("--joint", joint), ("--gravity", gravity)):
        if value is not None:
            raise InputError(option, "given without --robot", "it is accepted with --robot FILE")
    from harness.app.run.run import RunOptions, run

    if restoring is not None:
        chosen = RunOptions.held(restoring, model, scenario, given, engines or None, preset, dt)
    elif model is None:
        chosen = RunOptions.named(scenario, given, engines or None, preset, dt)
    else:
        chosen = RunOptions.of_model(model, scenario, given, engines or None, preset, dt)
    with shown(quiet) as progress:
        result = run(chosen, out, progress, this_line())
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
        if not engines:
            say_left_out()
    return 1 if any(trace.error for trace in result.traces) else 0


def _joint(
    robot: Path,
    joint: str | None,
    gravity: tuple[float, float, float] | None,
    beside: "Mapping[str, object]",
    engines: tuple[str, ...],
    preset: str | None,
    dt: float | None,
    out: Path | None,
    json_to: str | None,
    quiet: bool,
) -> int:
    """A joint of a robot in place of a scenario."""
    for option, value in beside.items():
        if value is not None:
            named = option if option.isupper() or option.startswith("--") else f"--{option.replace('_', '-')}"
            raise InputError("--robot", f"given with {named}", "one of the two is accepted")
    from harness.app.run.joint import JointRun, run_joint

    asked = JointRun.chosen(robot, joint, gravity, engines, preset, dt)
    with shown(quiet) as progress:
        result = run_joint(asked, out, progress, this_line())
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        for sentence in result.conclusions:
            say(f"- {sentence}")
        say("to paste into your model (MJCF; URDF with PyBullet's calls):")
        for line in (result.paste.mjcf, *result.paste.urdf.splitlines()):
            say_as_it_is(f"  {line}")
        say_as_it_is(f"report: {result.files['report']}")
    return 1 if any(score.error for score in result.scores) else 0


def _print(result: "RunResult") -> None:
    from rich.table import Table

    from harness.app.run.table import summary

    about, heads, lines = summary(result)
    say(about)
    table = Table()
    for heading in heads:
        table.add_column(heading, justify="left" if heading == heads[0] else "right", no_wrap=True)
    for line in lines:
        table.add_row(*line)
    show(table)
    for sentence in result.conclusions:
        say(f"- {sentence}")
    say_as_it_is(f"report: {result.files['report']}")
