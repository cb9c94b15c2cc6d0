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
from harness.show.report.curves import noise_band, upright_lines
from harness.show.report.figure import Figure
from harness.show.report.identify import ANGLES, CHANNELS
from harness.show.report.motion import GROUP, zoom_buttons
from harness.show.report.section import Section

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
