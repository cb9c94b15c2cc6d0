"""harness run."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import engine_options, output_options
from harness.cli.output import check_json, emit_json, show, shows_tables, this_line
from harness.cli.progress import shown

if TYPE_CHECKING:
    from harness.app.model_run import ModelScenario
    from harness.results.common import P
    from harness.results.run import RunResult, TraceResult


@click.command(short_help="One slider in the exact reference, MuJoCo and PyBullet, with estimators and report.")
@click.argument("scenario", required=False)
@click.option("--m", type=float, metavar="KG", help="Mass.  [1]")
@click.option("--c", type=float, metavar="NS/M", help="Viscous damping.  [1]")
@click.option("--k", type=float, metavar="N/M", help="Stiffness.  [100]")
@click.option("--f-k", "f_k", type=float, metavar="N", help="Kinetic friction.  [3]")
@click.option("--f-s", "f_s", type=float, metavar="N", help="Break-away friction.  [that of --f-k]")
@click.option("--x0", type=float, metavar="M", help="Position at release.  [1]")
@click.option("--v0", type=float, metavar="M/S", help="Speed at release.  [0]")
@click.option("--duration", type=float, metavar="S", help="Length of the run.  [3, or until it rests]")
@click.option(
    "--model",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Run this model (harness.model/1), as harness diagnose writes it, in place of a scenario.",
)
@engine_options
@output_options
def command(
    scenario: str | None,
    model: Path | None,
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
    in the output folder. SCENARIO is free-decay, the paper's case unless parameters are given.

    \b
    Example: harness run
             harness run --engine mujoco --preset tuned --dt 5e-4
             harness run --model model.json
             harness run --m 2.42 --k 2310 --c 4.79 --f-k 0.351 --x0 0.01 --json -
    """
    check_json(json_to)
    from harness.app.run import RunOptions, run
    from harness.app.scenarios import NAMES, scenario_named

    if model is None:
        chosen = RunOptions.chosen(scenario_named(scenario or NAMES[0], given), engines, preset, dt)
    else:
        chosen = RunOptions.chosen(_scenario_of(model, scenario, given), engines, preset, dt)
    with shown(quiet) as progress:
        result = run(chosen, out, progress, this_line())
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
    return 1 if any(trace.error for trace in result.traces) else 0


def _scenario_of(model: Path, scenario: str | None, given: dict[str, float | None]) -> "ModelScenario":
    """The model's scenario; InputError for anything else that says what the model says."""
    from harness.app.model_run import ModelScenario
    from harness.core.errors import InputError

    if scenario is not None:
        raise InputError("--model", f"given with the scenario {scenario}", "one of the two is accepted")
    for name, value in given.items():
        if name != "duration" and value is not None:
            option = f"--{name.replace('_', '-')}"
            raise InputError("--model", f"given with {option} {value:g}", f"the model's own {name} is accepted")
    return ModelScenario.of_file(model, given["duration"])


def _print(result: "RunResult") -> None:
    from rich.table import Table

    click.echo("x_k and zeta as the estimators read them; error, creep, rest and lead against the exact motion")
    table = Table()
    for heading in (
        "source",
        "step ms",
        "x_k mm",
        "x_k at reversal",
        "zeta",
        "error mm",
        "creep mm/s",
        "stick s",
        "lead ms",
    ):
        table.add_column(heading, justify="left" if heading == "source" else "right", no_wrap=True)
    for trace in result.traces:
        table.add_row(*_row(trace))
    show(table)
    for sentence in result.conclusions:
        click.echo(f"- {sentence}")
    click.echo(f"report: {result.files['report']}")


def _row(trace: "TraceResult") -> list[str]:
    label = f"{trace.source} {trace.preset}"
    if trace.error is not None:
        return [label, "failed"]
    guarded, local = trace.estimates.get("acceleration"), trace.estimates.get("acceleration-local")
    metrics = trace.metrics
    return [
        label,
        _number(trace.dt_s, 1e3),
        _estimate(guarded.x_k if guarded else None, 1e3),
        _estimate(local.x_k if local else None, 1e3),
        _estimate(guarded.zeta if guarded else None, 1.0),
        _number(metrics.max_error_m, 1e3),
        _number(metrics.creep_m_s, 1e3),
        _number(metrics.stick_time_s, 1.0),
        _number(metrics.reversal_lead_s, 1e3),
    ]


def _number(value: float | None, scale: float) -> str:
    return "-" if value is None else f"{value * scale:.4g}"


def _estimate(number: "P | None", scale: float) -> str:
    if number is None or number.value is None:
        return "-"
    return f"{number.value * scale:.4g}"
