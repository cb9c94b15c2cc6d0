"""The motion of all sources: position, error, acceleration with its jumps, phase portrait."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from harness.core.trajectory import Trajectory
from harness.show.decimate import reversal_times
from harness.show.motion_units import SLIDES, MotionUnits
from harness.show.report.curves import drawn, error_mm, exact_acceleration, jumps, left_out, turning, upright_lines
from harness.show.report.figure import Figure
from harness.show.report.section import Section

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
