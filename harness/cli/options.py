"""Options that several commands share."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click
from click.shell_completion import CompletionItem

from harness.core.registered import names

F = TypeVar("F", bound=Callable[..., Any])


def _apply(*options: Callable[[F], F]) -> Callable[[F], F]:
    def decorate(function: F) -> F:
        for option in reversed(options):
            function = option(function)
        return function

    return decorate


json_option = click.option(
    "--json",
    "json_to",
    metavar="FILE",
    help='Write the result as JSON; "-" is standard output, and nothing else is on it.',
)
quiet_option = click.option("--quiet", "-q", is_flag=True, help="No table and no progress.")
out_option = click.option(
    "--out", type=click.Path(path_type=Path), metavar="DIR", help="Output folder, new or empty.  [reports/NAME-TIME]"
)
jobs_option = click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Processes to use.  [all cores]")


def output_options(function: F) -> F:
    """--out, --json, --quiet."""
    return _apply(out_option, json_option, quiet_option)(function)


def _engine_names(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """For the completion of a shell: engines that are registered, installed or not."""
    return [CompletionItem(name) for name in sorted(names("harness.engines")) if name.startswith(incomplete)]


def engines_option(given: str) -> Callable[[F], F]:
    """--engine, which may repeat; ``given`` says what is taken where it is not given."""
    return click.option(
        "--engine",
        "engines",
        multiple=True,
        metavar="NAME[@PYTHON]",
        shell_complete=_engine_names,
        help=f"Engine; may repeat.  [{given}]",
    )


def engine_options(function: F) -> F:
    """--engine, --preset, --dt."""
    return _apply(
        engines_option("mujoco, pybullet"),
        click.option("--preset", metavar="as-shipped|tuned", help="Settings of the engines.  [both]"),
        click.option("--dt", type=float, metavar="S", help="Step of the tuned preset, s.  [1e-3]"),
    )(function)


_READING = (
    click.option("--columns", metavar="MAP", help='Columns, constants and units: "t=t,x=qm[mm],u=vir*35.15[N]".'),
    click.option("--skip-rows", type=int, default=0, metavar="N", help="Lines before the header or the numbers."),
    click.option("--rate", type=float, metavar="HZ", help="Sampling rate, where no column gives the time."),
    click.option("--from", "start", type=float, metavar="S", help="Leave out what comes before this time."),
    click.option("--to", "stop", type=float, metavar="S", help="Leave out what comes after this time."),
    click.option("--drop-nan", is_flag=True, help="Leave out rows in which a channel has no value."),
)


def reading_options(function: F) -> F:
    """--columns, --skip-rows, --rate, --from, --to, --drop-nan, --trace."""
    trace = click.option("--trace", metavar="NAME", help='Which trace of a .rrd, such as "mujoco tuned".')
    return _apply(*_READING, trace)(function)


def log_options(function: F) -> F:
    """--columns, --skip-rows, --rate, --from, --to, --drop-nan, --topic, --gain, --angle-unit: of a robot's log."""
    columns = click.option("--columns", metavar="MAP", help='Columns and units: "t=t,elbow.position=q3[deg]".')
    return _apply(
        columns,
        *_READING[1:],
        click.option("--topic", metavar="NAME", help="Which topic of a bag, or episode of a data set."),
        click.option(
            "--gain", type=float, metavar="NM_PER_A", help="Makes efforts of currents, N m per A at the joint."
        ),
        click.option("--angle-unit", metavar="UNIT", help="Of positions that say none, such as deg.  [rad]"),
    )(function)


def robot_options(function: F) -> F:
    """--robot, --joint, --gravity."""
    return _apply(
        click.option("--robot", type=click.Path(path_type=Path), metavar="FILE", help="A robot's model, MJCF or URDF."),
        click.option("--joint", metavar="NAME", help="Which joint of it.  [the only one that moves]"),
        click.option("--gravity", type=float, nargs=3, metavar="X Y Z", help="m/s^2, at the base.  [the model's]"),
    )(function)
