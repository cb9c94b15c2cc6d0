"""The motion of all sources: position, error, acceleration with its jumps, phase portrait."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.events import EventKind, Events
from harness.core.trajectory import Trajectory
from harness.show.decimate import keep, position_error, reversal_times
from harness.show.numbers import SLIDES, MotionUnits, colors
from harness.show.report.section import Figure, Section

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


GROUP = "time"
MOST_BUTTONS = 12
_JUMPS = (
    "At a reversal dry friction changes sign and the acceleration jumps by 2 f_k/m: the diamonds "
    "are its two sides in the exact solution. Zoom to one to see how each engine spreads it over time."
)
_ONE_JUMP = (
    "Dry friction changes sign where the speed is zero, and the acceleration jumps by 2 f_k/m: the diamonds are both "
    "sides of the exact jump. An engine with soft friction goes from one side to the other over a time, and elsewhere."
)
MOST_DOTS = 200
"""Samples of a curve that are drawn as dots too."""
AROUND = 0.12
"""Half the width of a zoom to a jump, as a share of the time between reversals."""


def zoom_buttons(times: Sequence[float], duration: float) -> list[dict[str, Any]]:
    """What the zoom bar offers: a label and a range of time in s each."""
    spacing = float(np.median(np.diff(times))) if len(times) > 1 else 0.2 * duration
    half = AROUND * spacing
    return [
        {"label": f"{i + 1}: {t:.3f} s", "range": [float(t - half), float(t + half)]}
        for i, t in enumerate(times[:MOST_BUTTONS])
    ]


def motion_section(trajectories: Sequence[Trajectory], units: MotionUnits = SLIDES) -> Section:
    """trajectories : the first is the reference. units : of their motion."""
    reference, u = trajectories[0], units
    curves = drawn(trajectories)
    times = reversal_times(reference)
    layout = {"xaxis": {"title": {"text": "time / s"}}, "hovermode": "closest", "shapes": upright_lines(times)}
    figures = [
        Figure(
            "position",
            [curve.curve(curve.trajectory.x[curve.chosen] * u.factor, u.x) for curve in curves],
            layout | {"yaxis": {"title": {"text": f"{u.name} / {u.x}"}}},
            left_out(curves),
            GROUP,
        )
    ]
    if len(curves) > 1:
        figures.append(
            Figure(
                "error",
                [curve.curve(error_mm(curve, reference), u.small) for curve in curves[1:]],
                layout | {"yaxis": {"title": {"text": f"engine minus reference / {u.small}"}}, "showlegend": True},
                f"{u.name.capitalize()} of each engine minus the exact one at the engine's own time stamps.",
                GROUP,
            )
        )
    acceleration = [curve.curve(curve.trajectory.a[curve.chosen], u.a) for curve in curves]
    if len(turning(reference.events)):
        acceleration[0] = exact_acceleration(curves[0], u.a)
        acceleration.append(jumps(reference.events, u.a))
    figures.append(
        Figure(
            "acceleration",
            acceleration,
            layout | {"yaxis": {"title": {"text": f"acceleration / ({u.a})"}}},
            _JUMPS if len(turning(reference.events)) else "",
            GROUP,
            400,
        )
    )
    return Section(
        "Motion, error, acceleration",
        "motion.html.j2",
        {"figures": figures, "buttons": zoom_buttons(times.tolist(), reference.duration), "group": GROUP},
    )


def reversal_section(trajectories: Sequence[Trajectory], units: MotionUnits = SLIDES) -> Section:
    """The acceleration at the first reversal: what dry friction is, and what each engine makes of it.

    trajectories : the first is the reference, which has a reversal. units : of their motion.
    """
    reference, u = trajectories[0], units
    times = reversal_times(reference)
    low, high = zoom_buttons(times.tolist(), reference.duration)[0]["range"]
    curves = [
        replace(one, chosen=np.flatnonzero((one.trajectory.t >= low) & (one.trajectory.t <= high)))
        for one in drawn(trajectories)
    ]
    there = turning(reference.events).between(low, high)
    shown = [one.curve(one.trajectory.a[one.chosen], u.a) for one in curves]
    shown[0] = exact_acceleration(curves[0], u.a, there)
    for one, line in zip(curves[1:], shown[1:], strict=True):
        line["mode"] = "lines+markers" if one.chosen.size <= MOST_DOTS else "lines"
    seen = np.concatenate([np.asarray(line["y"], dtype=np.float64) for line in shown])
    margin = 0.08 * float(np.ptp(seen))
    layout = {
        "xaxis": {"title": {"text": "time / s"}, "range": [low, high]},
        "yaxis": {
            "title": {"text": f"acceleration / ({u.a})"},
            "range": [float(seen.min()) - margin, float(seen.max()) + margin],
        },
        "hovermode": "closest",
        "shapes": upright_lines(times[:1]),
    }
    return Section(
        "Acceleration at one reversal",
        "figures.html.j2",
        {"figures": [Figure("reversal", [*shown, jumps(there, u.a)], layout, _ONE_JUMP, "", 400)]},
    )


def phase_section(trajectories: Sequence[Trajectory], decays: bool = True, units: MotionUnits = SLIDES) -> Section:
    """trajectories : the first is the reference. decays : whether friction pulls the motion to rest. units : of it."""
    u = units
    traces = [
        curve.curve(curve.trajectory.v[curve.chosen], u.v, curve.trajectory.x[curve.chosen] * u.factor)
        for curve in drawn(trajectories)
    ]
    layout = {"xaxis": {"title": {"text": f"{u.name} / {u.x}"}}, "yaxis": {"title": {"text": f"speed / ({u.v})"}}}
    caption = f"Speed over {u.name}"
    caption += ": the spiral winds about +x_k while it slips one way and about \u2212x_k the other." * decays
    return Section(
        "Phase portrait", "figures.html.j2", {"figures": [Figure("phase", traces, layout, caption, "", 480)]}
    )
