"""Pieces of plots that several pages draw: curves, points, bars, axes, lines across, the bar of zooms.

What of a motion is drawn: fewer samples for the eye, and its distance from another motion.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from harness.core.arrays import BoolArray, FloatArray, IntArray
from harness.core.events import EventKind
from harness.core.trajectory import Trajectory
from harness.show.blocks import Figure, Zoom

Trace = dict[str, Any]
POINTS = 28_000
"""Samples of one figure of a page, all curves together: those of a run take about 3 MB."""
GROUP = "time"
_WIDE = 100.0
"""Of a logarithmic axis from end to end, above which its ticks are decades."""
CHANNELS = {
    "x": ("position", "mm", 1e3),
    "v": ("speed", "m/s", 1.0),
    "a": ("acceleration", "m/s²", 1.0),
    "u": ("force", "N", 1.0),
}
ANGLES = {
    "x": ("angle", "rad", 1.0),
    "v": ("speed", "rad/s", 1.0),
    "a": ("acceleration", "rad/s²", 1.0),
    "u": ("torque", "N m", 1.0),
}
"""Label, unit and factor of a channel: on a page lengths are in mm."""
SHADE = "rgba(228, 99, 45, 0.12)"
_NOISE = "rgba(128, 136, 148, 0.3)"
MOST_SHADES = 80
MOST_BUTTONS = 12
AROUND = 0.12
"""Half the width of a zoom to a jump, as a share of the time between reversals."""
_DIGITS = "%{y:.6g}"


def curve(name: str, x: Any, y: Any, color: str, unit: str = "", width: float = 1.5, **more: Any) -> Trace:
    """A line over time (s) whose single samples show where one zooms in; unit : of y, on hovering."""
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": x,
        "y": y,
        "line": {"color": color, "width": width},
        "marker": {"size": 4},
        "hovertemplate": f"{_DIGITS} {unit}<br>%{{x:.6f}} s",
        "meta": {"curve": True},
    } | more


def orbit(line: Trace, t: FloatArray, x: FloatArray, y: FloatArray, hover: str = "") -> Trace:
    """A curve in a plane instead of one over time, looking like ``line``. t : times of its points (n,), s."""
    found = line | {"t": t, "x": x, "y": y, "meta": {"curve": False}}
    return found | ({"hovertemplate": hover} if hover else {})


def thinned(figure: Figure, budget: int) -> list[Trace]:
    """Its traces, curves with about ``budget`` samples at most: those over the same times keep the same samples."""
    # of a curve over time, or an orbit, there are more samples than one sees
    long = [one for one in figure.traces if "t" in one or one.get("meta", {}).get("curve")]
    over = {id(one): one.get("t", one["x"]) for one in long}
    together: dict[int, list[FloatArray]] = {}
    for one in figure.traces:
        if id(one) in over:
            values = [one["x"], one["y"]] if "t" in one else [one["y"]]
            together.setdefault(id(over[id(one)]), []).extend(values)
    chosen = {id(t): keep(t, together[id(t)], figure.around, budget) for t in over.values()}
    return [
        {k: v[chosen[id(over[id(one)])]] if k in ("t", "x", "y") else v for k, v in one.items()}
        if id(one) in over
        else dict(one)
        for one in figure.traces
    ]


def is_plane(figure: Figure) -> bool:
    """Whether its curves are orbits, or its points have errors: neither is drawn over time."""
    return any("t" in trace or "now" in trace or "error_y" in trace for trace in figure.traces)


def plain(name: str, x: Any, y: Any, color: str, width: float = 1.5, **more: Any) -> Trace:
    """A line of which nothing is asked."""
    line = {"color": color, "width": width}
    return {"type": "scatter", "mode": "lines", "name": name, "x": x, "y": y, "line": line} | more


def dots(name: str, x: Any, y: Any, marker: dict[str, Any], hover: str, **more: Any) -> Trace:
    """Points; hover : what each says."""
    known = {"type": "scatter", "mode": "markers", "name": name, "x": x, "y": y, "marker": marker}
    return known | {"hovertemplate": hover} | more


def axes(x: str, y: str, **more: Any) -> dict[str, Any]:
    """A layout of labelled axes, and what else it has."""
    return {"xaxis": {"title": {"text": x}}, "yaxis": {"title": {"text": y}}} | more


def decades(values: Sequence[float]) -> dict[str, Any]:
    """A logarithmic axis of these; what is not far apart has ticks within decades."""
    above = [value for value in values if value > 0.0]
    wide = bool(above) and max(above) > _WIDE * min(above)
    return {"type": "log", "exponentformat": "power", "dtick": 1 if wide else "D2"}


def bars(
    labels: Sequence[str], x: Sequence[float], colors: Sequence[str], text: Sequence[str], hover: str
) -> tuple[Trace, dict[str, Any]]:
    """Horizontal bars, the first on top, and their layout without an axis below."""
    trace = {
        "type": "bar",
        "orientation": "h",
        "x": list(x)[::-1],
        "y": list(labels)[::-1],
        "marker": {"color": list(colors)[::-1]},
        "text": list(text)[::-1],
        "textposition": "auto",
        "hovertemplate": f"%{{y}}: {hover}<extra></extra>",
    }
    return trace, {"yaxis": {"ticks": ""}, "showlegend": False, "bargap": 0.35}


def per(unit: str) -> str:
    """A unit as it stands behind the stroke of an axis: "m/s" as "(m/s)"."""
    return f"({unit})" if "/" in unit else unit


def upright_lines(times: FloatArray) -> list[dict[str, Any]]:
    """Faint lines across a plot at these times, s."""
    line = {"color": "rule", "width": 1, "dash": "dot"}
    place = {"type": "line", "y0": 0, "y1": 1, "yref": "paper", "line": line, "layer": "below"}
    return [place | {"x0": float(t), "x1": float(t)} for t in times]


def left_by(what: str, sigma: object, unit: str, factor: float) -> tuple[str, list[dict[str, Any]]]:
    """Caption of a recording minus what was made of it, and a band of two deviations of its noise, where known.

    sigma : of the noise, SI. unit, factor : those drawn.
    """
    if not isinstance(sigma, (int, float)):
        return f"Recording minus {what}.", []
    level = 2.0 * sigma * factor
    band = {"type": "rect", "x0": 0, "x1": 1, "xref": "paper", "y0": -level, "y1": level, "layer": "below"}
    caption = f"Recording minus {what}. Grey: the noise, ± two standard deviations ({level:.3g} {unit})."
    return caption, [band | {"fillcolor": _NOISE, "line": {"width": 0}}]


def shades(spans: Sequence[Sequence[float]], color: str = SHADE) -> list[dict[str, Any]]:
    """Bands behind a plot over these spans of time, s."""
    place = {"type": "rect", "y0": 0, "y1": 1, "yref": "paper", "layer": "below", "fillcolor": color}
    return [place | {"x0": low, "x1": high, "line": {"width": 0}} for low, high in spans[:MOST_SHADES]]


def zoom(times: Sequence[float], duration: float, to: str = "a reversal") -> Zoom:
    """A bar that zooms to these times, s; to : what they are."""
    spacing = float(np.median(np.diff(times))) if len(times) > 1 else 0.2 * duration
    half = AROUND * spacing
    ranges = [(f"{i + 1}: {t:.3f} s", (float(t - half), float(t + half))) for i, t in enumerate(times[:MOST_BUTTONS])]
    return Zoom(ranges, GROUP, to)


def some(figures: Sequence[Figure]) -> list[Figure]:
    """Those in which anything is drawn."""
    return [figure for figure in figures if figure.traces]


MOST_EVENTS = 64


def reversal_times(trajectory: Trajectory) -> FloatArray:
    """Times at which the speed changes sign, s: exact ones where the source knows them, else between samples.

    At most 64, the first ones: a chattering trace would otherwise ask for every sample.
    """
    if len(trajectory.events):
        return trajectory.events.of(EventKind.REVERSAL, EventKind.STICK).t[:MOST_EVENTS]
    sign = np.sign(trajectory.v)
    at = np.flatnonzero(sign[1:] * sign[:-1] < 0.0)[:MOST_EVENTS]
    before, after = trajectory.v[at], trajectory.v[at + 1]
    return np.asarray(trajectory.t[at] + (trajectory.t[at + 1] - trajectory.t[at]) * before / (before - after))


def keep(t: FloatArray, channels: Sequence[FloatArray], around: FloatArray, budget: int) -> IntArray:
    """Indices of the samples to draw, increasing, about ``budget`` of them at most.

    All samples when they are no more than the budget. Otherwise half of it goes to full resolution around the times
    ``around``, the rest to the smallest and largest value of every channel in equal stretches: no spike is lost.
    """
    n = t.size
    if n <= budget:
        return np.arange(n)
    chosen = np.zeros(n, dtype=bool)
    chosen[[0, -1]] = True
    if around.size:
        half = max(1, budget // (4 * around.size))
        for centre in np.searchsorted(t, around):
            chosen[max(0, centre - half) : centre + half] = True
    stretches = max(1, budget // (4 * max(1, len(channels))))
    edges = np.linspace(0, n, stretches + 1).astype(np.int64)
    length = int(np.diff(edges).max())
    # rows of one length, so that both extremes come from two calls; the last sample pads the short rows
    rows = np.minimum(edges[:-1, None] + np.arange(length), n - 1)
    for values in channels:
        block = values[rows]
        line = np.arange(stretches)
        chosen[rows[line, block.argmin(axis=1)]] = True
        chosen[rows[line, block.argmax(axis=1)]] = True
    return np.flatnonzero(chosen)


def position_at(reference: Trajectory, t: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Position of ``reference`` at other times, m, and which of the times it covers.

    Cubic Hermite interpolation from x and v: exact at its own samples, off by order h^4 between them and by at most
    h^2/8 times the jump of acceleration in the interval that holds a reversal.
    """
    covered = (t >= reference.t[0]) & (t <= reference.t[-1])
    i = np.clip(np.searchsorted(reference.t, t, side="right") - 1, 0, len(reference) - 2)
    h = reference.t[i + 1] - reference.t[i]
    s = (t - reference.t[i]) / h
    x0, x1, v0, v1 = reference.x[i], reference.x[i + 1], reference.v[i] * h, reference.v[i + 1] * h
    rise = x1 - x0
    inside = x0 + s * (v0 + s * (3.0 * rise - 2.0 * v0 - v1 + s * (v0 + v1 - 2.0 * rise)))
    return np.where(s == 1.0, x1, inside), covered


def position_error(t: FloatArray, x: FloatArray, reference: Trajectory) -> FloatArray:
    """Positions ``x`` at times ``t`` minus the reference's, m, shape (n,); nan where the reference does not reach."""
    exact, covered = position_at(reference, t)
    return np.where(covered, x - exact, np.nan)
