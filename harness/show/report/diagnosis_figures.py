"""Figures of a diagnosis: recording against both simulations, residuals over time and phase plane."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.show.decimate import keep, reversal_times
from harness.show.diagnosis_scene import (
    AFTER,
    BEFORE,
    YOUR_SIMULATION,
    YOURS,
    begins,
    model_names,
    shaded_spans,
    shown,
    yours,
)
from harness.show.report.identify import ANGLES, CHANNELS
from harness.show.report.motion import GROUP, noise_band, upright_lines, zoom_buttons
from harness.show.report.section import Figure, Section

POINTS = 9_000
"""Samples of one curve."""
DOTS = 5_000
_MOST_SHADES = 80
_SHADE = "rgba(228, 99, 45, 0.11)"
_COLORS = (BEFORE, AFTER)


def _curve(name: str, t: FloatArray, y: FloatArray, color: str, unit: str, width: float = 1.5) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": t,
        "y": y,
        "line": {"color": color, "width": width},
        "marker": {"size": 4},
        "hovertemplate": f"%{{y:.6g}} {unit}<br>%{{x:.6f}} s",
        "meta": {"curve": True},
    }


def _shades(spans: Sequence[Sequence[float]]) -> list[dict[str, Any]]:
    """Bands behind a plot over these spans of time, s."""
    line = {"width": 0}
    place = {"type": "rect", "y0": 0, "y1": 1, "yref": "paper", "layer": "below"}
    return [place | {"x0": low, "x1": high, "fillcolor": _SHADE, "line": line} for low, high in spans[:_MOST_SHADES]]


def _axes(label: str, unit: str, shapes: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "xaxis": {"title": {"text": "time / s"}},
        "yaxis": {"title": {"text": f"{label} / {f'({unit})' if '/' in unit else unit}"}},
        "shapes": shapes,
        "showlegend": True,
        "hovermode": "closest",
    }


@dataclass(frozen=True)
class Curves:
    """What the figures of a diagnosis show. recording, simulated, result : as in diagnosis_sections."""

    recording: Recording
    simulated: Sequence[Trajectory]
    result: Mapping[str, Any]

    @property
    def channels(self) -> list[str]:
        """Those that both have."""
        return [
            name for name in ("x", "v", "a") if name in self.recording and f"shown {name}" in self.simulated[0].extra
        ]

    @property
    def models(self) -> list[tuple[str, str, Trajectory]]:
        """Name, colour and motion of each model; one when nothing was left out."""
        return list(zip(model_names(self.result), _COLORS, self.simulated, strict=False))

    @property
    def best(self) -> Trajectory:
        """The better model's motion."""
        return self.simulated[:2][-1]

    def words(self, name: str) -> tuple[str, str, float]:
        """Label, unit and factor of a channel."""
        return (ANGLES if self.recording.angular else CHANNELS)[name]

    def residual(self, model: Trajectory, name: str) -> FloatArray:
        """Recording minus simulation."""
        return self.recording[name] - shown(model, name)

    def chosen(self, *channels: FloatArray) -> IntArray:
        """Samples to draw."""
        return keep(self.recording.t, channels, self.times, POINTS)

    def free(self, at: IntArray) -> IntArray:
        """Those samples in which the models move: before their release nothing of them is to be seen."""
        return at[self.recording.t[at] >= begins(self.result)]

    @property
    def times(self) -> FloatArray:
        """Reversals of the better model, s."""
        return reversal_times(self.best)

    @property
    def shapes(self) -> list[dict[str, Any]]:
        """Shaded spans and reversals."""
        return _shades(shaded_spans(self.result)) + upright_lines(self.times)


def before_section(seen: Curves) -> Section:
    """Every channel as recorded and as both models have it."""
    figures = []
    for name in seen.channels:
        label, unit, factor = seen.words(name)
        sims = [shown(model, name) for _, _, model in seen.models]
        at = seen.chosen(seen.recording[name], *sims)
        free, t = seen.free(at), seen.recording.t
        traces = [_curve("recording", t[at], seen.recording[name][at] * factor, "ink", unit, 2.4)]
        traces += [
            _curve(said, t[free], y[free] * factor, color, unit)
            for (said, color, _), y in zip(seen.models, sims, strict=True)
        ]
        own = yours(seen.simulated)
        if own is not None and f"shown {name}" in own.extra:
            y = shown(own, name)
            at = keep(own.t, [y], seen.times, POINTS)
            traces.append(_curve(YOUR_SIMULATION, own.t[at], y[at] * factor, YOURS, unit))
        figures.append(
            Figure(f"channel-{name}", traces, _axes(label, unit, seen.shapes), _caption(seen.result), GROUP, 320)
        )
    return Section(
        "Recording against simulation",
        "motion.html.j2",
        {
            "figures": figures,
            "buttons": zoom_buttons(seen.times.tolist(), seen.recording.duration),
            "group": GROUP,
        },
    )


def _caption(result: Mapping[str, Any]) -> str:
    if not shaded_spans(result):
        return "Fits that look alike here differ below: what counts is the residual against the noise."
    return "Shaded: where simulation and recording part. Dotted: reversals of the better model."


def mismatch_section(seen: Curves) -> Section:
    """Recording minus simulation over time, before and after, with the noise."""
    figures = []
    for name in seen.channels:
        label, unit, factor = seen.words(name)
        residuals = [seen.residual(model, name) * factor for _, _, model in seen.models]
        at = seen.free(seen.chosen(*residuals))
        t = seen.recording.t[at]
        traces = [
            _curve(f"{said}", t, r[at], color, unit, 1.2)
            for (said, color, _), r in zip(seen.models, residuals, strict=True)
        ]
        shapes = seen.shapes
        sigma = seen.result["recording"]["noise"].get(name)
        caption = "Recording minus simulation."
        if isinstance(sigma, (int, float)):
            shapes = [*shapes, *noise_band(2.0 * sigma * factor)]
            level = f"{2.0 * sigma * factor:.3g} {unit}"
            caption = f"Recording minus simulation; dashed: two standard deviations of the noise ({level})."
        figures.append(
            Figure(f"residual-{name}", traces, _axes(f"residual of {label}", unit, shapes), caption, GROUP, 260)
        )
    return Section("Residual by time", "figures.html.j2", {"figures": figures})


def phase_plane_section(seen: Curves) -> Section:
    """The residual where it happens: along the motion in the plane of position and speed, before and after."""
    name = "a" if "a" in seen.channels else seen.channels[0]
    label, unit, factor = seen.words(name)
    position, length, scale = seen.words("x")
    speed, per_second, _ = seen.words("v")
    best = seen.best
    at = seen.free(np.linspace(0, len(best) - 1, min(DOTS, len(best))).astype(np.int64))
    residuals = [seen.residual(model, name)[at] * factor for _, _, model in seen.models]
    # a few samples on the wrong side of a jump would else decide the colours
    limit = max(float(np.percentile(np.abs(residuals[0]), 98.0)), 1e-300)
    traces, layout = [], dict[str, Any]({"showlegend": False, "annotations": []})
    for i, ((said, _, _), residual) in enumerate(zip(seen.models, residuals, strict=True)):
        own = "" if i == 0 else str(i + 1)
        low = 0.53 * i
        high = low + (0.47 if len(seen.models) > 1 else 1.0)
        marker = {
            "size": 5,
            "color": residual,
            "colorscale": [[0.0, "#2b7fd6"], [0.5, "#c9ccd1"], [1.0, "#e4632d"]],
            "cmin": -limit,
            "cmax": limit,
            "showscale": i == 0,
            "colorbar": {"title": {"text": unit}, "thickness": 12, "outlinewidth": 0},
        }
        traces.append(
            {
                "type": "scatter",
                "mode": "markers",
                "name": said,
                "x": best.x[at] * scale,
                "y": best.v[at],
                "xaxis": f"x{own}",
                "yaxis": f"y{own}",
                "marker": marker,
                "text": [f"{value:.4g} {unit}" for value in residual.tolist()],
                "hovertemplate": f"%{{x:.5g}} {length}, %{{y:.5g}} {per_second}<br>%{{text}}<extra></extra>",
                "meta": {"curve": False},
            }
        )
        layout[f"xaxis{own}"] = {"title": {"text": f"{position} / {length}"}, "domain": [low, high]}
        layout[f"yaxis{own}"] = {"title": {"text": f"{speed} / ({per_second})"}, "anchor": f"x{own}"}
        place = {"xref": "paper", "yref": "paper", "x": low, "y": 1.0, "xanchor": "left", "yanchor": "bottom"}
        layout["annotations"].append({"text": said, "showarrow": False, **place})
    caption = f"Residual of {label} along the motion, in one scale of colours."
    return Section(
        "Residual over the phase plane",
        "figures.html.j2",
        {"figures": [Figure("plane", traces, layout, caption, "", 430)]},
    )


_COLOR, _BAND = "#e4632d", "rgba(228, 99, 45, 0.18)"
_ERRORS = 2.0
"""Standard errors of a band."""


def tables_section(result: Mapping[str, Any]) -> Section:
    """What has no name, as curves. result : as in harness.diagnosis/2, with tables."""
    figures = [_figure(i, table) for i, table in enumerate(result["tables"])]
    if (surface := result.get("surface")) is not None:
        figures.append(_plane(surface))
    return Section("Force without a name", "figures.html.j2", {"figures": figures})


def _figure(number: int, table: Mapping[str, Any]) -> Figure:
    at, force, stderr = (np.array(table[key]) for key in ("at", "force", "stderr"))
    label = {"x": "displacement", "v": "speed", "|v|": "speed, either way"}[table["of"]]
    at_unit, unit = _unit(table["at_unit"]), _unit(table["force_unit"])
    plain: dict[str, Any] = {"type": "scatter", "mode": "lines", "x": at, "hoverinfo": "skip", "showlegend": False}
    line = {"width": 0}
    traces = [
        {**plain, "y": force - _ERRORS * stderr, "line": line},
        {**plain, "y": force + _ERRORS * stderr, "line": line, "fill": "tonexty", "fillcolor": _BAND},
        {
            "type": "scatter",
            "mode": "lines",
            "name": table["form"],
            "x": at,
            "y": force,
            "line": {"color": _COLOR, "width": 2},
            "hovertemplate": "%{x:.4g}: %{y:.4g}<extra></extra>",
        },
    ]
    layout = {
        "xaxis": {"title": {"text": f"{label} / {at_unit}"}},
        "yaxis": {"title": {"text": f"{table['form']} / {unit}"}},
        "showlegend": False,
        "hovermode": "closest",
    }
    near = ", ".join(f"{one['name']} ({100.0 * one['share']:.0f} % of it)" for one in table["nearest"])
    said = table["described"]
    caption = (
        f"{said[:1].upper()}{said[1:]}. On the left of the equation of motion, with two standard errors, over the "
        f"range that was swept; beyond it nothing is known. The table holds {table['gauge']}."
        f"{f' Nearest in the catalogue: {near}.' if near else ''}"
    )
    return Figure(f"table-{number}", traces, layout, caption, height=320)


def _plane(surface: Mapping[str, Any]) -> Figure:
    """A force over both: coloured where the motion was, its error below the pointer."""
    force, stderr = (np.array(surface[key], dtype=np.float64) for key in ("force", "stderr"))
    x_unit, v_unit, unit = (_unit(surface[key]) for key in ("x_unit", "v_unit", "force_unit"))
    most = float(np.nanmax(np.abs(force)))
    trace = {
        "type": "heatmap",
        "x": np.array(surface["x"]),
        "y": np.array(surface["v"]),
        "z": surface["force"],
        "customdata": surface["stderr"],
        "zmin": -most,
        "zmax": most,
        "colorscale": [[0.0, "#2f6fb0"], [0.5, "#f4f1ea"], [1.0, _COLOR]],
        "hoverongaps": False,
        "colorbar": {"title": {"text": unit}},
        "hovertemplate": "%{x:.4g}, %{y:.4g}: %{z:.3g} \u00b1 %{customdata:.2g}<extra></extra>",
    }
    layout = {
        "xaxis": {"title": {"text": f"displacement / {x_unit}"}},
        "yaxis": {"title": {"text": f"speed / {v_unit}"}},
        "hovermode": "closest",
    }
    said, error = surface["described"], float(np.nanmedian(stderr))
    caption = (
        f"{said[:1].upper()}{said[1:]}. On the left of the equation of motion; one standard error is {error:.2g} {unit}"
        " in the middle, and stands below the pointer. Blank where the motion never was: there nothing is known. The"
        f" table holds {surface['gauge']}."
    )
    return Figure("table-plane", [trace], layout, caption, height=420)


def _unit(unit: str) -> str:
    return f"({unit})" if "/" in unit or " " in unit else unit
