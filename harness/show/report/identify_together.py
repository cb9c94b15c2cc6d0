"""The page and the trace of several recordings of one machine, as the estimators read them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.errors import short_names
from harness.core.recording import Recording
from harness.results.common import P
from harness.results.identify import FailedIdentify, IdentifyResult, RepeatedIdentifyResult
from harness.show import scene as s
from harness.show.blocks import Column, Figure, Page, Reasons, Section, Table, by, measured, tabulated, verdict
from harness.show.numbers import quantity
from harness.show.plots import axes, dots, per
from harness.show.report.identify import channel_figures, methods_section
from harness.show.report.page import made_with, symbols
from harness.show.report.repeated import repeated_table

_COLOR = "#2b7fd6"
_METRES = 1e3
"""Of a number shown in mm."""


def repeated_page(result: RepeatedIdentifyResult) -> Page:
    """A row and a point a recording, and what they say together."""
    names = short_names([one.recording.file for one in result.recordings])
    methods = [methods_section(result.estimates)] if result.estimates else []
    figures = [_by_recording(name, found) for name, found in _numbers(result).items()]
    tables = [repeated_table(result.together, "Each recording by itself.")] if result.together else []
    sections = [
        verdict(result.statement, result.warnings),
        *methods,
        Section("Recordings", [_recordings(result, names), *figures]),
        *([Section("What they say together", tables)] if tables else []),
        made_with(result.machine, result.files, result.command),
    ]
    return Page(f"Friction and damping from {len(result.found)} recordings", ", ".join(names.values()), sections)


def _numbers(result: RepeatedIdentifyResult) -> dict[str, dict[str, P]]:
    """What the method of the statement reads: by number, the value of each recording that tells it."""
    names = short_names([one.recording.file for one in result.recordings])
    found: dict[str, dict[str, P]] = {}
    for one in result.found:
        for name, p in one.numbers(result.method).items():
            if p.value is not None:
                found.setdefault(name, {})[names[one.recording.file]] = p
    return found


def _recordings(result: RepeatedIdentifyResult, names: Mapping[str, str]) -> Table:
    """A row a recording: its numbers by the method of the statement, and how well the base model fits."""
    reasons, columns = Reasons(), list[Column]()
    for name, of in _numbers(result).items():
        unit = quantity(next(iter(of.values())))[2]
        columns.append(Column(name, by(name, lambda one, name: _cell(one, result.method, name, reasons)), unit))
    columns.append(Column("chi-square", _chi2, "a point", "of viscous and Coulomb friction; 1 is the noise"))
    return tabulated(
        "recording", columns, result.recordings, lambda one: names[one.recording.file],
        lambda one: one.error if isinstance(one, FailedIdentify) else "",
        caption=f"By method {result.method}; below each value: one standard error.", reasons=reasons,
    )  # fmt: skip


def _cell(one: IdentifyResult | FailedIdentify, method: str, name: str, reasons: Reasons) -> Any:
    return measured(None if isinstance(one, FailedIdentify) else one.numbers(method).get(name), reasons)


def _chi2(one: IdentifyResult | FailedIdentify) -> float | None:
    fitted = None if isinstance(one, FailedIdentify) else one.baseline
    return None if fitted is None else fitted.chi2_per_point


def _by_recording(name: str, found: Mapping[str, P]) -> Figure:
    """A number as each recording gives it, with its standard error."""
    unit = quantity(next(iter(found.values())))[2]
    factor = _METRES if unit == "mm" else 1.0
    y = np.array([p.value for p in found.values()], dtype=np.float64) * factor
    errors = np.array([p.stderr or 0.0 for p in found.values()]) * factor
    bars = {"error_y": {"type": "data", "array": errors, "color": _COLOR, "thickness": 1.2, "width": 3}}
    points = dots(name, list(found), y, {"color": _COLOR, "size": 7}, f"%{{y:.6g}} {unit}<extra></extra>", **bars)
    said = str(symbols(name))
    layout = axes("recording", f"{said} / {per(unit)}" if unit else said, showlegend=False)
    return Figure(f"recordings-{name}", [points], layout, "Bars are one standard error.", "", 260)


def repeated_scene(result: RepeatedIdentifyResult, recordings: Sequence[Recording]) -> s.Scene:
    """A tab of channels a recording, and what was read beside it.

    recordings : those from which something was estimated, in their order.
    """
    names = short_names([one.file for one in recordings])
    tabs = []
    for recording, one in zip(recordings, result.found, strict=True):
        name = names[recording.file]
        figures = [replace(figure, name=f"{name} {figure.name}") for figure in channel_figures(recording, one)]
        tabs.append(s.Rows(figures, name=name))
    notes = s.notes_of("What was read", [result.statement, *result.warnings])
    layout = s.Columns([s.Tabs(tabs), s.Words("notes", notes)], [3.0, 2.0])
    return s.of_result(", ".join(names.values()), layout, result, notes, {"recording": list(recordings)})
