"""What is made of a finished sweep: result.json, a table for people."""

from collections.abc import Mapping
from typing import Any

from harness.app.progress import SILENT, Progress
from harness.app.sweep import Sweep, write_result
from harness.fidelity.scores import LABELS, cards

HEADS = ("engine", "route", "settings", *LABELS)


def finish(result: Sweep, keep: int, progress: Progress = SILENT) -> None:
    """Write result.json."""
    progress("writing result.json", result.total, result.total)
    write_result(result)


def summary(result: Sweep) -> tuple[tuple[str, ...], list[list[str]]]:
    """Heads and lines of the table: what ships and what is tuned, by engine and route."""
    lines = []
    for card in cards(result.rows()):
        values = [_number(card.values.get(label)) for label in LABELS]
        lines.append([card.engine, card.route, card.preset, *values])
    return HEADS, lines


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"


Row = Mapping[str, Any]
