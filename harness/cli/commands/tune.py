"""harness tune."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import json_option, quiet_option, robot_options
from harness.cli.output import check_json, emit_json, say, say_as_it_is, shows_tables
from harness.cli.progress import shown
from harness.cli.tables import show
from harness.core.bounded import check_file
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.sweep import TuneResult


@click.command(short_help="Search an engine's settings for fidelity at a cost; prints what to paste.")
@click.argument("engine")
@click.option("--dt", type=float, metavar="S", help="Step, s.  [1e-3, or the robot's own]")
@click.option("--route", metavar="joint|contact|law", help="Where dry friction lives.  [joint]")
@click.option("--max-cost", type=float, metavar="R", help="Wall time over that of what ships.  [any]")
@robot_options
@json_option
@quiet_option
def command(
    engine: str,
    dt: float | None,
    route: str | None,
    max_cost: float | None,
    robot: Path | None,
    joint: str | None,
    gravity: tuple[float, float, float] | None,
    json_to: str | None,
    quiet: bool,
) -> int:
    """Search an engine's settings on some random sliders, score them on others, print the XML or the calls to paste.

    With --robot on a joint of it, the others in some poses, as the model's file has it and at its own step. ENGINE is
    mujoco, pybullet, dart, rapier, drake or physx, as far as it is installed.

    \b
    Example: harness tune mujoco --dt 0.002
             harness tune mujoco --dt 0.002 --max-cost 1.5
             harness tune pybullet --route contact --dt 0.004 --json tuned.json
             harness tune mujoco --robot arm.xml --joint elbow
    """
    check_json(json_to)
    with shown(quiet) as progress:
        if robot is None:
            for option, value in (("--joint", joint), ("--gravity", gravity)):
                if value is not None:
                    raise InputError(option, "given without --robot", "it is accepted with --robot FILE")
            from harness.app.sweep.tune import tune

            result = tune(engine, route or "joint", dt, max_cost, progress)  # type: ignore[arg-type]
        else:
            if route not in (None, "joint"):
                raise InputError("--route", f"{route}, given with --robot", "joint is accepted with it")
            check_file(robot)
            from harness.app.sweep.tune import TuneJoint, tune_joint

            result = tune_joint(engine, TuneJoint(robot, joint, gravity, dt), max_cost, progress)
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
    return 0


def _print(result: "TuneResult") -> None:
    from rich.table import Table

    what = result.route if result.robot is None else result.robot.joint
    say(f"{result.engine} {result.version}, {what}, step {result.dt_s * 1e3:g} ms: distance from exact")
    table = Table()
    before = "as shipped" if result.robot is None else "as the file has it"
    for heading in ("figure", before, "found"):
        table.add_column(heading, justify="left" if heading == "figure" else "right")
    for figure in result.figures:
        table.add_row(figure.name, _percent(figure.before), _percent(figure.after))
    show(table)
    say_as_it_is(result.paste)
    where = "on sliders not searched on" if result.robot is None else "in poses not searched in"
    say(
        f"score {where}: {result.score_before:.3g} {before}, {result.score_after:.3g} found,"
        f" {result.score_preset:.3g} with the preset tuned; it costs {result.cost:.2f} times what ships"
        f" ({result.searched} settings scored)"
    )


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{100.0 * value:.3g} %"
