"""harness prove."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import jobs_option, output_options
from harness.cli.output import check_json, emit_json, say, shows_tables, this_line
from harness.cli.progress import shown
from harness.cli.tables import show
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.prove import ProofCheck, ProofFigure, ProofResult


@click.command(short_help="The sealed blind proof: hidden effects, sealed answers, scores.")
@click.option("--singles", type=click.IntRange(min=0), metavar="N", help="Recordings with one effect.  [300]")
@click.option("--controls", type=click.IntRange(min=0), metavar="N", help="Recordings with none.  [300]")
@click.option("--pairs", type=click.IntRange(min=0), metavar="N", help="Recordings with two effects.  [60]")
@click.option("--outside", type=click.IntRange(min=0), metavar="N", help="With an effect no catalogue holds.  [60]")
@click.option("--machines", is_flag=True, help="600 recordings of machines instead, half of them controls.")
@click.option("--short", is_flag=True, help="24 recordings in all: no evidence. With --verify: draw 24 again.")
@click.option("--verify", type=click.Path(path_type=Path), metavar="DIR", help="Recompute a proof; run nothing.")
@click.option("--resume", is_flag=True, help="Go on with the proof that --out holds.")
@click.option("--cluster", metavar="ADDRESS", help="A dask scheduler, such as tcp://127.0.0.1:8786.")
@jobs_option
@output_options
def command(
    machines: bool,
    short: bool,
    verify: Path | None,
    resume: bool,
    cluster: str | None,
    jobs: int | None,
    out: Path | None,
    json_to: str | None,
    quiet: bool,
    **sizes: int | None,
) -> int:
    """The sealed blind proof that a diagnosis names physics it was never told.

    A seed from the operating system is committed to; recordings with hidden effects are drawn from it by a plant that
    shares no law with the diagnosis; each is diagnosed by a process that gets the recording and nothing else; verdicts
    are hashed; then seed and answers are opened, and all is scored and published. Exit 1 when a figure falls short
    (with fewer recordings than the full number the figures are no evidence, and the exit code is 0).

    --machines draws recordings as real machines make them: one large omission among small ones, a hand that gives way,
    a zero anywhere, sensors as they are; half of them have no large one.

    --verify recomputes hashes, commitments, scores and recordings of a published proof. Exit 1 when it was changed.

    \b
    Example: harness prove --short
             harness prove --out reports/mine --jobs 8
             harness prove --verify reports/proof
    """
    check_json(json_to)
    given = {name: value for name, value in sizes.items() if value is not None}
    if verify is not None:
        _alone(
            given,
            {"--machines": machines, "--resume": resume, "--out": out is not None, "--cluster": cluster is not None},
        )
        return _verify(verify, short, jobs, json_to, quiet)
    plans = [name for name, chosen in (("short", short), ("machines", machines), ("resume", resume)) if chosen]
    if given and plans:
        raise InputError(f"--{next(iter(given))}", f"given with --{plans[0]}", _ONE)
    if machines and resume:
        raise InputError(
            "--machines", "given with --resume", "--resume alone is accepted: it goes on with what was begun"
        )
    if short and resume:
        raise InputError("--short", "given with --resume", "--resume alone is accepted: it goes on with what was begun")
    from harness.app.prove.prove import ProveOptions, prove

    options = ProveOptions.chosen(given, short, machines, jobs=jobs, cluster=cluster, resume=resume)
    with shown(quiet) as progress:
        result = prove(options, out, progress, this_line())
    emit_json(result, json_to)
    if shows_tables(json_to, quiet):
        _print(result)
    return 1 if result.evidence and result.shortfalls else 0


_ONE = "one of the two is accepted"


def _alone(given: dict[str, int], others: dict[str, bool]) -> None:
    """Refuse what --verify does not take."""
    named = [f"--{name}" for name in given] + [name for name, is_given in others.items() if is_given]
    if named:
        raise InputError(named[0], "given with --verify", _ONE)


def _verify(folder: Path, short: bool, jobs: int | None, json_to: str | None, quiet: bool) -> int:
    from harness.app.prove.verify import verify_proof

    with shown(quiet) as progress:
        check = verify_proof(folder, short, jobs, progress)
    emit_json(check, json_to)
    if shows_tables(json_to, quiet):
        _print_check(check)
    return 0 if check.accepted else 1


def _print_check(check: "ProofCheck") -> None:
    for line in [*check.wrong, *check.notes]:
        say(f"- {line}")
    again = f"{check.drawn_again} of {check.recordings} recordings drawn again, {check.identical} the same to the bit"
    say(f"{check.folder}: {'accepted' if check.accepted else 'rejected'}; {again}")


def _print(result: "ProofResult") -> None:
    from rich.table import Table

    table = Table(title=None if result.evidence else "no evidence: too few recordings for the figures to say anything")
    for heading in ("figure", "found", "95 % interval", "cases", "asked", ""):
        table.add_column(heading, justify="left" if heading in ("figure", "asked", "") else "right")
    for figure in result.figures:
        state = {True: "reached", False: "falls short", None: ""}[figure.met]
        table.add_row(
            figure.label,
            _said(figure, figure.value),
            f"{_said(figure, figure.low)} to {_said(figure, figure.high)}",
            str(figure.cases),
            figure.asked,
            state,
        )
    show(table)
    if result.not_tested:
        say(f"- not tested: {', '.join(result.not_tested)}")
    for line in [*result.shortfalls, *result.given_up]:
        say(f"- {line}")
    right = sum(case.right for case in result.cases)
    say(f"{len(result.cases)} recordings, {right} answered right, seed {result.seed}")


def _said(figure: "ProofFigure", value: float | None) -> str:
    if value is None:
        return "-"
    return f"{100.0 * value:.1f} %" if figure.share else f"{value:.3g}"
