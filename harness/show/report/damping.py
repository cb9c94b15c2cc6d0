"""Damping and frequency over amplitude, as damping people draw them: measured with its band, and by models."""

from typing import Any

import numpy as np

from harness.results.common import DampingResult
from harness.show.blocks import Block, Cell, Column, Figure, Folded, Section, tabulated
from harness.show.numbers import number
from harness.show.plots import Trace, axes, dots, plain

_INK, _BAND, _COLORS = "ink", "rgba(128, 136, 148, 0.3)", ("#e4632d", "#2b7fd6", "#1f9e77")
_ERRORS = 2.0
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
        side | {"y": y - _ERRORS * sd},
        side | {"y": y + _ERRORS * sd, "fill": "tonexty", "fillcolor": _BAND},
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
