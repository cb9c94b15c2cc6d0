"""harness tune."""

from typing import TYPE_CHECKING

import click

from harness.cli.options import json_option, quiet_option
from harness.cli.output import check_json, emit_json, say, say_as_it_is, shows_tables
from harness.cli.progress import shown
from harness.cli.tables import show

if TYPE_CHECKING:
    from harness.results.tune import TuneResult


@click.command(short_help="Search an engine's settings for fidelity at a cost; prints what to paste.")
@click.argument("engine")
@click.option("--dt", type=float, default=1e-3, metavar="S", help="Step, s.  [1e-3]")
@click.option("--route", default="joint", metavar="joint|contact|law", help="Where dry friction lives.  [joint]")
@click.option("--max-cost", type=float, metavar="R", help="Wall time over that of what ships.  [any]")
@json_option
@quiet_option
def command(engine: str, dt: float, route: str, max_cost: float | None, json_to: str | None, quiet: bool) -> int:
    """Search an engine's settings on some random sliders, score them on others, print the XML or the calls to paste.

    ENGINE is mujoco, pybullet, dart, rapier, drake or physx, as far as it is installed.

    \b
    Example: harness tune mujoco --dt 0.002
             harness tune mujoco --dt 0.002 --max-cost 1.5
             harness tune pybullet --route contact --dt 0.004 --json tuned.json
    """
    check_json(json_to)
    from harness.app.sweep.tune import tune

    with shown(quiet) as progress:
        result = tune(engine, route, dt, max_cost, progress)  # type: ignore[arg-type]
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
    return 0


def _print(result: "TuneResult") -> None:
    from rich.table import Table

    say(f"{result.engine} {result.version}, {result.route}, step {result.dt_s * 1e3:g} ms: distance from exact")
    table = Table()
    for heading in ("figure", "as shipped", "found"):
        table.add_column(heading, justify="left" if heading == "figure" else "right")
    for figure in result.figures:
        table.add_row(figure.name, _percent(figure.before), _percent(figure.after))
    show(table)
    say_as_it_is(result.paste)
    say(
        f"score on sliders not searched on: {result.score_before:.3g} as shipped, {result.score_after:.3g} found,"
        f" {result.score_preset:.3g} with the preset tuned; it costs {result.cost:.2f} times what ships"
        f" ({result.searched} settings scored)"
    )


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{100.0 * value:.3g} %"
