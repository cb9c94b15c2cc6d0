"""The scene of a run: every source against the first one, which is the reference."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from harness.core.arrays import FloatArray, IntArray
from harness.core.events import EventKind, Mode
from harness.core.trajectory import Trajectory
from harness.show import scene as s
from harness.show.decimate import keep, position_error, reversal_times
from harness.show.numbers import AT_REST, SLIDES, TURNS, MotionUnits, colors, units_of
from harness.show.pack import pack_trajectories
from harness.show.scene import padded, plane_grid, roomy

DRAWN = 50_000
"""Samples drawn for one source. All are stored; beyond this number the curves are decimated (harness.show.decimate)."""

FRAMES = 600
"""Poses of the moving model and of the points on the phase portrait."""

RAIL = 1.15
"""Largest excursion of the drawn model, m: its rail ends beyond it."""

MODE_LOOKS = {
    "slip+": ("slips forwards", "#e4632d"),
    "stick": ("sticks", "#5b6470"),
    "creep": ("creeps", "#b08d57"),
    "slip-": ("slips backwards", "#2b7fd6"),
}
_MODES = {int(Mode.SLIP_POSITIVE): "slip+", int(Mode.STICK): "stick", int(Mode.SLIP_NEGATIVE): "slip-"}


def run_scene(
    trajectories: Sequence[Trajectory],
    scenario: Mapping[str, Any],
    result: Mapping[str, Any],
    notes: str,
    urdf: Path | None = None,
) -> s.Scene:
    """Scene of a run.

    trajectories : the first is the reference. scenario, result : JSON-able, stored as properties. notes : Markdown.
    urdf : the slider's description; without one there is no view in space.
    """
    reference = trajectories[0]
    slugs = _slugs(trajectories)
    palette = colors([trajectory.source for trajectory in trajectories])
    scale = _phase_scale(trajectories)
    items: list[s.Item] = []
    errors = []
    action = scenario.get("action") or {}
    floor = float(action["speed"]) if action.get("kind") == "Belt" else 0.0
    for trajectory, slug, color in zip(trajectories, slugs, palette, strict=True):
        label = trajectory.source.label
        chosen = keep(trajectory.t, (trajectory.x, trajectory.a), reversal_times(trajectory), DRAWN)
        t = trajectory.t[chosen]
        width = 2.5 if trajectory is reference else 1.5
        items.append(s.Line(f"/position/{slug}", label, t, trajectory.x[chosen], color, width))
        items.append(s.Line(f"/acceleration/{slug}", label, t, trajectory.a[chosen], color, width))
        items.append(_orbit(trajectory, chosen, f"/phase/{slug}", color, scale))
        if trajectory is not reference:
            error = position_error(t, trajectory.x[chosen], reference)
            errors.append(error)
            items.append(s.Line(f"/error/{slug}", label, t, error * 1e3, color))
        if trajectory.mode is not None:
            items.append(mode_lane(trajectory, f"/contact/{slug}", floor))
    units = units_of(scenario)
    items += reversal_marks(reference, units)
    items.append(_plane(trajectories, units))
    items += [s.Page("/notes", notes), s.Page("/parameters", _parameters(scenario, trajectories))]
    turns = units is TURNS
    bodies, factor = _bodies(trajectories, slugs, palette, urdf, turns)
    items += bodies
    return s.Scene(
        f"{scenario.get('name', 'run')}: {', '.join(dict.fromkeys(tr.source.name for tr in trajectories))}",
        items,
        _layout(trajectories, errors, bodies, factor, any(isinstance(item, s.Lane) for item in items), turns),
        {f"trajectory-{i:03d}": data for i, data in enumerate(pack_trajectories(trajectories))},
        {"scenario": dict(scenario), "result": dict(result), "notes": {"text": notes}},
    )


def _slugs(trajectories: Sequence[Trajectory]) -> list[str]:
    """One entity name a source, without characters that the viewer would escape."""
    found: list[str] = []
    for i, trajectory in enumerate(trajectories):
        plain = "".join(c if c.isalnum() else "-" for c in trajectory.source.label) or "source"
        # the number keeps the order: the viewer draws by name, and the reference belongs below the others
        found.append(f"{i}-{plain}")
    return found


def mode_lane(trajectory: Trajectory, path: str, floor: float = 0.0) -> s.Lane:
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
    return s.Lane(path, trajectory.t[starts], states, MODE_LOOKS)


def reversal_marks(reference: Trajectory, units: MotionUnits = SLIDES) -> list[s.Item]:
    """Each reversal as a dotted pair on the acceleration, and as a sentence with the jump."""
    events = reference.events.of(EventKind.REVERSAL, EventKind.STICK)
    if not len(events):
        return []
    before = s.Marks("/acceleration/before", "before a reversal", events.t, events.a_before, "#f5f0e1", 3.0, "circle")
    after = s.Marks("/acceleration/after", "after it", events.t, events.a_after, "#ffd54a", 3.5, "diamond")
    return [before, after, s.Log("/reversals", events.t, [_sentence(reference, i, units) for i in range(len(events))])]


def _sentence(reference: Trajectory, i: int, u: MotionUnits) -> str:
    events = reference.events.of(EventKind.REVERSAL, EventKind.STICK)
    jump = events.a_after[i] - events.a_before[i]
    what = "sticks" if events.kind[i] == EventKind.STICK else f"reversal {i + 1}"
    return (
        f"{events.t[i]:.6f} s: {what} at x = {events.x[i] * 1e3:.3f} {u.small}, acceleration jumps by {jump:+.4g}"
        f" {u.a} (from {events.a_before[i]:.4g} to {events.a_after[i]:.4g})"
    )


def _frames(trajectory: Trajectory) -> FloatArray:
    return np.linspace(trajectory.t[0], trajectory.t[-1], min(FRAMES, len(trajectory)))


def _orbit(trajectory: Trajectory, chosen: IntArray, path: str, color: str, scale: float) -> s.Orbit:
    points = np.column_stack([trajectory.x[chosen], trajectory.v[chosen] / scale])
    at = _frames(trajectory)
    x, v = (np.interp(at, trajectory.t, values) for values in (trajectory.x, trajectory.v))
    return s.Orbit(path, trajectory.source.label, points, color, (at, np.column_stack([x, v / scale])))


def _phase_scale(trajectories: Sequence[Trajectory]) -> float:
    """Speed that is drawn as long as one metre of position: a whole power of ten, so that ticks stay readable."""
    x = max(float(np.ptp(trajectory.x)) for trajectory in trajectories)
    v = max(float(np.ptp(trajectory.v)) for trajectory in trajectories)
    return 10.0 ** round(float(np.log10(v / x))) if x > 0.0 and v > 0.0 else 1.0


def _plane(trajectories: Sequence[Trajectory], u: MotionUnits) -> s.Grid:
    x, y = _plane_bounds(trajectories)
    axes = (f"x / {u.small}", 1e3), (f"v / ({u.small}/s)", 1e3 * _phase_scale(trajectories))
    return plane_grid("/phase/axes", x, y, *axes)


def _plane_bounds(trajectories: Sequence[Trajectory]) -> tuple[tuple[float, float], tuple[float, float]]:
    scale = _phase_scale(trajectories)
    return padded([tr.x for tr in trajectories], 0.05), padded([tr.v / scale for tr in trajectories], 0.05)


def _bodies(
    trajectories: Sequence[Trajectory], slugs: Sequence[str], palette: Sequence[str], urdf: Path | None, turns: bool
) -> tuple[list[s.Body], float]:
    """One model a source, side by side, all with the same exaggeration of the motion; an angle is drawn as it is."""
    if urdf is None:
        return [], 1.0
    largest = max(float(np.max(np.abs(tr.x))) for tr in trajectories)
    factor = 1.0
    if not turns and largest > 0.0 and not 0.3 * RAIL < largest <= RAIL:
        exponent = np.floor(np.log10(RAIL / largest))
        step = RAIL / largest / 10.0**exponent
        factor = float(max(nice for nice in (1.0, 2.0, 5.0) if nice <= step) * 10.0**exponent)
    bodies = []
    for i, (trajectory, slug, color) in enumerate(zip(trajectories, slugs, palette, strict=True)):
        at = _frames(trajectory)
        values = np.interp(at, trajectory.t, trajectory.x) * factor
        bodies.append(s.Body(f"/model-{slug}", trajectory.source.label, urdf, at, values, (0.0, -0.42 * i, 0.0), color))
    return bodies, factor


def _layout(
    trajectories: Sequence[Trajectory],
    errors: Sequence[FloatArray],
    bodies: Sequence[s.Body],
    factor: float,
    lanes: bool,
    turns: bool,
) -> s.Layout:
    names = (
        ("angle / rad", "acceleration / (rad/s²)", "mrad") if turns else ("position / m", "acceleration / (m/s²)", "mm")
    )
    position = s.Plot(names[0], ["/position"], roomy([tr.x for tr in trajectories]))
    acceleration = s.Plot(names[1], ["/acceleration"], roomy([tr.a for tr in trajectories]))
    left: list[s.Layout] = [position]
    shares = [3.0]
    if errors:
        left.append(s.Plot(f"error against the reference / {names[2]}", ["/error"], roomy([e * 1e3 for e in errors])))
        shares.append(2.6)
    left.append(acceleration)
    shares.append(3.0)
    if lanes:
        left.append(s.Lanes("stick and slip", ["/contact"]))
        shares.append(0.9 + 0.45 * len(trajectories))
    x, y = _plane_bounds(trajectories)
    right: list[s.Layout] = []
    if bodies:
        name = "sliders" if factor == 1.0 else f"sliders, motion x {factor:g}"
        middle = -0.21 * (len(bodies) - 1)
        eye = (0.0, 1.6 * middle - 1.35, 1.5 - 0.35 * middle)
        right.append(s.Space(name, [b.path for b in bodies], eye, (0.0, 1.15 * middle, -0.1)))
    right.append(s.Plane("phase portrait, v over x", ["/phase"], x, y))
    pages: list[s.Layout] = [s.Words("notes", "/notes"), s.Words("parameters", "/parameters")]
    if len(trajectories[0].events):
        pages.append(s.Events("reversals", "/reversals"))
    right.append(s.Tabs(pages))
    return s.Columns([s.Rows(left, shares), s.Rows(right)], [3.0, 2.0])


def _parameters(scenario: Mapping[str, Any], trajectories: Sequence[Trajectory]) -> str:
    """Slider, scenario, and every source's version and settings as a page."""
    lines = ["# Parameters", "", *_table(scenario)]
    for trajectory in trajectories:
        source = trajectory.source
        step = "exact" if source.dt is None else f"step {source.dt:g} s"
        lines += [
            "",
            f"## {source.label}",
            "",
            f"version {source.version or 'unknown'}, {step}, {len(trajectory)} samples",
            "",
        ]
        lines += _table(source.settings)
        if source.ignored:
            lines += ["", "Not honoured:", *(f"- {sentence}" for sentence in source.ignored)]
    return "\n".join(lines)


def _table(values: Mapping[str, Any]) -> list[str]:
    if not values:
        return []
    rows = []
    for name, value in values.items():
        if isinstance(value, Mapping):
            rows += [f"| {name}.{inner} | {_cell(v)} |" for inner, v in value.items()]
        else:
            rows.append(f"| {name} | {_cell(value)} |")
    return ["| name | value |", "|---|---|", *rows]


def _cell(value: object) -> str:
    return f"{value:.10g}" if isinstance(value, float) else str(value).replace("|", "/")
