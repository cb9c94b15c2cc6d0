"""The page of a file's words: what is wrong, the table of readers, defaults, sources."""

from pathlib import PurePath

from harness.results.words import TakenResult, WordResult, WordsResult
from harness.show.blocks import Cell, Column, Items, Page, Row, Section, Table, tabulated, verdict

CALLED = {"read": "read", "dropped": "dropped", "unit": "other unit", "meaning": "other meaning", "refused": "refused"}
"""Fates as they are printed."""
_MOST = 6
"""Lines that a sentence names."""
_GRADES = {"read": 0, "unit": 2, "meaning": 3, "dropped": 4, "refused": 4}


def grouped(result: WordsResult) -> list[tuple[str, list[WordResult]]]:
    """Words that are right, those alike together: a name with how many there are and from where to where they go."""
    groups: dict[tuple[str, str], list[WordResult]] = {}
    for one in result.words:
        if not one.problem:
            groups.setdefault((one.name, str(sorted((n, t.fate, t.note) for n, t in one.readers.items()))), []).append(
                one
            )
    named = []
    for (name, _), own in groups.items():
        values = list(dict.fromkeys(one.value for one in own))
        shown = values[0] if len(values) == 1 else f"{len(own)} values"
        named.append((f"{name} = {shown}" + (f" ({len(own)} times)" if len(own) > 1 and len(values) == 1 else ""), own))
    return named


def problems(result: WordsResult) -> list[str]:
    """What is wrong with words, and what to write, those alike together."""
    groups: dict[tuple[str, ...], list[WordResult]] = {}
    for one in result.words:
        if one.problem:
            groups.setdefault((one.name, one.value, one.problem, one.fix), []).append(one)
    said = []
    for (name, value, problem, fix), own in groups.items():
        lines = list(dict.fromkeys(str(one.line) for one in own))
        shown = ", ".join(lines[:_MOST]) + (f" and {len(lines) - _MOST} more" if len(lines) > _MOST else "")
        where = f"line{'s' * (len(lines) > 1)} {shown}" + (f", {own[0].place}" if len(lines) == 1 else "")
        said.append(f"{where}: {name}{f' = {value}' if value else ''} {problem}{f'; {fix}' if fix else ''}")
    return said


def words_page(result: WordsResult) -> Page:
    """The page."""
    columns = [Column(one.title, str, hint=one.version) for one in result.readers]
    rows = [
        Row(head, [_cell(own[0].readers[one.name]) for one in result.readers], f"line {own[0].line}, {own[0].place}")
        for head, own in grouped(result)
    ]
    wrong = problems(result)
    titles = {one.name: one.title for one in result.readers}
    said = [
        Column("acts where the file says nothing", lambda one: one.value),
        Column("against it", lambda one: one.mend),
    ]
    sources = [
        Column("version", lambda one: one.version),
        Column("known", lambda one: "run here, by motion" if one.evidence == "motion" else "cited"),
        Column("source", lambda one: one.source),
    ]
    caption = "Of words that are right; a number is the value that acts over the one written, measured by motion."
    sections = [
        verdict(result.statement),
        *([Section("What is wrong", [Items(wrong)])] if wrong else []),
        Section("What readers make of it", [Table("word", columns, rows, caption)] if rows else []),
        Section("Defaults", [tabulated("reader", said, result.defaults, lambda one: titles[one.reader])]),
        Section("Readers", [tabulated("reader", sources, result.readers, lambda one: one.title)]),
    ]
    return Page(f"Words of {PurePath(result.file).name}", result.format.upper(), sections)


def _cell(taken: TakenResult) -> Cell:
    notes = [f"{taken.measured:.3g} x"] if taken.measured is not None else []
    return Cell(CALLED[taken.fate], [*notes, *([taken.note] if taken.note else [])], _GRADES[taken.fate])
