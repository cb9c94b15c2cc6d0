"""The motion of all sources: position, error, acceleration with its jumps, phase portrait."""

from collections.abc import Sequence

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.events import EventKind, Events
from harness.core.trajectory import Trajectory
from harness.show.blocks import Block, Figure, Section
from harness.show.decimate import position_error, reversal_times
from harness.show.numbers import SLIDES, MotionUnits, colors
from harness.show.plots import GROUP, POINTS, Trace, axes, curve, dots, orbit, upright_lines, zoom

MOST_DOTS = 200
"""Samples of a curve that are drawn as dots too."""
_JUMPS = (
    "At a reversal dry friction changes sign and the acceleration jumps by 2 f_k/m: the diamonds "
    "are its two sides in the exact solution. Zoom to one to see how each engine spreads it over time."
)
_ONE_JUMP = (
    "Dry friction changes sign where the speed is zero, and the acceleration jumps by 2 f_k/m: the diamonds are both "
    "sides of the exact jump. An engine with soft friction goes from one side to the other over a time, and elsewhere."
)
_THINNED = (
    "Long traces are drawn by the smallest and largest value of short stretches; "
    "around every reversal all samples are kept, so that a zoom to a jump shows the true ones."
)


def _lines(trajectories: Sequence[Trajectory], values: Sequence[FloatArray], unit: str) -> list[Trace]:
    """Values (n,) of each over its time; the first is the reference."""
    palette = ["ink", *colors([trajectory.source for trajectory in trajectories])[1:]]
    found = []
    for trajectory, y, color in zip(trajectories, values, palette, strict=True):
        dash = "dash" if trajectory.source.preset == "as-shipped" else "solid"
        line = {"color": color, "dash": dash, "width": 2.6 if color == "ink" else 1.6}
        found.append(curve(trajectory.source.label, trajectory.t, y, color, unit, line=line))
    return found


def turning(events: Events) -> Events:
    """The reversals, the last one (where it sticks) included."""
    return events.of(EventKind.REVERSAL, EventKind.STICK)


def _accelerations(trajectories: Sequence[Trajectory], unit: str) -> list[Trace]:
    """Of a source that knows its events the value on both sides of each jump stands among the samples."""
    lines, reference = _lines(trajectories, [one.a for one in trajectories], unit), trajectories[0]
    if len(found := turning(reference.events)):
        at = np.repeat(np.searchsorted(reference.t, found.t), 2)
        lines[0]["x"] = np.insert(reference.t, at, np.repeat(found.t, 2))
        lines[0]["y"] = np.insert(reference.a, at, np.column_stack([found.a_before, found.a_after]).ravel())
    return lines


def _jumps(found: Events, unit: str) -> Trace:
    """The acceleration on both sides of each reversal as marks that say the size of the jump, in its unit."""
    text = [
        f"{'sticks' if found.kind[i] == EventKind.STICK else f'reversal {i + 1}'} at {found.t[i]:.6f} s<br>"
        f"jump {found.a_after[i] - found.a_before[i]:+.5g} {unit}"
        for i in range(len(found))
    ]
    return dots(
        "before and after the exact jump",
        np.repeat(found.t, 2),
        np.column_stack([found.a_before, found.a_after]).ravel(),
        {"color": "ink", "size": 7, "symbol": "diamond-open"},
        "%{text}<extra></extra>",
        text=[line for one in text for line in (one, one)],
        meta={"curve": False},
    )


def motion_figures(trajectories: Sequence[Trajectory], u: MotionUnits = SLIDES) -> list[Figure]:
    """Position, error where there is anything beside the reference, which is the first, and acceleration."""
    reference = trajectories[0]
    times, found = reversal_times(reference), turning(reference.events)
    looks = {"hovermode": "closest", "shapes": upright_lines(times)}
    whole = max(map(len, trajectories)) <= POINTS // len(trajectories)
    positions = _lines(trajectories, [one.x * u.factor for one in trajectories], u.x)
    errors = _lines(trajectories, [1e3 * position_error(one.t, one.x, reference) for one in trajectories], u.small)
    accelerations = _accelerations(trajectories, u.a) + ([_jumps(found, u.a)] if len(found) else [])
    figures = []
    for name, label, lines, caption, height in (
        ("position", f"{u.name} / {u.x}", positions, "Every sample is drawn." if whole else _THINNED, 340),
        (
            "error",
            f"engine minus reference / {u.small}",
            errors[1:],
            f"{u.name.capitalize()} of each engine minus the exact one at the engine's own time stamps.",
            340,
        ),
        ("acceleration", f"acceleration / ({u.a})", accelerations, _JUMPS if len(found) else "", 400),
    ):
        if lines:
            layout = axes("time / s", label, showlegend=True, **looks)
            figures.append(Figure(name, lines, layout, caption, GROUP, height, times))
    return figures


def motion_section(trajectories: Sequence[Trajectory], u: MotionUnits = SLIDES) -> Section:
    """trajectories : the first is the reference. u : units of their motion."""
    reference = trajectories[0]
    buttons: list[Block] = [zoom(reversal_times(reference).tolist(), reference.duration)]
    return Section("Motion, error, acceleration", [*buttons, *motion_figures(trajectories, u)])


def reversal_section(trajectories: Sequence[Trajectory], u: MotionUnits = SLIDES) -> Section:
    """The acceleration at the first reversal: what dry friction is, and what each engine makes of it.

    trajectories : the first is the reference, which has a reversal. u : units of their motion.
    """
    reference = trajectories[0]
    times = reversal_times(reference)
    low, high = zoom(times.tolist(), reference.duration).buttons[0][1]
    shown = _accelerations(trajectories, u.a)
    for line in shown:
        inside = (line["x"] >= low) & (line["x"] <= high)
        line |= {"x": line["x"][inside], "y": line["y"][inside]}
        if line is not shown[0]:
            line["mode"] = "lines+markers" if line["x"].size <= MOST_DOTS else "lines"
    seen = np.concatenate([line["y"] for line in shown])
    margin = 0.08 * float(np.ptp(seen))
    layout = axes("time / s", f"acceleration / ({u.a})", hovermode="closest", shapes=upright_lines(times[:1]))
    layout["xaxis"]["range"] = [low, high]
    layout["yaxis"]["range"] = [float(seen.min()) - margin, float(seen.max()) + margin]
    marks = _jumps(turning(reference.events).between(low, high), u.a)
    figure = Figure("reversal", [*shown, marks], layout, _ONE_JUMP, "", 400, times[:1])
    return Section("Acceleration at one reversal", [figure])


def phase_figure(trajectories: Sequence[Trajectory], decays: bool = True, u: MotionUnits = SLIDES) -> Figure:
    """trajectories : the first is the reference. decays : whether friction pulls the motion to rest. u : its units."""
    lines = _lines(trajectories, [one.v for one in trajectories], u.v)
    hover = f"%{{y:.6g}} {u.v}<br>%{{x:.6f}} "
    traces = [orbit(line, one.t, one.x * u.factor, one.v, hover) for line, one in zip(lines, trajectories, strict=True)]
    caption = f"Speed over {u.name}"
    caption += ": the spiral winds about +x_k while it slips one way and about \u2212x_k the other." * decays
    layout = axes(f"{u.name} / {u.x}", f"speed / ({u.v})")
    return Figure("phase", traces, layout, caption, "", 480, reversal_times(trajectories[0]))
