"""harness prove."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import PATH, cluster_option, jobs_option, output_options, refuse
from harness.cli.output import Output, figure, say, say_all, show_rows, this_line
from harness.core.errors import InputError

if TYPE_CHECKING:
    from harness.results.prove import ProofCheck, ProofFigure, ProofResult


@click.command(short_help="The sealed blind proof: hidden effects, sealed answers, scores.")
@click.option("--singles", type=click.IntRange(min=0), metavar="N", help="Recordings with one effect.  [300]")
@click.option("--controls", type=click.IntRange(min=0), metavar="N", help="Recordings with none.  [300]")
@click.option("--pairs", type=click.IntRange(min=0), metavar="N", help="Recordings with two effects.  [60]")
@click.option("--outside", type=click.IntRange(min=0), metavar="N", help="With an effect no catalogue holds.  [60]")
@click.option("--machines", is_flag=True, help="600 recordings of machines instead, half of them controls.")
@click.option(
    "--paths",
    type=click.IntRange(min=1),
    is_flag=False,
    flag_value=7200,
    metavar="[N]",
    help="Instead N recordings on every way that gives a verdict, as users run them.  [7200]",
)
@click.option(
    "--real",
    type=click.IntRange(min=1),
    is_flag=False,
    flag_value=200,
    metavar="[N]",
    help="Instead N exact effects on recordings of real machines, and causes that were switched.  [200]",
)
@click.option("--from", "folder", type=PATH, metavar="DIR", help="Folder of these recordings; with --real, --verify.")
@click.option("--short", is_flag=True, help="24 recordings in all: no evidence. With --verify: draw 24 again.")
@click.option("--verify", type=PATH, metavar="DIR", help="Recompute a proof; run nothing.")
@click.option("--resume", is_flag=True, help="Go on with the proof that --out holds.")
@cluster_option
@jobs_option
@output_options
def command(
    machines: bool,
    paths: int | None,
    real: int | None,
    folder: Path | None,
    short: bool,
    verify: Path | None,
    resume: bool,
    cluster: str | None,
    jobs: int | None,
    to: Output,
    **sizes: int | None,
) -> int:
    """The sealed blind proof that a diagnosis names physics it was never told.

    A seed from the operating system is committed to; recordings with hidden effects are drawn from it by a plant that
    shares no law with the diagnosis; each is diagnosed by a process that gets the recording and nothing else; verdicts
    are hashed; then seed and answers are opened, and all is scored and published. Exit 1 when a figure falls short
    (with fewer recordings than the full number the figures are no evidence, and the exit code is 0).

    --machines draws recordings as real machines make them: one large omission among small ones, a hand that gives way,
    a zero anywhere, sensors as they are; half of them have no large one.

    --paths asks every way that gives a verdict: effects in published forms that are not the catalogue's, unknown ones,
    and as many controls, in files as loggers write them, half of them without any option.

    --real asks recordings of real machines in --from DIR, as its machines.toml lists them: each as it was measured,
    then with an effect that is exact whatever the machine does besides (of sensor and clock, or a known force beside
    the measured one), and two conditions of a machine of which one cause was switched.

    --verify recomputes hashes, commitments, scores and recordings of a published proof. Exit 1 when it was changed.

    \b
    Example: harness prove --short
             harness prove --out reports/mine --jobs 8
             harness prove --real --from recordings
             harness prove --verify reports/proof
    """
    given = {name: value for name, value in sizes.items() if value is not None}
    one = "one of the two"
    if verify is not None:
        refuse(
            "given with --verify",
            one,
            **given,
            machines=machines,
            paths=paths,
            real=real,
            resume=resume,
            out=to.out,
            cluster=cluster,
        )
        from harness.app.prove.verify import verify_proof

        with to.told() as progress:
            check = verify_proof(verify, short, jobs, progress, folder)
        to.give(check, _print_check)
        return 0 if check.accepted else 1
    plans = [
        name
        for name, chosen in (
            ("short", short),
            ("machines", machines),
            ("paths", paths),
            ("real", real),
            ("resume", resume),
        )
        if chosen
    ]
    if given and plans:
        raise InputError(f"--{next(iter(given))}", f"given with --{plans[0]}", one)
    if resume:
        accepted = "--resume alone, which goes on with what was begun"
        refuse("given with --resume", accepted, machines=machines, paths=paths, real=real, short=short)
    if machines:
        refuse("given with --machines", one, paths=paths, real=real)
    if real:
        refuse("given with --real", one, paths=paths)
    if real is not None and folder is None:
        raise InputError("--real", "given without --from", "try: harness prove --real --from DIR")
    if folder is not None and not (real or resume):
        raise InputError("--from", "given without --real", f"try: harness prove --real --from {folder}")
    from harness.app.prove.prove import ProveOptions, prove

    options = ProveOptions.chosen(
        given, short, machines, paths or 0, real or 0, jobs=jobs, cluster=cluster, resume=resume, folder=folder
    )
    with to.told() as progress:
        result = prove(options, to.out, progress, this_line())
    to.give(result, _print)
    return 1 if result.evidence and result.shortfalls else 0


def _print_check(check: "ProofCheck") -> None:
    say_all([*check.wrong, *check.notes])
    again = f"{check.drawn_again} of {check.recordings} recordings drawn again, {check.identical} the same to the bit"
    say(f"{check.folder}: {'accepted' if check.accepted else 'rejected'}; {again}")


def _print(result: "ProofResult") -> None:
    state = {True: "reached", False: "falls short", None: ""}
    show_rows(
        ("figure", "found", "95 % interval", "cases", "asked", ""),
        [
            (
                one.label,
                _said(one, one.value),
                f"{_said(one, one.low)} to {_said(one, one.high)}",
                str(one.cases),
                one.asked,
                state[one.met],
            )
            for one in result.figures
        ],
        ("figure", "asked", ""),
        None if result.evidence else "no evidence: too few recordings for the figures to say anything",
    )
    if result.not_tested:
        say(f"- not tested: {', '.join(result.not_tested)}")
    say_all([*result.shortfalls, *result.given_up, *(result.real.not_run if result.real else [])])
    if result.absent:
        say(f"- not at hand, not run: {', '.join(result.absent)}")
    right = sum(case.right for case in result.cases)
    say(f"{len(result.cases)} recordings, {right} answered right, seed {result.seed}")


def _said(of: "ProofFigure", value: float | None) -> str:
    return figure(value, ".1f", " %", 100.0) if of.share else figure(value, ".3g")
