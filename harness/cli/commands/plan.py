"""harness plan."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import PATH, output_options
from harness.cli.output import Output, say, say_all, say_as_it_is, show_rows, this_line
from harness.core.bounded import MODELS, check_file

if TYPE_CHECKING:
    from harness.results.plan import PlanResult


@click.command(short_help="A motion within a robot's limits that tells the friction of its joints.")
@click.option("--robot", type=PATH, required=True, metavar="FILE", help="A robot's model, MJCF, URDF or SDF.")
@click.option("--joints", metavar="NAME,..", help="Those that move.  [all]")
@click.option("--seconds", type=float, default=20.0, metavar="S", help="How long.  [20]")
@click.option("--rate", type=float, default=250.0, metavar="HZ", help="Samples a second of the CSV.  [250]")
@click.option("--speed", type=float, metavar="V", help="Limit of every joint, rad/s or m/s.  [the model's, or 1.5]")
@click.option("--torque", type=float, metavar="U", help="Limit of every joint, N m or N.  [the model's]")
@output_options
def command(
    robot: Path,
    joints: str | None,
    seconds: float,
    rate: float,
    speed: float | None,
    torque: float | None,
    to: Output,
) -> int:
    """A motion within the limits of a robot's positions, speeds and torques by which friction has the least errors.

    Fourier series, begun and ended at rest, as trajectory.csv, as a trajectory_msgs/JointTrajectory and as a LeRobot
    data set of actions in degrees. Drive the robot along it, record positions and torques, and give that log to harness
    diagnose.

    \b
    Example: harness plan --robot arm.urdf
             harness plan --robot arm.xml --joints shoulder,elbow --seconds 30
    """
    check_file(robot, suffixes=MODELS)
    from harness.app.plan import plan

    names = tuple(name.strip() for name in (joints or "").split(",") if name.strip())
    with to.told() as progress:
        result = plan(robot, names, seconds, rate, speed, torque, to.out, progress, this_line())
    to.give(result, _print)
    return 0


def _print(result: "PlanResult") -> None:
    rows = []
    for one in result.joints:
        far, force = ("m", "N") if one.slides else ("rad", "N m")
        rows.append(
            (
                one.joint,
                f"{one.low:.3g} to {one.high:.3g} {far}",
                f"{one.speed:.3g} {far}/s",
                f"{one.torque:.3g} {force}",
                *(f"/ {x:.2f}" for x in one.better),
            )
        )
    heads = ("joint", "position", "largest\nspeed", "largest\ntorque", "error of\nCoulomb", "error of\nviscous")
    show_rows(heads, rows, ("joint",))
    say(
        f"Errors of friction are {result.better:.2f} times smaller than along random motions as large as the limits"
        f" allow (the median of 20; each joint's in the table), {result.better_than_conditioned:.2f} times smaller than"
        f" along the one of these with the least condition number, {result.better_than_drawn:.2f} times smaller than"
        " along random motions as drawn."
    )
    say_all(result.notes)
    say_as_it_is(f"trajectory: {result.files['csv']}")
