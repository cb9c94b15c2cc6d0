"""Figures of a diagnosis: recording against both simulations, residuals over time and phase plane, evidence, shares."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.show.decimate import keep, reversal_times
from harness.show.diagnosis_scene import AFTER, BEFORE, shaded_spans, shown
from harness.show.report.curves import upright_lines
from harness.show.report.figure import Figure
from harness.show.report.identify import ANGLES, CHANNELS
from harness.show.report.motion import GROUP, zoom_buttons
from harness.show.report.section import Section

POINTS = 9_000
"""Samples of one curve."""
DOTS = 5_000
_MOST_SHADES = 80
_SHADE = "rgba(228, 99, 45, 0.11)"
_NAMES = ("viscous and Coulomb", "refined")
_COLORS = (BEFORE, AFTER)
_ROOM = 0.12
"""Of the width of a bar chart, for the number beside a short bar."""


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
class _Curves(Section):
    """recording, simulated, result : as in diagnosis_sections."""

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
        every = list(zip(_NAMES, _COLORS, self.simulated, strict=True))
        return every if self.result["mechanisms"] else every[:1]

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
        release = float(self.result["refined_model"]["release"].get("t0", 0.0))
        return at[self.recording.t[at] >= release]

    @property
    def times(self) -> FloatArray:
        """Reversals of the better model, s."""
        return reversal_times(self.simulated[-1])

    @property
    def shapes(self) -> list[dict[str, Any]]:
        """Shaded spans and reversals."""
        return _shades(shaded_spans(self.result)) + upright_lines(self.times)


@dataclass(frozen=True)
class Before(_Curves):
    """Every channel as recorded and as both models have it."""

    template: ClassVar[str] = "motion.html.j2"

    @property
    def title(self) -> str:
        """The heading."""
        return "Recording against simulation"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        figures = []
        for name in self.channels:
            label, unit, factor = self.words(name)
            sims = [shown(model, name) for _, _, model in self.models]
            at = self.chosen(self.recording[name], *sims)
            free, t = self.free(at), self.recording.t
            traces = [_curve("recording", t[at], self.recording[name][at] * factor, "ink", unit, 2.4)]
            traces += [
                _curve(said, t[free], y[free] * factor, color, unit)
                for (said, color, _), y in zip(self.models, sims, strict=True)
            ]
            figures.append(
                Figure(f"channel-{name}", traces, _axes(label, unit, self.shapes), self._caption(), GROUP, 320)
            )
        return {
            "figures": figures,
            "buttons": zoom_buttons(self.times.tolist(), self.recording.duration),
            "group": GROUP,
        }

    def _caption(self) -> str:
        if not shaded_spans(self.result):
            return "Fits that look alike here differ below: what counts is the residual against the noise."
        return "Shaded: where simulation and recording part. Dotted: reversals of the refined model."


@dataclass(frozen=True)
class Mismatch(_Curves):
    """Recording minus simulation over time, before and after, with the noise."""

    template: ClassVar[str] = "figures.html.j2"

    @property
    def title(self) -> str:
        """The heading."""
        return "Residual by time"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        figures = []
        for name in self.channels:
            label, unit, factor = self.words(name)
            residuals = [self.residual(model, name) * factor for _, _, model in self.models]
            at = self.free(self.chosen(*residuals))
            t = self.recording.t[at]
            traces = [
                _curve(f"{said}, recording minus simulation", t, r[at], color, unit, 1.2)
                for (said, color, _), r in zip(self.models, residuals, strict=True)
            ]
            shapes = self.shapes
            sigma = self.result["recording"]["noise"].get(name)
            caption = "Recording minus simulation."
            if isinstance(sigma, (int, float)):
                shapes = [*shapes, *_noise_band(2.0 * sigma * factor)]
                level = f"{2.0 * sigma * factor:.3g} {unit}"
                caption = f"Recording minus simulation; dashed: two standard deviations of the noise ({level})."
            figures.append(
                Figure(f"residual-{name}", traces, _axes(f"{label} left over", unit, shapes), caption, GROUP, 260)
            )
        return {"figures": figures}


def _noise_band(level: float) -> list[dict[str, Any]]:
    line = {"color": "muted", "width": 1, "dash": "dash"}
    place = {"type": "line", "x0": 0, "x1": 1, "xref": "paper", "line": line}
    return [place | {"y0": level, "y1": level}, place | {"y0": -level, "y1": -level}]


@dataclass(frozen=True)
class PhasePlane(_Curves):
    """The residual where it happens: along the motion in the plane of position and speed, before and after."""

    template: ClassVar[str] = "figures.html.j2"

    @property
    def title(self) -> str:
        """The heading."""
        return "Residual over the phase plane"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        name = "a" if "a" in self.channels else self.channels[0]
        label, unit, factor = self.words(name)
        position, length, scale = self.words("x")
        speed, per_second, _ = self.words("v")
        best = self.simulated[-1]
        at = self.free(np.linspace(0, len(best) - 1, min(DOTS, len(best))).astype(np.int64))
        residuals = [self.residual(model, name)[at] * factor for _, _, model in self.models]
        # a few samples on the wrong side of a jump would else decide the colours
        limit = max(float(np.percentile(np.abs(residuals[0]), 98.0)), 1e-300)
        traces, layout = [], dict[str, Any]({"showlegend": False, "annotations": []})
        for i, ((said, _, _), residual) in enumerate(zip(self.models, residuals, strict=True)):
            own = "" if i == 0 else str(i + 1)
            low = 0.53 * i
            high = low + (0.47 if len(self.models) > 1 else 1.0)
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
        caption = f"{label[0].upper()}{label[1:]} left over along the motion, in one scale of colours."
        return {"figures": [Figure("plane", traces, layout, caption, "", 430)]}


@dataclass(frozen=True)
class Evidence(Section):
    """result : as in harness.diagnosis/1."""

    template: ClassVar[str] = "figures.html.j2"
    result: Mapping[str, Any]

    @property
    def title(self) -> str:
        """The heading."""
        return "Evidence over the catalogue"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        chosen = {mechanism["name"] for mechanism in self.result["mechanisms"]}
        ordered = sorted(self.result["evidence"], key=lambda one: float(one["delta_bic"]))
        better = [one for one in ordered if one["delta_bic"] > 1.0]
        others = [one["name"] for one in reversed(ordered) if one["delta_bic"] <= 1.0]
        none = f" No better than the base model alone: {', '.join(others)}." if others else ""
        if not better:
            return {
                "figures": [
                    Figure("evidence", [], {}, f"No catalogue name does better than the base model.{none}", "", 40)
                ]
            }
        trace = {
            "type": "bar",
            "orientation": "h",
            "x": [float(one["delta_bic"]) for one in better],
            "y": [one["name"] for one in better],
            "marker": {"color": [AFTER if one["name"] in chosen else "#b9c0c9" for one in better]},
            "text": [f"{one['delta_bic']:.0f}" for one in better],
            "textposition": "auto",
            "hovertemplate": "%{y}: %{x:.5g}<extra></extra>",
        }
        layout = {
            "xaxis": {
                "title": {"text": "better than the base model by, in BIC"},
                "type": "log",
                "range": [0.0, math.log10(1.3 * float(better[-1]["delta_bic"]))],
                "dtick": 1,
            },
            "yaxis": {"ticks": ""},
            "showlegend": False,
            "bargap": 0.35,
        }
        caption = (
            "Each catalogue name tried alone against viscous and Coulomb friction; 10 is decisive. Blue: in the "
            f"refined model. With two effects, a name that explains neither alone can still do well here.{none}"
        )
        return {"figures": [Figure("evidence", [trace], layout, caption, "", 110 + 24 * len(better))]}


@dataclass(frozen=True)
class Shares(Section):
    """attribution : as in harness.diagnosis/1."""

    template: ClassVar[str] = "figures.html.j2"
    attribution: Mapping[str, Any]

    @property
    def title(self) -> str:
        """The heading."""
        return "Whose mismatch it is"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        names = ("engine", "parameters", "missing_physics", "unexplained", "noise")
        labels = ("the engine's own error", "wrong parameters", "missing physics", "unexplained", "noise")
        percent = [100.0 * float(self.attribution[name]) for name in names]
        trace = {
            "type": "bar",
            "orientation": "h",
            "x": percent[::-1],
            "y": list(labels)[::-1],
            "marker": {"color": ["#b9c0c9", "#a45bc2", AFTER, "#b58900", BEFORE]},
            "text": [f"{value:.3g} %" for value in percent[::-1]],
            "textposition": "auto",
            "hovertemplate": "%{y}: %{x:.4g} %<extra></extra>",
        }
        low, high = min(0.0, *percent), max(percent)
        beside = _ROOM * (high - low)
        layout = {
            "xaxis": {
                "title": {"text": "share of the mean square mismatch / %"},
                "zeroline": True,
                "range": [low - (beside if low < 0.0 else 0.0), high + beside],
            },
            "yaxis": {"ticks": ""},
            "showlegend": False,
            "bargap": 0.35,
        }
        caption = (
            f"Compared with the recording: {self.attribution['configuration']}. Steps: engine to exact motion at the "
            "same parameters, to the baseline fit, to the refined model, to noise. Below 0: that step made it worse."
        )
        return {"figures": [Figure("attribution", [trace], layout, caption, "", 260)]}
