"""Curves beside a recording: force over what the law that was found depends on, damping and frequency over amplitude.

Damping is drawn as damping people draw it: measured with its band, and by models.
"""

from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.results.common import DampingResult
from harness.results.diagnosis import DiagnosisResult, SeenLawResult
from harness.show.blocks import Block, Cell, Column, Figure, Folded, Items, Section, tabulated
from harness.show.numbers import SHOWN, number, squared
from harness.show.plots import Trace, axes, dots, per, plain
from harness.show.report.diagnosis_figures import model_names
from harness.show.stored import AFTER, BEFORE

_ERRORS = 2.0
"""Standard errors of a bar."""
_OF = {
    "v": ("speed", "friction and damping", "all friction and damping"),
    "x": ("position", "force beyond the spring", "what the refined model's spring is not"),
    "t": ("time", "force", "what acts besides the slider's own forces"),
}
_LEVEL = "level of dry friction"


def law_section(result: DiagnosisResult) -> Section:
    """A plot for each thing that the laws depend on, and what each law says."""
    title = "Friction by speed" if any(law.between for law in result.laws) else "The law"
    return Section(title, [*law_figures(result), *statements(result)])


def statements(result: DiagnosisResult) -> list[Items]:
    """What each law says, where the verdict does not."""
    said = [one.statement for one in result.mechanisms if one.statement not in result.statement]
    return [Items(said)] if said else []


def law_figures(result: DiagnosisResult) -> list[Figure]:
    """A plot for each thing that the laws depend on."""
    return [_figure(i, law, result) for i, law in enumerate(result.laws)]


def _figure(number: int, law: SeenLawResult, result: DiagnosisResult) -> Figure:
    over, label, what = _OF[law.over]
    label, what = (_LEVEL, "the level of dry friction") if law.level else (label, what)
    # as pages have it, a length in mm and a speed in m/s
    unit, factor = SHOWN.get(law.at_unit, (law.at_unit, 1.0)) if law.over == "x" else (law.at_unit, 1.0)
    at, seen = factor * np.array(law.at), np.array(law.seen)
    bars = {"type": "data", "array": _ERRORS * np.array(law.stderr), "thickness": 1.2, "width": 0, "color": "ink"}
    hover = f"%{{y:.4g}} at %{{x:.4g}} {unit}<extra></extra>"
    names, drawn = model_names(result), law.between or law
    along = factor * np.array(drawn.at)
    lines: list[dict[str, Any]] = [
        plain(name, *_broken(along, np.array(y), law.over), color, 2.2, hovertemplate=hover)
        for name, y, color in zip(names, (drawn.base, drawn.fitted), (BEFORE, AFTER), strict=False)
    ]
    points = dots("recording", at, seen, {"color": "ink", "size": 6}, hover, error_y=bars)
    caption = (
        f"Points: {what} as the recording shows it, with two standard errors. Lines: the law that was found, and"
        " viscous and Coulomb friction alone."
    )
    if law.between:
        caption = f"Points: the {len(law.at)} rows of the recording, with two standard deviations of their noise."
    labels = f"{over} / {per(unit)}", f"{label} / {per(squared(law.force_unit))}"
    return Figure(
        f"law-{number}", [*lines, points], axes(*labels, showlegend=True, hovermode="closest"), caption, "", 380
    )


def _broken(at: FloatArray, y: FloatArray, over: str) -> tuple[FloatArray, FloatArray]:
    """A line over speeds has no value where it jumps."""
    turn = int(np.searchsorted(at, 0.0))
    if over != "v" or turn in (0, at.size):
        return at, y
    return np.insert(at, turn, 0.0), np.insert(y, turn, np.nan)


_INK, _BAND, _COLORS = "ink", "rgba(128, 136, 148, 0.3)", ("#e4632d", "#2b7fd6", "#1f9e77")
_BAND_ERRORS = 2.0
"""Standard errors of the band."""


def damping_section(found: DampingResult) -> Section:
    """Two charts over the amplitude, and the table with the loss factor."""
    factor, unit = (1e3, "mm") if found.unit == "m" else (1.0, found.unit)
    figures: list[Block] = [
        _chart(found, "zeta", "zeta_stderr", "damping ratio ζ", factor, unit),
        _chart(found, "frequency_hz", "frequency_stderr", "frequency / Hz", factor, unit),
    ]
    columns = [
        Column("damping ratio", lambda k: _measured(found.zeta[k], found.zeta_stderr[k])),
        Column("loss factor", lambda k: number(2.0 * found.zeta[k], 4), "", "twice the damping ratio"),
        Column("frequency", lambda k: _measured(found.frequency_hz[k], found.frequency_stderr[k]), "Hz"),
    ]
    rows = list(range(len(found.amplitude)))
    table = tabulated(f"amplitude / {unit}", columns, rows, lambda k: number(factor * found.amplitude[k], 4))
    return Section("Damping over amplitude", [*figures, Folded(f"Table: {len(rows)} amplitudes", [table])])


def _measured(value: float, error: float) -> Cell:
    return Cell(number(value, 4), [f"± {number(error, 2)}"])


def _chart(found: DampingResult, of: str, error: str, label: str, factor: float, unit: str) -> Figure:
    """What was measured over the amplitude, its band, and what each model has."""
    order = np.argsort(found.amplitude)
    x, y, sd = (np.array(values)[order] for values in (found.amplitude, getattr(found, of), getattr(found, error)))
    side: dict[str, Any] = {"type": "scatter", "mode": "lines", "x": factor * x, "hoverinfo": "skip"}
    side |= {"showlegend": False, "line": {"width": 0}}
    traces: list[Trace] = [
        side | {"y": y - _BAND_ERRORS * sd},
        side | {"y": y + _BAND_ERRORS * sd, "fill": "tonexty", "fillcolor": _BAND},
        dots("measured", factor * x, y, {"color": _INK, "size": 6}, f"%{{y:.4g}} at %{{x:.4g}} {unit}<extra></extra>"),
    ]
    for (name, law), color in zip(found.laws.items(), _COLORS, strict=False):
        hover = {"hovertemplate": "%{y:.4g}<extra></extra>"}
        traces.append(plain(name, factor * np.array(law["amplitude"]), np.array(law[of]), color, 1.8, **hover))
    caption = (
        "Measured from turning points alone, without a law of friction; shaded: two standard errors. Lines: what the"
        " models have. Viscous damping is level, dry friction rises towards small amplitudes, drag towards large ones."
        if of == "zeta"
        else "From the times between turning points; shaded: two standard errors."
    )
    layout = axes(f"amplitude / {unit}", label, showlegend=True, hovermode="closest")
    layout["xaxis"]["type"] = "log"
    return Figure(f"damping-{of}", traces, layout, caption, "", 340)
