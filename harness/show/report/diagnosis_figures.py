"""Figures of a diagnosis: recording against simulations, residuals, what each name takes off, whose mismatch it is."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.recording import Recording
from harness.core.trajectory import Trajectory
from harness.results.diagnosis import AttributionResult, DiagnosisResult, SurfaceResult, TableResult
from harness.show.blocks import Block, Column, Figure, Folded, Section, Text, tabulated
from harness.show.numbers import NONE, number
from harness.show.plots import (
    ANGLES,
    CHANNELS,
    GROUP,
    axes,
    bars,
    curve,
    dots,
    left_by,
    orbit,
    per,
    plain,
    reversal_times,
    shades,
    upright_lines,
    zoom,
)
from harness.show.stored import AFTER, BEFORE

YOURS = "#1f9e77"
YOUR_SIMULATION = "your simulation"
_MOST_OF_IT = 0.9
"""A place that covers more of the recording than this says nothing on where."""
DOTS = 5_000
_SHADE = "rgba(228, 99, 45, 0.11)"
_COLORS = (BEFORE, AFTER)
_GREY, _OCHRE = "#b9c0c9", "#b58900"
_ROOM = 0.12
"""Of the width of a bar chart, for the number beside a short bar."""
_BAND = "rgba(228, 99, 45, 0.18)"
_ERRORS = 2.0
"""Standard errors of a band."""
_DEPENDS = {
    "x": "position",
    "v": "speed",
    "t": "time",
    "direction": "direction of motion",
    "amplitude": "amplitude",
}
_PARTS = {
    "engine": BEFORE,
    "parameters": _OCHRE,
    "missing_physics": AFTER,
    "unexplained": "#a45bc2",
    "noise": _GREY,
}
"""Parts of a mismatch, by name, with their colours."""


def shown(simulated: Trajectory, channel: str) -> FloatArray:
    """A channel as the sensors of a simulation show it, (n,)."""
    return simulated.extra[f"shown {channel}"]


def yours(simulated: Sequence[Trajectory]) -> Trajectory | None:
    """The user's own simulation behind both models, where there is one; its times are those it reaches."""
    return simulated[2] if len(simulated) > 2 else None


def model_names(result: DiagnosisResult) -> list[str]:
    """What both models are called; one when nothing was found that helps."""
    base, mechanisms = "viscous and Coulomb", result.mechanisms
    if not mechanisms:
        return [base]
    return [base, "refined" if mechanisms[0].grade == "explains" else f"with {best_terms(result)}"]


def best_terms(result: DiagnosisResult) -> str:
    """Catalogue names of the best model found."""
    return " and ".join(dict.fromkeys(term.name for term in result.refined_model.terms))


def shaded_spans(result: DiagnosisResult) -> list[list[float]]:
    """Where simulation and recording part, s: the places found, else those of the effects; none for the whole of it."""
    found = [*result.where, *(mechanism.where for mechanism in result.mechanisms)]
    places = [place.time_s for place in found if place.regime != "throughout"]
    for spans in places:
        covered = sum(high - low for low, high in spans)
        if spans and covered < _MOST_OF_IT * result.recording.duration_s:
            return [list(span) for span in spans]
    return []


@dataclass(frozen=True)
class Curves:
    """What is drawn over time. recording, simulated, result : as in diagnosis_page."""

    recording: Recording
    simulated: Sequence[Trajectory]
    result: DiagnosisResult

    @property
    def channels(self) -> list[str]:
        """Those that both have."""
        return [c for c in ("x", "v", "a", "u") if c in self.recording and f"shown {c}" in self.simulated[0].extra]

    @property
    def models(self) -> list[tuple[str, str, Trajectory]]:
        """Name, colour and motion of each model; one when nothing was left out."""
        return list(zip(model_names(self.result), _COLORS, self.simulated, strict=False))

    @property
    def best(self) -> Trajectory:
        """The better model's motion."""
        return self.simulated[:2][-1]

    @property
    def times(self) -> FloatArray:
        """Reversals of the better model, s."""
        return reversal_times(self.best)

    def words(self, name: str) -> tuple[str, str, float]:
        """Label, unit and factor of a channel."""
        return (ANGLES if self.recording.angular else CHANNELS)[name]

    def residual(self, model: Trajectory, name: str) -> FloatArray:
        """Recording minus simulation."""
        return self.recording[name] - shown(model, name)

    @cached_property
    def free(self) -> BoolArray:
        """The samples in which the models move: before their release nothing of them is to be seen."""
        return np.asarray(self.recording.t >= self.result.refined_model.release.t0)

    @cached_property
    def t(self) -> FloatArray:
        """Times of those, s."""
        return self.recording.t[self.free]

    def layout(self, label: str, unit: str, more: Sequence[dict[str, Any]] = ()) -> dict[str, Any]:
        """Axes over time, with shaded spans, reversals and more shapes; over the speeds that were held."""
        if self.recording.steady:
            speed, by, _ = self.words("v")
            return axes(f"{speed} / {per(by)}", f"{label} / {per(unit)}", shapes=list(more), showlegend=True)
        shapes = shades(shaded_spans(self.result), _SHADE) + upright_lines(self.times) + list(more)
        return axes("time / s", f"{label} / {per(unit)}", shapes=shapes, showlegend=True, hovermode="closest")

    def over_time(self) -> list[Figure]:
        """Every channel as recorded and as both models have it."""
        t, own, figures = self.recording.t, yours(self.simulated), []
        caption = "Shaded: where simulation and recording differ. Dotted: reversals of the better model."
        if not shaded_spans(self.result):
            caption = "Fits that look alike here differ below: what counts is the residual against the noise."
        for c in self.channels:
            label, unit, factor = self.words(c)
            traces = [curve("recording", t, self.recording[c] * factor, "ink", unit, 2.4)]
            for said, color, model in self.models:
                traces.append(curve(said, t[self.free], shown(model, c)[self.free] * factor, color, unit))
            if own is not None and f"shown {c}" in own.extra:
                traces.append(curve(YOUR_SIMULATION, own.t, shown(own, c) * factor, YOURS, unit))
            figures.append(Figure(f"channel-{c}", traces, self.layout(label, unit), caption, GROUP, 320, self.times))
        return figures

    def residual_section(self) -> Section:
        """What both models leave, with a bar of zooms."""
        if self.recording.steady:
            return Section("Residual by speed", self.residuals())
        ends = self.result.motion is not None and self.result.motion.kind == "run-down"
        bar: list[Block] = [zoom(self.times.tolist(), self.recording.duration, "the stop" if ends else "a reversal")]
        return Section("Residual, before and after" if len(self.models) > 1 else "Residual", [*bar, *self.residuals()])

    def residuals(self) -> list[Figure]:
        """Recording minus simulation over time, before and after, with the noise."""
        figures = []
        for c in self.channels:
            _, unit, factor = self.words(c)
            traces = []
            for said, color, model in self.models:
                y = self.residual(model, c)[self.free] * factor
                if self.recording.steady:
                    hover = f"%{{y:.4g}} {unit} at %{{x:.4g}} {self.words('v')[1]}<extra></extra>"
                    traces.append(dots(said, self.recording["v"], y, {"color": color, "size": 6}, hover))
                else:
                    traces.append(curve(said, self.t, y, color, unit, 1.2))
            noise = self.result.recording.noise
            caption, band = left_by("simulation", noise.get(c), unit, factor)
            if c != "u" and noise.get("u") is not None:
                caption += " The force was fitted, not this: the noise of the force adds up in each window."
            elif c != "u" and "u" in noise:
                caption += " Noise of the force, where it has any, adds up beside that and is no misfit."
            layout = self.layout(f"residual of {c}", unit, band)
            figures.append(Figure(f"residual-{c}", traces, layout, caption, GROUP, 260, self.times))
        return figures

    def orbit(self) -> Figure:
        """Speed over position of the better model."""
        (place, unit, factor), (speed, by, _), best = self.words("x"), self.words("v"), self.best
        line = curve(self.models[-1][0] if len(self.models) > 1 else "simulation", best.t, best.v, AFTER)
        layout = axes(f"{place} / {unit}", f"{speed} / ({by})")
        moves = self.free
        traces = [orbit(line, best.t[moves], best.x[moves] * factor, best.v[moves])]
        return Figure("motion", traces, layout, around=self.times)

    def phase_plane(self, places: Sequence[str]) -> Section:
        """The residual where it happens: along the motion in the plane of position and speed, before and after.

        places : where that is, in sentences.
        """
        name = "a" if "a" in self.channels else self.channels[0]
        label, unit, factor = self.words(name)
        (position, length, scale), (speed, by, _) = self.words("x"), self.words("v")
        best = self.best
        moves = np.flatnonzero(self.free)
        at = moves[np.linspace(0, moves.size - 1, min(DOTS, moves.size)).astype(np.int64)]
        residuals = [self.residual(model, name)[at] * factor for _, _, model in self.models]
        # a few samples on the wrong side of a jump would else decide the colours
        limit = max(float(np.percentile(np.abs(residuals[0]), 98.0)), 1e-300)
        traces, layout = [], dict[str, Any]({"showlegend": False, "annotations": []})
        for i, ((said, _, _), residual) in enumerate(zip(self.models, residuals, strict=True)):
            own = "" if i == 0 else str(i + 1)
            low = 0.515 * i
            high = low + (0.485 if len(self.models) > 1 else 1.0)
            marker = {
                "size": 5,
                "color": residual,
                "colorscale": [[0.0, "#2b7fd6"], [0.5, "middle"], [1.0, "#e4632d"]],
                "cmin": -limit,
                "cmax": limit,
                "showscale": i == 0,
                "colorbar": {"title": {"text": unit}, "thickness": 12, "outlinewidth": 0},
            }
            text = [f"{value:.4g} {unit}" for value in residual.tolist()]
            hover = f"%{{x:.5g}} {length}, %{{y:.5g}} {by}<br>%{{text}}<extra></extra>"
            where = {"xaxis": f"x{own}", "yaxis": f"y{own}", "meta": {"curve": False}}
            traces.append(dots(said, best.x[at] * scale, best.v[at], marker, hover, text=text, **where))
            layout[f"xaxis{own}"] = {"title": {"text": f"{position} / {length}"}, "domain": [low, high]}
            # both have one scale, which stands on the left
            side = {"title": {"text": f"{speed} / ({by})"}} if i == 0 else {"matches": "y", "showticklabels": False}
            layout[f"yaxis{own}"] = {"anchor": f"x{own}", **side}
            place = {"xref": "paper", "yref": "paper", "x": low, "y": 1.0, "xanchor": "left", "yanchor": "bottom"}
            layout["annotations"].append({"text": said, "showarrow": False, **place})
        caption = f"Residual of {label} along the motion, in one scale of colours."
        title = "Where it acts" if len(self.models) > 1 else "Where the residual is"
        return Section(title, [Figure("plane", traces, layout, " ".join([caption, *places]), "", 430)])


_LEAST_PERCENT = 1.0
"""Probability below which hypotheses are not given one by one."""
_UNIDENTIFIED = "An effect too weak, or too unlike its law, to identify could have any of the names."


def probabilities(result: DiagnosisResult) -> Figure:
    """What may be missing, and how likely that is."""
    none = {"adequate": "nothing", "unexplained": "no single name"}.get(result.verdict, "none of these")
    labels = [" and ".join(one.names) or none for one in result.posterior]
    chosen = {mechanism.name for mechanism in result.mechanisms}
    colors = [AFTER if chosen.intersection(one.names) else _GREY for one in result.posterior]
    percent = [100.0 * one.probability for one in result.posterior]
    rest = 100.0 - sum(percent)
    if rest >= _LEAST_PERCENT:
        labels, colors, percent = (
            [*labels, f"others, each below {_LEAST_PERCENT:g} %"],
            [*colors, _GREY],
            [*percent, rest],
        )
    caption = _UNIDENTIFIED if result.verdict in ("adequate", "unexplained") else ""
    return _percents("posterior", labels, percent, colors, "probability that it is missing / %", caption)


def nameless(result: DiagnosisResult) -> Section:
    """What has no name, as curves and as a plane."""
    figures = [_curve(i, table) for i, table in enumerate(result.tables)]
    if result.surface is not None:
        figures.append(_plane(result.surface))
    return Section("Force without a name", figures)


def _curve(number: int, table: TableResult) -> Figure:
    at, force, stderr = (np.array(values) for values in (table.at, table.force, table.stderr))
    label = {"x": "displacement", "v": "speed", "|v|": "speed, either way"}[table.of]
    side: dict[str, Any] = {"type": "scatter", "mode": "lines", "x": at, "hoverinfo": "skip", "showlegend": False}
    side["line"] = {"width": 0}
    traces = [
        side | {"y": force - _ERRORS * stderr},
        side | {"y": force + _ERRORS * stderr, "fill": "tonexty", "fillcolor": _BAND},
        plain(table.form, at, force, BEFORE, 2, hovertemplate="%{x:.4g}: %{y:.4g}<extra></extra>"),
    ]
    names = f"{label} / {_unit(table.at_unit)}", f"{table.form} / {_unit(table.force_unit)}"
    near = ", ".join(f"{one.name} ({100.0 * one.share:.0f} % of it)" for one in table.nearest)
    caption = (
        f"{table.described[:1].upper()}{table.described[1:]}. On the left of the equation of motion, with two standard"
        f" errors, over the range that was swept; beyond it nothing is known. The table holds {table.gauge}."
        f"{f' Nearest in the catalogue: {near}.' if near else ''}"
    )
    return Figure(f"table-{number}", traces, axes(*names, showlegend=False, hovermode="closest"), caption, height=320)


def _plane(surface: SurfaceResult) -> Figure:
    """A force over both: coloured where the motion was, its error below the pointer."""
    force, stderr = (np.array(values, dtype=np.float64) for values in (surface.force, surface.stderr))
    unit, most = _unit(surface.force_unit), float(np.nanmax(np.abs(force)))
    trace = {
        "type": "heatmap",
        "x": np.array(surface.x),
        "y": np.array(surface.v),
        "z": surface.force,
        "customdata": surface.stderr,
        "zmin": -most,
        "zmax": most,
        "colorscale": [[0.0, "#2f6fb0"], [0.5, "#f4f1ea"], [1.0, BEFORE]],
        "hoverongaps": False,
        "colorbar": {"title": {"text": unit}},
        "hovertemplate": "%{x:.4g}, %{y:.4g}: %{z:.3g} \u00b1 %{customdata:.2g}<extra></extra>",
    }
    names = f"displacement / {_unit(surface.x_unit)}", f"speed / {_unit(surface.v_unit)}"
    said, error = surface.described, float(np.nanmedian(stderr))
    caption = (
        f"{said[:1].upper()}{said[1:]}. On the left of the equation of motion; one standard error is {error:.2g} {unit}"
        " in the middle, and stands below the pointer. Blank where the motion never was: there nothing is known. The"
        f" table holds {surface.gauge}."
    )
    return Figure("table-plane", [trace], axes(*names, hovermode="closest"), caption, height=420)


def _unit(unit: str) -> str:
    return f"({unit})" if "/" in unit or " " in unit else unit


def _percents(
    name: str, labels: Sequence[str], percent: Sequence[float], colors: Sequence[str], title: str, caption: str
) -> Figure:
    """Bars in per cent, the first on top."""
    low, high = min(0.0, *percent), max(1.0, *percent)
    beside = _ROOM * (high - low)
    trace, layout = bars(labels, percent, colors, [f"{value:.3g} %" for value in percent], "%{x:.4g} %")
    trace["textposition"] = ["outside" if abs(value) < beside else "auto" for value in reversed(percent)]
    limits = [low - (beside if low < 0.0 else 0.0), high + beside]
    layout["xaxis"] = {"title": {"text": title}, "zeroline": True, "range": limits}
    return Figure(name, [trace], layout, caption, "", 110 + 30 * len(labels))


def evidence(result: DiagnosisResult) -> list[Block]:
    """Every name of the catalogue, tried alone."""
    chosen = {mechanism.name for mechanism in result.mechanisms}
    looks = {one.name: AFTER if one.name in chosen else _GREY for one in result.evidence}
    tried = "Each catalogue name tried alone against viscous and Coulomb friction"
    shares = [one.share for one in result.evidence if one.share is not None]
    if len(shares) == len(result.evidence):
        # where names are graded: a share of the misfit says more than a BIC that counts samples
        ordered = sorted(result.evidence, key=lambda one: -(one.share or 0.0))
        names, percent = [one.name for one in ordered], [100.0 * (one.share or 0.0) for one in ordered]
        caption = f"{tried}: share of the mean square misfit beyond noise that it explains. Blue: reported."
        colors = [looks[name] for name in names]
        return [_percents("evidence", names, percent, colors, "share of the misfit / %", caption)]
    best = sorted(result.evidence, key=lambda one: one.delta_bic)[::-1]
    better = [one for one in best if one.delta_bic > 1.0]
    others = [one.name for one in best if one.delta_bic <= 1.0]
    none = f" No better than the base model alone: {', '.join(others)}." if others else ""
    if not better:
        said = f"No catalogue name does better than the base model.{none}"
        return [Text(said)]
    names, gains = [one.name for one in better], [one.delta_bic for one in better]
    text = [f"{gain:.0f}" for gain in gains]
    trace, layout = bars(names, gains, [looks[name] for name in names], text, "%{x:.5g}")
    limits = [0.0, math.log10(1.3 * gains[0])]
    layout["xaxis"] = {"title": {"text": "BIC gained"}, "type": "log", "range": limits, "dtick": 1}
    caption = (
        f"{tried}; 10 is decisive. Blue: in the refined model. With two effects, a term that explains neither alone can"
        f" still do well here.{none}"
    )
    return [Figure("evidence", [trace], layout, caption, "", 110 + 24 * len(better))]


def left(result: DiagnosisResult) -> list[Block]:
    """What the best model found leaves."""
    rest = result.remainder
    assert rest is not None
    best = f"with {best_terms(result)}" if result.mechanisms else "viscous and Coulomb"
    sentence = (
        f"The best model ({best}) leaves {number(100.0 * rest.share, 3)} % of the misfit unexplained; its residual is "
        f"{number(rest.over_noise, 3)} times the sensors' noise. {rest.looks_like[0].upper()}{rest.looks_like[1:]}."
    )
    percent = [100.0 * rest.depends_on.get(name, 0.0) for name in _DEPENDS]
    caption = (
        "Share of the residual that is a function of one quantity alone; the bars overlap and need not add up to "
        "100 %. What is a function of none of them is no law of this motion, or of several together."
    )
    colors, title = [_OCHRE] * len(percent), "share of the residual / %"
    figure = _percents("remainder", list(_DEPENDS.values()), percent, colors, title, caption)
    return [Text(sentence), figure]


def shares(found: AttributionResult) -> list[Block]:
    """Whose mismatch it is."""
    stderr = found.stderr or {}
    names = [n for n in _PARTS if getattr(found, n) is not None and not (n == "engine" and found.why)]
    called = {name: name.replace("_", " ") for name in names}
    if found.why:
        called["parameters"] = "engine and parameters"
    parts = [(bar.name, bar.share, bar.of[0]) for bar in found.bars]
    parts = parts or [(called[name], getattr(found, name), name) for name in names]
    caption = f"Compared with the recording: {found.configuration}, in windows of about a period."
    if any(len(bar.of) > 1 for bar in found.bars):
        caption += " Errors that make up for each other are one bar."
    if found.why:
        caption += f" Engine and parameters are one: {found.why}."
    figure = _percents(
        "attribution",
        [name for name, _, _ in parts],
        [100.0 * share for _, share, _ in parts],
        [_PARTS[first] for _, _, first in parts],
        "part of the mean square mismatch / %",
        caption,
    )
    columns = [
        Column("share", lambda name: number(100.0 * getattr(found, name), 3), "%"),
        Column("standard error", lambda n: number(100.0 * stderr[n], 2) if n in stderr else NONE, "points"),
    ]
    note = (
        "What each brings when all are put right in turn, averaged over the orders; below 0: its error hides that"
        " of another."
    )
    table = tabulated("part", columns, names, lambda name: called[name], caption=note)
    return [figure, Folded("As Shapley values", [table])]
