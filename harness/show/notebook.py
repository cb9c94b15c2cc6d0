"""A result in a notebook or a console: its page, its verdict and numbers as text, its numbers as a table."""

from collections.abc import Iterator, Mapping
from html import escape
from importlib import import_module
from pathlib import Path
from typing import Any

from harness.core.errors import InputError
from harness.results.common import P, Paged, Result
from harness.show.numbers import number, sentence_quantity
from harness.show.plotting import page_of
from harness.show.report.page import render, whole

_LOOKS = "width:100%;height:min(85vh,900px);border:0;background:white"
_NAMES = ("label", "name", "what", "file", "joint")
"""Fields by which one of several is known, the first that it has."""
_SAID = ("statement", "conclusions", "sentences", "shortfalls", "wrong", "warnings")
"""Fields that say what came out, in order."""
_MOST_LINES = 24


def html(result: Paged) -> str:
    """The page in a frame of its own; the text where neither the motion nor the written page is there any more."""
    page = page_of(result)
    if page is not None:
        shown = render(page)
    else:
        files: Mapping[str, str] = getattr(result, "files", None) or getattr(result, "outputs", {})
        report = Path(files.get("report", ""))
        if not report.is_file():
            return f"<pre>{escape(text(result))}</pre>"
        shown = whole(report).decode("utf-8")
    # a document inside the document: neither's style or script reaches the other
    return f'<iframe title="report" srcdoc="{escape(shown)}" style="{_LOOKS}"></iframe>'


def text(result: Paged) -> str:
    """What it says in sentences, then every number with its error and unit, or its rows, a line each."""
    found = next((said for name in _SAID if (said := getattr(result, name, None))), None)
    said = [found] if isinstance(found, str) else list(found or [])
    if result.LINES:
        lines = [", ".join(f"{k} {v}" for k, v in row.items()) for row in map(_short, _lines(result))]
    else:
        lines = [f"{'.'.join(way)} = {sentence_quantity(p)}" for way, p in _numbers(result, ()) if p.value is not None]
    more = [f"... and {len(lines) - _MOST_LINES} more: to_frame()"] if len(lines) > _MOST_LINES else []
    return "\n".join([*said, *lines[:_MOST_LINES], *more]) or type(result).__name__


def frame(result: Paged) -> Any:
    """Every number with its error and unit as a pandas.DataFrame, a row each; of a table its own rows.

    Rows of numbers go by "part" ("baseline", "refined", "mechanisms.quadratic-drag", "estimates.displacement") and
    "quantity"; columns are value, stderr, systematic, unit, and why a value or an error is missing. Raises InputError
    without pandas.
    """
    try:
        pandas = import_module("pandas")
    except ImportError:
        raise InputError("to_frame", "pandas is not installed", "try: pip install pandas") from None
    if result.LINES:
        return pandas.json_normalize(_lines(result))
    rows = list(_numbers(result, ()))
    places = [(".".join(way[:-1]), way[-1]) for way, _ in rows]
    index = pandas.MultiIndex.from_tuples(places, names=["part", "quantity"])
    columns = {name: [getattr(p, name) for _, p in rows] for name in ("value", "stderr", "systematic", "unit", "why")}
    return pandas.DataFrame(columns, index=index).astype({"value": float, "stderr": float, "systematic": float})


def _lines(result: Paged) -> list[dict[str, Any]]:
    return [row.model_dump(mode="json") for row in getattr(result, result.LINES)]


def _short(row: Mapping[str, Any]) -> dict[str, str]:
    """What of a row is a name or a number."""
    plain = {k: number(v) if isinstance(v, float) else v for k, v in row.items() if v not in (None, "")}
    return {k: str(v) for k, v in plain.items() if isinstance(v, str | int)}


def _numbers(value: object, way: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], P]]:
    """Every number below a value, with the names on the way to it; "parameters" says nothing, and is left out."""
    if isinstance(value, P):
        yield way, value
    elif isinstance(value, Result):
        for name in type(value).model_fields:
            yield from _numbers(getattr(value, name), way if name == "parameters" else (*way, name))
    elif isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _numbers(inner, (*way, str(name)))
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            known = (str(getattr(inner, name)) for name in _NAMES if hasattr(inner, name))
            yield from _numbers(inner, (*way, next(known, str(place + 1))))
