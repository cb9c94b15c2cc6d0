"""The scene of a run: every source against the first one, which is the reference."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.events import EventKind, Mode
from harness.core.trajectory import Trajectory
from harness.results.common import Result
from harness.show import scene as s
from harness.show.numbers import AT_REST, SLIDES, TURNS, MotionUnits, colors, units_of
from harness.show.report.motion import motion_figures, phase_figure, turning

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
