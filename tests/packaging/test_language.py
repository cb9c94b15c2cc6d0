"""What people read is in the field's own terms: phrases that were retired do not come back, a verdict is short."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
RETIRED = {
    r"\btakes? (?:\S+ ){1,6}off\b": "explains",
    r"\bis no name\b(?!,)": "is not reported",
    r"\basks? for it\b": "is fitted as well",
    r"\b(?:a|the) hand (?:was|had)\b": "release transient",
    r"\bindependent (?:words|strokes)\b": "effective samples, half-cycles",
    r"\bcrowd\b": "unmodelled effects",
    r"\bhangs? on\b": "depends on",
    r"\b(?:is|are|was|were) put in\b": "the true value",
    r"\breads like\b": "effective parameters",
    r"\bsums? up\b": "add up",
    r"\bstands? for\b": "compensates for, in place of",
    r"\b(?:be|not) told\b|\btold (?:weakly|apart)\b": "identifiable",
    r"\b(?:tells?|told|tell) (?:\w+ )?apart\b": "distinguish",
    r"\bstands? beside\b": "compared with",
    r"\bthe others still\b": "the other joints locked",
    r"\bturns? round\b": "reverses",
    r"\b(?:leaves?|left|leaving) out\b": "misses, what is missing; skips, holds out",
    r"\b(?:is|are) accepted\b": "expected ..., or a line to paste",
    r"\bthe main thing\b": "the dominant effect",
}
"""What was retired, as a pattern, and the term of the field in its place."""


def strings(file: Path) -> Iterator[tuple[int, str]]:
    """Every text of a module that is no docstring, with its line."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        for inner in body if isinstance(body, list) else ():
            if isinstance(inner, ast.Expr) and isinstance(inner.value, ast.Constant):
                inner.value.value = ""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value:
            yield node.lineno, node.value


def paragraphs(file: Path) -> Iterator[tuple[int, str]]:
    """A page's text, wrapped lines in one."""
    text, line = file.read_text(encoding="utf-8"), 1
    for part in re.split(r"\n\s*\n", text):
        yield line, " ".join(part.split())
        line += part.count("\n") + 2


def found(texts: Iterator[tuple[int, str]], file: Path) -> list[str]:
    return [
        f"{file.relative_to(CHECKOUT)}:{line}: {match[0]!r}, say {term}"
        for line, text in texts
        for pattern, term in RETIRED.items()
        for match in re.finditer(pattern, text, re.IGNORECASE)
    ]


def test_no_text_of_the_program_has_a_retired_phrase() -> None:
    assert [hit for file in sorted((CHECKOUT / "harness").rglob("*.py")) for hit in found(strings(file), file)] == []


PAGES = [CHECKOUT / "README.md", *sorted((CHECKOUT / "docs").rglob("*.md"))]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_no_page_has_a_retired_phrase(page: Path) -> None:
    assert found(paragraphs(page), page) == []


_VERDICTS = (CHECKOUT / "docs" / "verdicts.md").read_text(encoding="utf-8")
_ENDS = re.compile(r"^(?:[┏┌│╭ ]|- |motion: |\w+ as the |mean absolute|[\w ]+ times, |report: )")


@pytest.mark.parametrize("command", re.findall(r"^\$ (harness diagnose .*)$", _VERDICTS, re.MULTILINE))
def test_a_verdict_is_at_most_two_sentences_and_forty_words(command: str) -> None:
    said: list[str] = []
    for line in _VERDICTS.partition(f"$ {command}\n")[2].splitlines():
        if _ENDS.match(line):
            break
        said.append(line)
    verdict = " ".join(said)
    assert verdict
    assert len(re.findall(r"[.!?](?= [A-Z]|$)", verdict)) <= 2
    assert len(re.findall(r"[A-Za-z]{2,}", verdict)) <= 40
