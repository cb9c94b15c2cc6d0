"""The motion of all sources: position, error, acceleration with its jumps, phase portrait; and the scene of a run."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.events import EventKind, Events, Mode
from harness.core.trajectory import Trajectory
from harness.results.common import Result
from harness.show import scene as s
from harness.show.blocks import Block, Figure, Section
from harness.show.numbers import AT_REST, SLIDES, TURNS, MotionUnits, colors, units_of
from harness.show.plots import (
    GROUP,
    POINTS,
    Trace,
    axes,
    curve,
    dots,
    orbit,
    position_error,
    reversal_times,
    upright_lines,
    zoom,
)

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


RAIL = 1.15
"""Largest excursion of the drawn model, m: its rail ends beyond it."""
_APART = -0.42
"""From one model to the next, m."""
_LOOKS = {
    "slip+": ("slips forwards", "#e4632d"),
    "stick": ("sticks", "#5b6470"),
    "creep": ("creeps", "#b08d57"),
    "slip-": ("slips backwards", "#2b7fd6"),
}
_MODES = {int(Mode.SLIP_POSITIVE): "slip+", int(Mode.STICK): "stick", int(Mode.SLIP_NEGATIVE): "slip-"}


def run_scene(
    trajectories: Sequence[Trajectory],
    scenario: Mapping[str, Any],
    result: Result | Mapping[str, Any],
    notes: str,
    urdf: Path | None = None,
) -> s.Scene:
    """Scene of a run.

    trajectories : the first is the reference. scenario : JSON-able, stored with the result. notes :
    Markdown. urdf : the slider's description; without one there is no view in space.
    """
    units = units_of(scenario)
    left: list[s.Layout] = [*motion_figures(trajectories, units)]
    shares = [3.0] * len(left)
    action = scenario.get("action") or {}
    floor = float(action["speed"]) if action.get("kind") == "Belt" else 0.0
    lanes = [mode_lane(one, floor) for one in trajectories if one.mode is not None]
    if lanes:
        left.append(s.Lanes("stick and slip", lanes))
        shares.append(0.9 + 0.45 * len(trajectories))
    pages: list[s.Layout] = [s.Words("notes", notes), s.Words("parameters", _parameters(scenario, trajectories))]
    if reversals := reversal_sentences(trajectories[0], units):
        pages.append(s.Events("reversals", turning(trajectories[0].events).t, reversals))
    space = [] if urdf is None else [_space(trajectories, urdf, units is TURNS)]
    right: list[s.Layout] = [*space, phase_figure(trajectories, u=units), s.Tabs(pages)]
    name = f"{scenario.get('name', 'run')}: {', '.join(dict.fromkeys(tr.source.name for tr in trajectories))}"
    layout = s.Columns([s.Rows(left, shares), s.Rows(right)], [3.0, 2.0])
    return s.of_result(name, layout, result, notes, {"trajectory": trajectories}, {"scenario": dict(scenario)})


def mode_lane(trajectory: Trajectory, floor: float = 0.0) -> s.Lane:
    """Stick and slip as a lane: one state for every stretch of equal mode; floor : speed of what it lies on, m/s.

    Friction below its limit is no rest by itself: an engine's soft friction gives way all the while.
    """
    assert trajectory.mode is not None
    mode, slip = trajectory.mode, trajectory.v - floor
    starts = np.concatenate([[0], np.flatnonzero(np.diff(mode)) + 1])
    states = []
    for first, end in zip(starts, [*starts[1:], mode.size], strict=True):
        settled = slip[(first + end) // 2 : end]
        one_way = abs(int(np.sum(np.sign(settled)))) == settled.size
        creeps = mode[first] == Mode.STICK and one_way and float(np.median(np.abs(settled))) > AT_REST
        states.append("creep" if creeps else _MODES[int(mode[first])])
    return s.Lane(trajectory.source.label, trajectory.t[starts], states, _LOOKS)


def reversal_sentences(reference: Trajectory, u: MotionUnits = SLIDES) -> list[str]:
    """Each reversal with the jump of the acceleration."""
    found = turning(reference.events)
    whats = ["sticks" if kind == EventKind.STICK else f"reversal {i + 1}" for i, kind in enumerate(found.kind)]
    return [
        f"{t:.6f} s: {what} at x = {x * 1e3:.3f} {u.small}, acceleration jumps by {after - before:+.4g} {u.a}"
        f" (from {before:.4g} to {after:.4g})"
        for t, what, x, before, after in zip(found.t, whats, found.x, found.a_before, found.a_after, strict=True)
    ]


def _space(trajectories: Sequence[Trajectory], urdf: Path, turns: bool) -> s.Space:
    """One model a source, side by side, all with the same exaggeration of the motion; an angle is drawn as it is."""
    largest = max(float(np.max(np.abs(one.x))) for one in trajectories)
    factor = 1.0
    if not turns and largest > 0.0 and not 0.3 * RAIL < largest <= RAIL:
        exponent = np.floor(np.log10(RAIL / largest))
        step = RAIL / largest / 10.0**exponent
        factor = float(max(nice for nice in (1.0, 2.0, 5.0) if nice <= step) * 10.0**exponent)
    bodies = []
    palette = colors([one.source for one in trajectories])
    for i, (one, color) in enumerate(zip(trajectories, palette, strict=True)):
        at = np.linspace(one.t[0], one.t[-1], min(s.FRAMES, len(one)))
        values = np.interp(at, one.t, one.x) * factor
        bodies.append(s.Body(one.source.label, urdf, at, values, (0.0, _APART * i, 0.0), color))
    middle = 0.5 * _APART * (len(bodies) - 1)
    eye = (0.0, 1.6 * middle - 1.35, 1.5 - 0.35 * middle)
    name = "sliders" if factor == 1.0 else f"sliders, motion x {factor:g}"
    return s.Space(name, bodies, eye, (0.0, 1.15 * middle, -0.1))


def _parameters(scenario: Mapping[str, Any], trajectories: Sequence[Trajectory]) -> str:
    """Slider, scenario, and every source's version and settings as a page."""
    lines = ["# Parameters", "", *_table(scenario)]
    for trajectory in trajectories:
        source = trajectory.source
        step = "exact" if source.dt is None else f"step {source.dt:g} s"
        lines += ["", f"## {source.label}", ""]
        lines += [f"version {source.version or 'unknown'}, {step}, {len(trajectory)} samples", ""]
        lines += _table(source.settings)
        if source.ignored:
            lines += ["", "Not honoured:", *(f"- {sentence}" for sentence in source.ignored)]
    return "\n".join(lines)


def _table(values: Mapping[str, Any]) -> list[str]:
    rows = []
    for name, value in values.items():
        inside = {f"{name}.{key}": v for key, v in value.items()} if isinstance(value, Mapping) else {name: value}
        rows += [f"| {key} | {_cell(v)} |" for key, v in inside.items()]
    return ["| name | value |", "|---|---|", *rows] if rows else []


def _cell(value: object) -> str:
    return f"{value:.10g}" if isinstance(value, float) else str(value).replace("|", "/")
