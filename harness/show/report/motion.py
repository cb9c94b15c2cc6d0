"""The motion of all sources: position, error, acceleration with its jumps, phase portrait."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.events import EventKind, Events
from harness.core.trajectory import Trajectory
from harness.show.blocks import Block, Figure, Section
from harness.show.decimate import keep, position_error, reversal_times
from harness.show.numbers import SLIDES, MotionUnits, colors
from harness.show.plots import GROUP, POINTS, Trace, axes, curve, dots, upright_lines, zoom

MOST_DOTS = 200
"""Samples of a curve that are drawn as dots too."""
_DASH = {"as-shipped": "dash"}
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


@dataclass(frozen=True, slots=True)
class _Drawn:
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

    @property
    def a(self) -> FloatArray:
        """Acceleration there, SI."""
        return self.trajectory.a[self.chosen]

    def curve(self, y: FloatArray, unit: str) -> Trace:
        """A line of the values ``y`` (already chosen) over time; rounded for the label only."""
        line = {"color": self.color, "dash": self.dash, "width": self.width}
        return curve(self.trajectory.source.label, self.t, y, self.color, unit, line=line)

    def exact_acceleration(self, unit: str, found: Events) -> Trace:
        """Of a source that knows its events (found): the value on both sides of each jump stands among the samples."""
        at = np.repeat(np.searchsorted(self.t, found.t), 2)
        sides = np.column_stack([found.a_before, found.a_after]).ravel()
        return self.curve(np.insert(self.a, at, sides), unit) | {"x": np.insert(self.t, at, np.repeat(found.t, 2))}


def _drawn(trajectories: Sequence[Trajectory]) -> list[_Drawn]:
    """The trajectories with samples chosen and looks given; the first is the reference."""
    budget = POINTS // len(trajectories)
    palette = ["ink", *colors([trajectory.source for trajectory in trajectories])[1:]]
    found = []
    for trajectory, color in zip(trajectories, palette, strict=True):
        chosen = keep(trajectory.t, (trajectory.x, trajectory.a), reversal_times(trajectory), budget)
        dash = _DASH.get(trajectory.source.preset, "solid")
        found.append(_Drawn(trajectory, chosen, color, dash, 2.6 if color == "ink" else 1.6))
    return found


def turning(events: Events) -> Events:
    """The reversals, the last one (where it sticks) included."""
    return events.of(EventKind.REVERSAL, EventKind.STICK)


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


def motion_section(trajectories: Sequence[Trajectory], u: MotionUnits = SLIDES) -> Section:
    """trajectories : the first is the reference. u : units of their motion."""
    reference, curves = trajectories[0], _drawn(trajectories)
    times, found = reversal_times(reference), turning(reference.events)
    looks = {"hovermode": "closest", "shapes": upright_lines(times)}
    every = all(one.chosen.size == len(one.trajectory) for one in curves)
    positions = [one.curve(one.trajectory.x[one.chosen] * u.factor, u.x) for one in curves]
    layout = axes("time / s", f"{u.name} / {u.x}", **looks)
    blocks: list[Block] = [zoom(times.tolist(), reference.duration)]
    blocks.append(Figure("position", positions, layout, "Every sample is drawn." if every else _THINNED, GROUP))
    if len(curves) > 1:
        errors = [
            one.curve(position_error(one.t, one.trajectory.x[one.chosen], reference) * 1e3, u.small)
            for one in curves[1:]
        ]
        caption = f"{u.name.capitalize()} of each engine minus the exact one at the engine's own time stamps."
        layout = axes("time / s", f"engine minus reference / {u.small}", **looks, showlegend=True)
        blocks.append(Figure("error", errors, layout, caption, GROUP))
    acceleration = [one.curve(one.a, u.a) for one in curves]
    if len(found):
        acceleration[0] = curves[0].exact_acceleration(u.a, found)
        acceleration.append(_jumps(found, u.a))
    layout = axes("time / s", f"acceleration / ({u.a})", **looks)
    blocks.append(Figure("acceleration", acceleration, layout, _JUMPS if len(found) else "", GROUP, 400))
    return Section("Motion, error, acceleration", blocks)


def reversal_section(trajectories: Sequence[Trajectory], u: MotionUnits = SLIDES) -> Section:
    """The acceleration at the first reversal: what dry friction is, and what each engine makes of it.

    trajectories : the first is the reference, which has a reversal. u : units of their motion.
    """
    reference = trajectories[0]
    times = reversal_times(reference)
    low, high = zoom(times.tolist(), reference.duration).buttons[0][1]
    curves = [
        replace(one, chosen=np.flatnonzero((one.trajectory.t >= low) & (one.trajectory.t <= high)))
        for one in _drawn(trajectories)
    ]
    there = turning(reference.events).between(low, high)
    shown = [curves[0].exact_acceleration(u.a, there)]
    for one in curves[1:]:
        shown.append(one.curve(one.a, u.a) | {"mode": "lines+markers" if one.chosen.size <= MOST_DOTS else "lines"})
    seen = np.concatenate([np.asarray(line["y"], dtype=np.float64) for line in shown])
    margin = 0.08 * float(np.ptp(seen))
    layout = axes("time / s", f"acceleration / ({u.a})", hovermode="closest", shapes=upright_lines(times[:1]))
    layout["xaxis"]["range"] = [low, high]
    layout["yaxis"]["range"] = [float(seen.min()) - margin, float(seen.max()) + margin]
    figure = Figure("reversal", [*shown, _jumps(there, u.a)], layout, _ONE_JUMP, "", 400)
    return Section("Acceleration at one reversal", [figure])


def phase_section(trajectories: Sequence[Trajectory], decays: bool = True, u: MotionUnits = SLIDES) -> Section:
    """trajectories : the first is the reference. decays : whether friction pulls the motion to rest. u : its units."""
    hover, meta = f"%{{y:.6g}} {u.v}<br>%{{x:.6f}} ", {"curve": False}
    traces = [
        one.curve(one.trajectory.v[one.chosen], u.v)
        | {"x": one.trajectory.x[one.chosen] * u.factor, "hovertemplate": hover, "meta": meta}
        for one in _drawn(trajectories)
    ]
    caption = f"Speed over {u.name}"
    caption += ": the spiral winds about +x_k while it slips one way and about \u2212x_k the other." * decays
    layout = axes(f"{u.name} / {u.x}", f"speed / ({u.v})")
    return Section("Phase portrait", [Figure("phase", traces, layout, caption, "", 480)])
