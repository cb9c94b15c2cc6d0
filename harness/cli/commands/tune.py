"""harness tune."""

from typing import TYPE_CHECKING

import click

from harness.cli.options import Joint, json_options, robot_options
from harness.cli.output import Output, figure, say, say_as_it_is, show_rows
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.sweep import TuneResult


@click.command(short_help="Search an engine's settings for fidelity at a cost; prints what to paste.")
@click.argument("engine", nargs=-1, required=True, metavar="ENGINE")
@click.option("--dt", type=float, metavar="S", help="Step, s.  [1e-3, or the robot's own]")
@click.option("--route", metavar="joint|contact|law", help="Where dry friction lives.  [joint]")
@click.option("--max-cost", type=float, metavar="R", help="Wall time over that of what ships.  [any]")
@click.option("--meet", multiple=True, metavar="GOAL", help="Search the cheapest that meets it; may repeat.")
@robot_options
@json_options
def command(
    engine: tuple[str, ...],
    dt: float | None,
    route: str | None,
    max_cost: float | None,
    meet: tuple[str, ...],
    robot: Joint | None,
    to: Output,
) -> int:
    """Search an engine's settings on some random sliders, score them on others, print the XML or the calls to paste.

    With --robot on a joint of it, the others in some poses, as the model's file has it and at its own step. ENGINE is
    mujoco, pybullet, dart, rapier, drake or physx, as far as it is installed. A GOAL is a figure, a limit and its unit
    (creep, drift, rest, position, lift in m, lead, period in s, zeta, x_k, energy in %); exit 1 where one is not met.
    Of several ENGINEs it is the one that meets every GOAL in the least time.

    \b
    Example: harness tune mujoco --dt 0.002
             harness tune mujoco --dt 0.002 --max-cost 1.5
             harness tune pybullet --route contact --dt 0.004 --json tuned.json
             harness tune mujoco --meet "creep<0.01mm/s" --meet "zeta<1%"
             harness tune mujoco pybullet rapier --meet "creep<0.01mm/s"
             harness tune mujoco --robot arm.xml --joint elbow
    """
    if robot is not None and route not in (None, "joint"):
        raise InputError("--route", f"{route}, given with --robot", "--route joint")
    if meet and max_cost is not None:
        raise InputError("--max-cost", "given with --meet", "one of them: --meet searches the cheapest")
    if len(engine) > 1 and (robot is not None or not meet):
        what = "--robot" if robot is not None else "no --meet"
        line = f'harness tune {" ".join(engine)} --meet "creep<0.01mm/s"'
        raise InputError("ENGINE", f"several, given with {what}", f"try: {line}")
    with to.told() as progress:
        from harness.app.sweep.tune import cheapest, goal, tune, tune_joint

        goals = [goal(text) for text in meet]
        if len(engine) > 1:
            result = cheapest(engine, goals, route or "joint", dt, progress)  # type: ignore[arg-type]
        elif robot is None:
            result = tune(engine[0], route or "joint", dt, max_cost, progress, goals=goals)  # type: ignore[arg-type]
        else:
            result = tune_joint(engine[0], *robot, dt, max_cost, progress, goals)
    to.give(result, _print)
    return 0 if all(one.met for one in result.goals) else 1


_ROUNDING = 1e-12
"""A share below which only rounding is left."""


def _percent(share: float | None) -> str:
    return figure(0.0 if share is not None and abs(share) < _ROUNDING else share, ".3g", " %", 100.0)


def _print(result: "TuneResult") -> None:
    what = result.route if result.robot is None else result.robot.joint
    say(f"{result.engine} {result.version}, {what}, step {result.dt_s * 1e3:g} ms: distance from exact")
    before = "as shipped" if result.robot is None else "as the file has it"
    rows = [(one.name, *(_percent(y) for y in (one.before, one.after))) for one in result.figures]
    show_rows(("figure", before, "found"), rows)
    say_as_it_is(result.paste)
    if result.rivals:
        told = [
            (one.engine, "yes" if one.met else one.why or "no", figure(one.seconds, ".3g", " ms", 1e3))
            for one in result.rivals
        ]
        show_rows(("engine", "meets it", "a second of motion takes"), told)
    for one in result.goals:
        unit = "" if one.unit == "1" else f" {one.unit}"
        old, new = (figure(value, ".3g", unit) for value in (one.before, one.after))
        say(f"{one.name}: {old} {before}, {new} found, {'below' if one.met else 'NOT below'} {one.limit:g}{unit}")
    where = "on sliders not searched on" if result.robot is None else "in poses not searched in"
    say(
        f"score {where}: {result.score_before:.3g} {before}, {result.score_after:.3g} found,"
        f" {result.score_preset:.3g} with the preset tuned ({result.searched} settings scored)"
    )
    say(f"what was found costs {result.cost:.2f} times the wall time of what ships")
