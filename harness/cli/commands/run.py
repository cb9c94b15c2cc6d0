"""harness run."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import PATH, Joint, engines_option, output_options, robot_options
from harness.cli.output import Output, say, say_all, say_as_it_is, say_left_out, say_paste, show_rows, this_line
from harness.core.bounded import MODELS, check_file
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.run import JointRunResult, RunResult
    from harness.results.scene import SceneResult


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
    type=PATH,
    metavar="FILE",
    help="Run this model, model.json as harness diagnose writes it or an MJCF or URDF of one joint with --x0.",
)
@robot_options
@click.option("--scene", type=PATH, metavar="FILE", help="A scene of your own, MJCF, stepped under its own options.")
@click.option("--body", metavar="NAME", help="Which body of it is to rest.  [the only free one]")
@engines_option("mujoco, pybullet")
@click.option("--preset", metavar="as-shipped|tuned", help="Settings of the engines.  [both]")
@click.option("--dt", type=float, metavar="S", help="Step of the tuned preset, s.  [1e-3]")
@output_options
def command(
    scenario: str | None,
    model: Path | None,
    robot: Joint | None,
    scene: Path | None,
    body: str | None,
    restoring: str | None,
    engines: tuple[str, ...],
    preset: str | None,
    dt: float | None,
    to: Output,
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
             harness run --scene gripper.xml --body cube
             harness run --m 2.42 --k 2310 --c 4.79 --f-k 0.351 --x0 0.01 --json -
    """
    if model is not None:
        check_file(model, suffixes=(".json", *MODELS))
    if scene is not None:
        length = given.pop("duration")
        alone = {"--model": model, "--restoring": restoring, "--preset": preset, "--dt": dt, "--robot": robot}
        _alone("--scene", {"SCENARIO": scenario, "--engine": engines or None, **alone}, given)
        return _scene(scene, body, length, to)
    if body is not None:
        raise InputError("--body", "given without --scene", "it goes with --scene FILE")
    if robot is not None:
        _alone("--robot", {"SCENARIO": scenario, "--model": model, "--restoring": restoring}, given)
        from harness.app.run.joint import JointRun, run_joint

        asked = JointRun(*robot, engines, () if preset is None else (preset,), dt)
        with to.told() as progress:
            joint = run_joint(asked, to.out, progress, this_line())
        to.give(joint, _print_joint)
        return 1 if any(score.error for score in joint.scores) else 0
    from harness.app.run.run import RunOptions, run

    options = RunOptions.asked(scenario, model, restoring, given, engines or None, preset, dt)
    with to.told() as progress:
        result = run(options, to.out, progress, this_line())
    to.give(result, _print)
    if to.tables and not engines:
        say_left_out()
    return 1 if any(trace.error for trace in result.traces) else 0


def _alone(option: str, beside: Mapping[str, object], given: Mapping[str, float | None]) -> None:
    """Raise InputError for what was given beside an option that takes none of it."""
    for name, value in {**beside, **{f"--{name.replace('_', '-')}": value for name, value in given.items()}}.items():
        if value is not None:
            raise InputError(option, f"given with {name}", "one of the two")


def _scene(scene: Path, body: str | None, duration: float | None, to: Output) -> int:
    from harness.app.run.scene import SceneRun, run_scene

    asked = SceneRun(scene, body, duration)
    with to.told() as progress:
        result = run_scene(asked, to.out, progress, this_line())
    to.give(result, _print_scene)
    return 0


def _print_scene(result: "SceneResult") -> None:
    say_all(result.conclusions)
    if result.change:
        say("to paste into your file:")
        for line in result.change.splitlines():
            say_as_it_is(f"  {line}")
    say_as_it_is(f"report: {result.files['report']}")


def _print_joint(result: "JointRunResult") -> None:
    say_all(result.conclusions)
    say_paste(result.paste)
    say_as_it_is(f"report: {result.files['report']}")


def _print(result: "RunResult") -> None:
    from harness.app.run.run import headline, summary

    about, heads, lines = summary(result)
    say(headline(result))
    show_rows(heads, lines, (), about)
    say_all(result.conclusions)
    say_as_it_is(f"report: {result.files['report']}")
