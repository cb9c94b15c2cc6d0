"""Which words of friction, damping, armature and servos a model's file has, and what readers make of them."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from harness.app.shared.leaving import leave, leaving
from harness.core.errors import InputError, did_you_mean
from harness.results.words import DefaultResult, ReaderResult, TakenResult, WordResult, WordsResult
from harness.robot.words.find import Words, words_in
from harness.robot.words.motion import by_motion, installed, model, speeds
from harness.robot.words.table import Form, Reader, Taken, Word, table
from harness.robot.words.values import Found
from harness.show.report.words import CALLED, grouped, problems, words_page

__all__ = ["CALLED", "grouped", "problems", "words"]

Measured = dict[tuple[str, str], tuple[Taken, float | None]]


def words(path: Path, engines: Sequence[str] = (), out: Path | None = None) -> WordsResult:
    """The words of a file in every reader of its format, by motion in those that are installed.

    engines : readers to look at; all where empty. out : a folder for result.json and report.html, None for none.
    Raises InputError for a file that is no MJCF, URDF, SDF or USD as text, and for a reader that there is not,
    StoreError.
    """
    result = _result(path, words_in(path), engines)
    if out is not None:
        with leaving("words", out) as output:
            leave(output, result, words_page(result))
    return result.drawn(partial(words_page))


def _result(path: Path, of: Words, engines: Sequence[str]) -> WordsResult:
    form, found = of.form, of.found
    readers = _chosen(form, engines)
    here = {one.name: said for one in readers if (said := installed(one)) is not None}
    used = {one.word.key: one.word for one in found if one.word is not None and one.word.probe is not None}
    measured = _measured(form, [one for one in readers if one.name in here], list(used.values()))
    words = [_word(one, readers, measured) for one in found]
    lost = [w for w in words if engines and any(taken.fate != "read" for taken in w.readers.values())]
    names = {one.name for one in readers}
    kinds = {one.kind for one in found} | {"friction", "damping"}
    result = WordsResult(
        file=str(path.absolute()),
        format=form,
        readers=[
            ReaderResult(
                name=one.name,
                title=one.title,
                version=here.get(one.name, one.version),
                evidence="motion" if one.name in here else "cited",
                source=one.source,
            )
            for one in readers
        ],
        words=words,
        defaults=[
            DefaultResult.taken_from(one)
            for one in table().defaults
            if one.reader in names and kinds.intersection(one.kinds)
        ],
        wrong=sum(bool(one.problem) for one in words),
        lost=len(lost),
        unread=of.unread,
        statement="",
    )
    return result.model_copy(update={"statement": statement(result)})


def statement(result: WordsResult) -> str:
    """The result in two sentences."""
    names = ", ".join(result.unread)
    other = (
        f" It names {'another model' if len(result.unread) == 1 else 'other models'}, not read: {names}."
        if names
        else ""
    )
    if not result.words:
        return f"This {result.format.upper()} has no word of friction, damping, armature or a servo.{other}"
    count = f"{len(result.words)} word{'s' * (len(result.words) != 1)}"
    wrong = f"{result.wrong} of them {'is' if result.wrong == 1 else 'are'} wrong" if result.wrong else "none is wrong"
    titles = {one.name: one.title for one in result.readers}
    losing = [
        f"{titles[name]} ({dropped})"
        for name in titles
        if (dropped := sum(w.readers[name].fate in ("dropped", "refused") for w in result.words if not w.problem))
    ]
    rest = f" Dropped or refused by {', '.join(losing)}." if losing else ""
    return f"{count}, {wrong}.{rest}{other}"


def _chosen(form: Form, engines: Sequence[str]) -> tuple[Reader, ...]:
    every = {one.name: one for one in table().of(form)}
    for name in engines:
        if name not in every:
            found = f"{name!r}" + (f" reads no {form.upper()}" if name in table().readers else "")
            raise InputError("--engine", found, f"one of {', '.join(every)}{did_you_mean(name, every)}")
    return tuple(one for name, one in every.items() if not engines or name in engines)


def _measured(form: Form, readers: Sequence[Reader], used: Sequence[Word]) -> Measured:
    """What readers that are installed make of words, by reader and the word's key."""
    if not used or not readers:
        return {}
    keys = [(reader.name, key) for reader in readers for key in ("", *(word.key for word in used))]
    texts = {"": model(form)}
    for word in used:
        assert word.probe is not None
        texts[word.key] = model(form, **{word.probe.slot: word.probe.text})
    found = dict(zip(keys, speeds(form, [(reader, texts[key]) for reader, key in keys]), strict=True))
    return {(reader.name, word.key): by_motion(word, reader, found) for reader in readers for word in used}


def _word(one: Found, readers: Sequence[Reader], measured: Measured) -> WordResult:
    taken = {}
    for reader in readers:
        said, times = one.taken(reader.name), None
        by_file = reader.name in dict(one.cells)
        evidence = "file" if by_file else "cited"
        key = (reader.name, "" if one.word is None else one.word.key)
        if one.word is not None and not one.problem and not by_file and key in measured:
            (said, times), evidence = measured[key], "motion"
        taken[reader.name] = TakenResult.model_validate(
            {"fate": said.fate, "note": said.note, "evidence": evidence, "measured": times}
        )
    unit = "" if one.word is None else one.word.unit
    return WordResult.taken_from(one, file=str(one.file), unit=unit, readers=taken)
