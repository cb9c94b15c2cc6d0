"""Options that several commands share; a command gets each group of them as one argument."""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click
from click.shell_completion import CompletionItem

from harness.cli.output import Output
from harness.core.bounded import MODELS, check_file
from harness.core.errors import InputError
from harness.core.registered import names

F = TypeVar("F", bound=Callable[..., Any])
PATH = click.Path(path_type=Path, readable=False)
"""Of what cannot be read the reader says so, by its name: of several files the others go on."""


def group(name: str, make: Callable[..., Any], *options: Callable[[F], F]) -> Callable[[F], F]:
    """Options that a command gets as its argument ``name``: ``make`` of their values, by their names."""

    def decorate(function: F) -> F:
        def own(**given: Any) -> Any:
            return function(**given)

        for option in reversed(options):
            own = option(own)
        parameters: list[click.Parameter] = own.__dict__["__click_params__"]
        mine = [str(one.name) for one in parameters]

        @functools.wraps(function)
        def gathered(**given: Any) -> Any:
            values = {one: given.pop(one) for one in mine}
            return function(**{name: make(**values)}, **given)

        gathered.__dict__["__click_params__"] = [*getattr(function, "__click_params__", ()), *parameters]
        return gathered  # type: ignore[return-value]

    return decorate


class Several(click.Option):
    """An option that takes every word up to the next option: ``--before a.csv b.csv --after c.csv``."""

    def add_to_parser(self, parser: Any, ctx: click.Context) -> None:
        super().add_to_parser(parser, ctx)
        own = next(parser._long_opt[name] for name in self.opts)
        take = own.process

        def process(value: Any, state: Any) -> None:
            words = [value]
            while state.rargs and not state.rargs[0].startswith("-"):
                words.append(state.rargs.pop(0))
            for word in words:
                take(word, state)

        own.process = process


_JSON = click.option(
    "--json",
    "json_to",
    metavar="FILE",
    help='Write the result as JSON; "-" is standard output, and nothing else is on it.',
)
_QUIET = click.option("--quiet", "-q", is_flag=True, help="No table and no progress.")
_OUT = click.option("--out", type=PATH, metavar="DIR", help="Output folder, new or empty.  [reports/NAME-TIME]")
jobs_option = click.option("--jobs", type=click.IntRange(min=1), metavar="N", help="Processes to use.  [all cores]")
cluster_option = click.option("--cluster", metavar="ADDRESS", help="A dask scheduler, such as tcp://127.0.0.1:8786.")
json_options = group("to", Output, _JSON, _QUIET)
"""--json, --quiet."""
output_options = group("to", Output, _OUT, _JSON, _QUIET)
"""--out, --json, --quiet."""


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


_COLUMNS = click.option("--columns", metavar="MAP", help='Columns, constants and units: "t=t,x=qm[mm],u=vir*35.15[N]".')
_READING = (
    click.option("--skip-rows", type=int, default=0, metavar="N", help="Lines before the header or the numbers."),
    click.option("--rate", type=float, metavar="HZ", help="Sampling rate, where no column gives the time."),
    click.option("--from", "start", type=float, metavar="S", help="Skip what comes before this time."),
    click.option("--to", "stop", type=float, metavar="S", help="Skip what comes after this time."),
    click.option("--drop-nan", is_flag=True, help="Skip rows in which a channel has no value."),
    click.option("--run", type=int, metavar="N", help="Which run of a file that holds several.  [1]"),
)
_JOIN = click.option(
    "--join",
    type=PATH,
    multiple=True,
    metavar="FILE",
    help="Another file of the motion: v.csv beside x.csv; may repeat.",
)
reading_options = group("reading", dict, _COLUMNS, *_READING, _JOIN)
"""Those of _READING, --columns and --join, by the names that ReadOptions has for them."""
trace_option = click.option("--trace", metavar="NAME", help='Which trace of a .rrd, such as "mujoco tuned".')
calibration_option = click.option(
    "--calibration", type=PATH, metavar="FILE", help="LeRobot's, where positions are -100 to 100 of each joint's range."
)
topic_option = click.option("--topic", metavar="NAME", help="Which topic of a bag, or episode of a data set.")
log_options = group(
    "reading",
    dict,
    click.option("--columns", metavar="MAP", help='Columns and units: "t=t,elbow.position=q3[deg]".'),
    *_READING,
    _JOIN,
    topic_option,
    click.option("--gain", type=float, metavar="NM_PER_A", help="Makes efforts of currents, N m per A at the joint."),
    click.option("--angle-unit", metavar="UNIT", help="Of positions that say none, such as deg.  [rad]"),
    calibration_option,
)
"""Those of a robot's log: the same but for --trace, and --topic, --gain, --angle-unit, --calibration."""

Gravity = tuple[float, float, float]
Joint = tuple[Path, str | None, Gravity | None]
"""A robot's model, which joint of it, and gravity, m/s^2."""


def _joint(robot: Path | None, joint: str | None, gravity: Gravity | None, base: str | None) -> Joint | None:
    """None where no robot is given. Raises InputError for a base that moves: no log that is read says how."""
    if base not in (None, "fixed", "free"):
        raise InputError("--base", repr(base), "fixed or free")
    if base == "free":
        rack = "--base fixed, of a robot in a rack or lying with its trunk still (--gravity says how)"
        raise InputError("--base free", "how the base moves is in no log that is read", rack)
    if robot is not None:
        check_file(robot, suffixes=MODELS)
        return robot, joint, gravity
    refuse("given without --robot", "it goes with --robot FILE", joint=joint, gravity=gravity, base=base)
    return None


robot_options = group(
    "robot",
    _joint,
    click.option("--robot", type=PATH, metavar="FILE", help="A robot's model, MJCF, URDF or SDF."),
    click.option("--joint", metavar="NAME", help="Which joint of it, or all.  [the only one that moves, or all]"),
    click.option("--gravity", type=float, nargs=3, metavar="X Y Z", help="m/s^2, at the base.  [the model's]"),
    click.option("--base", metavar="fixed", help="A free or floating base is held.  [fixed]"),
)
"""--robot, --joint, --gravity, --base."""


rows_options = group(
    "rows",
    dict,
    click.option(
        "-k", "only", multiple=True, metavar="PATTERN", help="Rows: part of a name, or a whole one with *; may repeat."
    ),
    click.option("--skip", multiple=True, metavar="PATTERN[: WHY]", help="Rows to skip; may repeat."),
    click.option("--xfail", multiple=True, metavar="PATTERN[: WHY]", help="Rows known to get worse; may repeat."),
)
"""-k, --skip, --xfail, by the names that SweepOptions has for them."""


def refuse(found: str, accepted: str, **given: object) -> None:
    """Raise InputError for the first option that is given, by the name of its parameter."""
    for name, value in given.items():
        if value is not None and value is not False:
            raise InputError(f"--{name.replace('_', '-')}", found, accepted)
