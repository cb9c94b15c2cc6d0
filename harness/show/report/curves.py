"""Curves of trajectories as plotly traces, decimated so that a page stays small."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.events import EventKind, Events
from harness.core.trajectory import Trajectory
from harness.show.compare import position_error
from harness.show.decimate import keep, reversal_times
from harness.show.palette import colors

POINTS = 56_000
"""Samples on one page, all sources together: five columns of them take about 3 MB."""

_DASH = {"as-shipped": "dash"}


@dataclass(frozen=True, slots=True)
class Drawn:
    """A trajectory as it is drawn: chosen indices, shape (n,), and its looks."""

    trajectory: Trajectory
    chosen: IntArray
    color: str
    dash: str
    width: float

    @property
    def t(self) -> FloatArray:
        """Time of the chosen samples, s."""
        return self.trajectory.t[self.chosen]

    def curve(self, y: FloatArray, unit: str, x: FloatArray | None = None) -> dict[str, Any]:
        """A line of the values ``y`` (already chosen) over time, or over ``x``."""
        return {
            "type": "scatter",
            "mode": "lines",
            "name": self.trajectory.source.label,
            "x": self.t if x is None else x,
            "y": y,
            "line": {"color": self.color, "dash": self.dash, "width": self.width},
            "marker": {"size": 4},
            # rounding for the label only; the numbers are the samples themselves
            "hovertemplate": f"%{{y:.6g}} {unit}<br>%{{x:.6f}} {'s' if x is None else ''}",
            "meta": {"curve": x is None},
        }


def drawn(trajectories: Sequence[Trajectory]) -> list[Drawn]:
    """The trajectories with samples chosen and looks given; the first is the reference."""
    budget = POINTS // len(trajectories)
    palette = ["ink", *colors([trajectory.source for trajectory in trajectories])[1:]]
    found = []
    for trajectory, color in zip(trajectories, palette, strict=True):
        chosen = keep(trajectory.t, (trajectory.x, trajectory.a), reversal_times(trajectory), budget)
        dash = _DASH.get(trajectory.source.preset, "solid")
        found.append(Drawn(trajectory, chosen, color, dash, 2.6 if color == "ink" else 1.6))
    return found


def left_out(curves: Sequence[Drawn]) -> str:
    """A sentence when not every sample is drawn, else nothing."""
    if all(curve.chosen.size == len(curve.trajectory) for curve in curves):
        return "Every sample is drawn."
    return (
        "Long traces are drawn by the smallest and largest value of short stretches; "
        "around every reversal all samples are kept, so that a zoom to a jump shows the true ones."
    )


def error_mm(curve: Drawn, reference: Trajectory) -> FloatArray:
    """Position error of the chosen samples, mm."""
    return position_error(curve.t, curve.trajectory.x[curve.chosen], reference) * 1e3


def turning(events: Events) -> Events:
    """The reversals, the last one (where it sticks) included."""
    return events.of(EventKind.REVERSAL, EventKind.STICK)


def jumps(events: Events, unit: str) -> dict[str, Any]:
    """The acceleration on both sides of each reversal as marks that say the size of the jump, in its unit."""
    found = turning(events)
    text = [
        f"{'sticks' if found.kind[i] == EventKind.STICK else f'reversal {i + 1}'} at {found.t[i]:.6f} s<br>"
        f"jump {found.a_after[i] - found.a_before[i]:+.5g} {unit}"
        for i in range(len(found))
    ]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": "before and after the exact jump",
        "x": np.repeat(found.t, 2),
        "y": np.column_stack([found.a_before, found.a_after]).ravel(),
        "text": [line for one in text for line in (one, one)],
        "hovertemplate": "%{text}<extra></extra>",
        "marker": {"color": "ink", "size": 7, "symbol": "diamond-open"},
        "meta": {"curve": False},
    }


def exact_acceleration(curve: Drawn, unit: str, events: Events | None = None) -> dict[str, Any]:
    """Acceleration of a source that knows its events: the value on both sides of each jump is put among the samples.

    events : those among the chosen samples, its own when left out.
    """
    found = turning(curve.trajectory.events if events is None else events)
    at = np.searchsorted(curve.t, found.t)
    t = np.insert(curve.t, np.repeat(at, 2), np.repeat(found.t, 2))
    sides = np.column_stack([found.a_before, found.a_after]).ravel()
    return curve.curve(np.insert(curve.trajectory.a[curve.chosen], np.repeat(at, 2), sides), unit) | {"x": t}


def upright_lines(times: FloatArray) -> list[dict[str, Any]]:
    """Faint lines across a plot at these times, s."""
    line = {"color": "rule", "width": 1, "dash": "dot"}
    return [
        {
            "type": "line",
            "x0": float(t),
            "x1": float(t),
            "y0": 0,
            "y1": 1,
            "yref": "paper",
            "line": line,
            "layer": "below",
        }
        for t in times
    ]


def noise_band(level: float) -> list[dict[str, Any]]:
    """Dashed lines at plus and minus a level of noise."""
    line = {"color": "muted", "width": 1, "dash": "dash"}
    place = {"type": "line", "x0": 0, "x1": 1, "xref": "paper", "line": line}
    return [place | {"y0": level, "y1": level}, place | {"y0": -level, "y1": -level}]
