"""harness words."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from harness.cli.options import PATH, json_options
from harness.cli.output import Output, say, say_all, say_as_it_is, show_rows

if TYPE_CHECKING:
    from harness.results.words import TakenResult, WordsResult


@click.command(short_help="Which friction words of a model's file each engine reads, drops or takes otherwise.")
@click.argument("file", type=PATH)
@click.option("--engine", "engines", multiple=True, metavar="NAME", help="Reader to look at; may repeat.  [all]")
@click.option("--out", type=PATH, metavar="DIR", help="Folder for result.json and report.html, new or empty.  [none]")
@json_options
def command(file: Path, engines: tuple[str, ...], out: Path | None, to: Output) -> int:
    """Every word of friction, damping, armature and servos of FILE (MJCF, URDF, SDF, or USD as text), against every
    engine and importer of its format: read, dropped, in another unit, with another meaning; and what is wrong with it.

    Readers that are installed are run on a hinge with the word and without it; the others are cited. Ends with 1
    where a word is wrong, or --engine does not take one as it is written.

    \b
    Example: harness words arm.urdf
             harness words scene.xml --engine mujoco --engine mjx --out words
    """
    from harness.app.words import words

    result = words(file, engines, out)
    to.give(result, lambda result: _print(result, file, noted=bool(engines)))
    if out is not None and to.tables:
        say_as_it_is(f"report: {out / 'report.html'}")
    return 1 if result.wrong or result.lost else 0


def _print(result: "WordsResult", file: Path, noted: bool) -> None:
    """The answer and the table; noted : how each engine reads each word as well, which is long for all of them."""
    from harness.app.words import CALLED, grouped, problems

    say(result.statement)
    say_all(problems(result))
    rows = grouped(result)
    if rows:
        heads = [one.title + ("*" if one.evidence == "motion" else "") for one in result.readers]
        cells = [[head, *(CALLED[own[0].readers[r.name].fate] for r in result.readers)] for head, own in rows]
        show_rows(("word", *heads), cells)
        if any(one.evidence == "motion" for one in result.readers):
            say("* by motion: a hinge with the word against one without it; the others as their sources say (--json)")
    say_all(
        dict.fromkeys(
            f"line {own[0].line}, {own[0].place}: {own[0].name} {own[0].note}" for _, own in rows if own[0].note
        )
    )
    if not noted:
        say_as_it_is(f"how an engine reads them, and what it has without a word: harness words {file} --engine NAME")
        return
    titles = {one.name: one.title for one in result.readers}
    notes: dict[str, list[str]] = {}
    for _, own in rows:
        for name, taken in own[0].readers.items():
            if said := _said(taken):
                notes.setdefault(f"{own[0].name}: {said}", []).append(titles[name])
    say_all(f"{note} ({', '.join(who)})" if who else note for note, who in notes.items())
    for one in result.defaults:
        say(f"- without a word {titles[one.reader]} has {one.value}; against it: {one.mend}")


def _said(taken: "TakenResult") -> str:
    plain = taken.fate in ("read", "dropped") and taken.measured is not None
    return taken.note if not plain or taken.note else ""
