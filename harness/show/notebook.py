"""A result in a notebook: its page, and its numbers as a table."""

from collections.abc import Iterator, Mapping
from html import escape
from importlib import import_module
from pathlib import Path
from typing import Any

from harness.core.errors import InputError
from harness.results.common import P, Paged, Result
from harness.show.report.page import render, whole

_LOOKS = "width:100%;height:min(85vh,900px);border:0;background:white"
_NAMES = ("name", "what", "file", "joint")
"""Fields by which one of several is known, the first that it has."""


def html(result: Paged) -> str | None:
    """The page in a frame of its own; None where neither the motion nor the written page is there any more."""
    page = result._drawing.page
    if page is None:
        files: Mapping[str, str] = getattr(result, "files", None) or getattr(result, "outputs", {})
        report = Path(files.get("report", ""))
        page = whole(report).decode("utf-8") if report.is_file() else None
    if page is None:
        return None
    text = page if isinstance(page, str) else render(page(result))
    # a document inside the document: neither's style or script reaches the other
    return f'<iframe title="report" srcdoc="{escape(text)}" style="{_LOOKS}"></iframe>'


def frame(result: Result) -> Any:
    """Every number with its error and unit as a pandas.DataFrame, a row each.

    Rows go by "part" ("baseline", "refined", "mechanisms.quadratic-drag", "estimates.displacement") and "quantity";
    columns are value, stderr, unit, and why a value or an error is missing. Raises InputError without pandas.
    """
    try:
        pandas = import_module("pandas")
    except ImportError:
        raise InputError("to_frame", "pandas is not installed", "try: pip install pandas") from None
    rows = list(_numbers(result, ()))
    places = [(".".join(way[:-1]), way[-1]) for way, _ in rows]
    index = pandas.MultiIndex.from_tuples(places, names=["part", "quantity"])
    columns = {name: [getattr(p, name) for _, p in rows] for name in ("value", "stderr", "unit", "why")}
    return pandas.DataFrame(columns, index=index).astype({"value": float, "stderr": float})


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
