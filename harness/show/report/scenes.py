"""What a trace shows of a diagnosis, of a robot, and of several traces laid over each other.

Recording and both simulations, residuals, and where they differ as a lane of states; the robot itself, moving as the
log, and the torque that is left of its joints.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.core.robot import Bodies
from harness.core.trajectory import Trajectory
from harness.results.diagnosis import DiagnosisResult
from harness.results.run import JointRunResult
from harness.show import scene as s
from harness.show.blocks import Figure
from harness.show.numbers import REFERENCE, SLIDES, TURNS, of_engines, of_names, units_of
from harness.show.plots import ANGLES, CHANNELS, Trace, axes, curve, dots, per, plain, position_error
from harness.show.report.curves import law_figures
from harness.show.report.diagnosis import gained, said, to_change
from harness.show.report.diagnosis_figures import Curves, shaded_spans
from harness.show.report.robot import engine_figures, motion_figures
from harness.show.stored import (
    AFTER,
    AFTER_NAME,
    BEFORE,
    BEFORE_NAME,
    HELD,
    SWING,
    Shown,
    StoredTrace,
    binned,
    moved_in,
    parts_of,
)

_CORNER = np.array([0.62, -0.7, 0.36])
"""The direction from which a robot is looked at."""
_AWAY = 1.6
"""Distance over the radius of the ball that holds all of it."""


def robot_view(bodies: Bodies, name: str = "the robot, as logged") -> s.Space:
    """The robot, looked at so that all it reaches is in sight."""
    low, high = _box(bodies)
    middle = 0.5 * (low + high)
    eye = middle + _AWAY * 0.5 * max(float(np.linalg.norm(high - low)), 1e-3) * _CORNER
    to, at = ((float(x), float(y), float(z)) for x, y, z in (eye, middle))
    return s.Space(name, [bodies], to, at)


def _box(bodies: Bodies) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest corner of all that is ever drawn, m."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for shape in bodies.shapes:
        if shape.corners is not None:
            reach = float(np.max(np.linalg.norm(shape.corners, axis=1), initial=0.0))
        else:
            reach = float(np.max(shape.size))
        w, turn = bodies.turns[:, shape.body, :1], bodies.turns[:, shape.body, 1:]
        twice = 2.0 * np.cross(turn, shape.place)
        at = bodies.places[:, shape.body] + shape.place + w * twice + np.cross(turn, twice)
        low, high = np.minimum(low, at.min(axis=0) - reach), np.maximum(high, at.max(axis=0) + reach)
    return (low, high) if bodies.shapes else (np.zeros(3), np.ones(3))


def torque_tabs(result: DiagnosisResult, shown: Shown) -> list[s.Layout]:
    """Residual torque of each joint over time, speed and position, before and after; a tab a joint, that asked
    for first; then the engines against the log."""
    robot = result.robot
    assert robot is not None
    known = result.baseline.parameters.get("f_k")
    units = {} if known is None else {robot.joint: known.unit}
    if robot.arm is not None:
        units |= {one.joint: one.f_k.unit for one in robot.arm.joints}
    tabs: list[s.Layout] = []
    for name in sorted(shown.left, key=lambda one: one != robot.joint):
        rows, unit, own = shown.left[name], units[name], f"left-{s.slug(name)}"
        label = f"{name}: residual torque / ({unit})"
        traces = [
            dots(of, rows[:, 0], rows[:, k], {"color": color}, "")
            for of, k, color in ((BEFORE_NAME, 3, BEFORE), (AFTER_NAME, 4, AFTER))
        ]
        place = moved_in(unit)
        planes = [
            _plane(f"{own}-{what}", rows, column, axes(f"{what} / {per(along)}", label))
            for what, column, along in (("speed", 2, f"{place}/s"), ("position", 1, place))
        ]
        time = Figure(f"{own}-time", traces, axes("time / s", label))
        tabs.append(s.Rows([time, *planes], [1.0, 1.3, 1.3], name))
    plots = engine_figures(shown.motions, moved_in(units.get(robot.joint, "N m")))
    return [*tabs, s.Rows(plots, name="in engines")] if plots else tabs


def _plane(name: str, rows: FloatArray, column: int, layout: dict[str, object]) -> Figure:
    """Means of the residual torque over speed or position, and a point that moves with the log."""
    means, traces = binned(rows, column), []
    for of, k, color in ((BEFORE_NAME, 3, BEFORE), (AFTER_NAME, 4, AFTER)):
        now = rows[:, 0], rows[:, column], np.interp(rows[:, column], means[:, column], means[:, k])
        traces.append(plain(of, means[:, column], means[:, k], color, 2.0, now=now))
    return Figure(name, traces, layout)


def arm_scene(result: DiagnosisResult, shown: Shown) -> s.Scene:
    """The trace of an arm that moves as a whole."""
    assert result.robot is not None
    assert result.robot.arm is not None
    notes = s.notes_of("Verdict", [joint.statement for joint in result.robot.arm.joints], result.statement)
    tabs = torque_tabs(result, shown)
    side = s.Rows([*([robot_view(shown.bodies)] if shown.bodies else []), s.Words("verdict", notes)])
    layout = s.Columns([side, *([s.Tabs(tabs)] if tabs else [])])
    title = f"joints of {result.robot.file.rpartition('/')[2]}"
    return s.of_result(title, layout, result, notes, parts_of(shown))


def joint_scene(
    result: JointRunResult, held: Sequence[Trajectory], swings: Sequence[Trajectory], robot: Bodies
) -> s.Scene:
    """held, swings : one an engine and preset. robot : moves as the first swing."""
    title = f"What engines make of {result.joint}"
    notes = s.notes_of(title, result.conclusions)
    space = robot_view(robot, "the robot, swinging" if swings else "the robot")
    plots = motion_figures(result, held, swings)
    layout = s.Columns(
        [s.Rows([space, s.Words("what engines make of it", notes)]), *([s.Rows(plots)] if plots else [])]
    )
    return s.of_result(f"{result.joint} in engines", layout, result, notes, {HELD: held, SWING: swings})


_APART, _ELSEWHERE = "parts", "elsewhere"


def lane(spans: Sequence[Sequence[float]], start: float, stop: float) -> tuple[FloatArray, list[str]]:
    """Times (s) and states of a lane that is on in these spans."""
    times, states = [start], [_APART if spans and spans[0][0] <= start else _ELSEWHERE]
    for low, high in spans:
        if low > times[-1]:
            times.append(low)
            states.append(_APART)
        if high < stop:
            times.append(high)
            states.append(_ELSEWHERE)
    return np.array(times), states


def diagnosis_scene(
    result: DiagnosisResult, recording: Recording, simulated: Sequence[Trajectory], robot: Shown | None = None
) -> s.Scene:
    """Scene of a diagnosis; arguments as of diagnosis_page."""
    notes, laws = _notes(result), law_figures(result)
    verdict = s.Words("verdict", notes)
    side: list[s.Layout] = [verdict, *([s.Tabs(laws)] if len(laws) > 1 else laws)]
    parts: dict[str, Sequence[Trajectory | Recording]] = {"trajectory": simulated, "recording": [recording]}
    name = f"diagnosis of {recording.file.rpartition('/')[2]}"
    if recording.steady:
        # no time to draw over
        return s.of_result(name, s.Columns(side[::-1], [3.0, 2.0][-len(side) :]), result, notes, parts)
    seen = Curves(recording, simulated, result)
    curves, rests = seen.over_time(), [_from(recording.t[0], figure) for figure in seen.residuals()]
    lanes = list[s.Layout]()
    if spans := shaded_spans(result):
        looks = {_APART: ("they differ", BEFORE), _ELSEWHERE: ("elsewhere", "#3a414b")}
        states = lane(spans, float(recording.t[0]), float(recording.t[-1]))
        lanes.append(s.Lanes("where they differ", [s.Lane("where", *states, looks)]))
    shares = [*[1.4] * len(rests), *[0.5] * len(lanes), *[2.0] * len(curves)]
    plane = seen.orbit()
    side = [*side, plane]
    if robot is not None:
        side = [
            *([robot_view(robot.bodies)] if robot.bodies else []),
            s.Tabs([verdict, *laws, *torque_tabs(result, robot), plane]),
        ]
    layout = s.Columns([s.Rows([*rests, *lanes, *curves], shares), s.Rows(side)], [3.0, 2.0])
    return s.of_result(name, layout, result, notes, parts | ({} if robot is None else parts_of(robot)))


def _from(start: float, figure: Figure) -> Figure:
    """The figure from an earlier time on, s, so that its axis shows the same time as the others."""
    earlier = [{**one, "x": np.append(start, one["x"]), "y": np.append(np.nan, one["y"])} for one in figure.traces]
    return replace(figure, traces=earlier)


def _notes(result: DiagnosisResult) -> str:
    """The verdict in words, and the evidence as a table."""
    lines = [s.notes_of("Verdict", gained(result) + said(result), result.statement)]
    told = result.attribution
    if told is not None and result.has_own_simulation and (change := to_change(told)):
        lines += ["", "## What to change in your simulation", "", *(f"- {sentence}" for sentence in change)]
    if result.evidence:
        lines += ["", "## Evidence over the catalogue", ""]
        shared = any(one.share is not None for one in result.evidence)
        lines += [f"| name | better by, in BIC |{' share of the misfit |' * shared}", "|---|---|" + "---|" * shared]
        shares = ["-" if one.share is None else f"{100.0 * one.share:.0f} %" for one in result.evidence]
        rows = zip(result.evidence, shares, strict=True)
        lines += [f"| {one.name} | {one.delta_bic:.1f} |{f' {share} |' * shared}" for one, share in rows]
    return "\n".join(lines)


_DRAWN = ("x", "v", "a")


@dataclass(frozen=True, slots=True)
class _Motion:
    """One curve of a plot. t (n,) : s. channels : x, v, a that there are, (n,) each, SI."""

    name: str
    t: FloatArray
    channels: Mapping[str, FloatArray]
    of: Trajectory | None = None

    @property
    def reference(self) -> bool:
        """Whether it is what the others are held against."""
        return self.of is not None and self.of.source.name == "reference"


def overlay_scene(traces: Mapping[str, StoredTrace]) -> s.Scene:
    """Scene of several traces by name.

    The reference of several runs of one scenario is drawn once. Raises InputError where some slide and others turn.
    """
    turning = {name: _turns(trace) for name, trace in traces.items()}
    if len(set(turning.values())) > 1:
        found = ", ".join(f"{name} {'turns' if turns else 'slides'}" for name, turns in turning.items())
        raise InputError("view", found, "traces of one kind of motion together")
    motions = _motions(traces)
    hues = iter(_hues([one for one in motions if not one.reference]))
    references = [one.of for one in motions if one.reference]
    turns = any(turning.values())
    small = (TURNS if turns else SLIDES).small
    lines: dict[str, list[Trace]] = {"x": [], "error": [], "v": [], "a": []}
    labels = {"error": f"error against the reference / {small}"}
    for one in motions:
        color, width = (REFERENCE, 2.5) if one.reference else (next(hues), 1.5)
        for channel, values in one.channels.items():
            label, unit, factor = (ANGLES if turns else CHANNELS)[channel]
            labels[channel] = f"{label} / {per(unit)}"
            lines[channel].append(curve(one.name, one.t, values * factor, color, unit, width))
        if one.of is not None and not one.reference and len(references) == 1 and references[0] is not None:
            apart = 1e3 * position_error(one.t, one.of.x, references[0])
            lines["error"].append(curve(one.name, one.t, apart, color, small))
    views = [Figure(name, drawn, axes("time / s", labels[name])) for name, drawn in lines.items() if drawn]
    pages = [
        s.Words(name, (trace.properties.get("notes") or {}).get("text", f"# {name}")) for name, trace in traces.items()
    ]
    return s.Scene(", ".join(traces), s.Columns([s.Rows(views), s.Tabs(pages)], [3.0, 2.0]))


def _hues(motions: Sequence[_Motion]) -> list[str]:
    """Those of the engines, as everywhere, where they tell the motions apart; else one each."""
    engines = of_engines([one.of.source for one in motions if one.of is not None])
    return engines if len(set(engines)) == len(motions) else of_names(len(motions))


def _turns(trace: StoredTrace) -> bool:
    if trace.recordings:
        return any(recording.angular for recording in trace.recordings)
    return units_of(trace.properties.get("scenario") or {}) is TURNS


def _motions(traces: Mapping[str, StoredTrace]) -> list[_Motion]:
    """References first, one a scenario, the most finely sampled; then what every trace has, in their order."""
    references: list[tuple[object, _Motion]] = []
    others: list[_Motion] = []
    for name, trace in traces.items():
        scenario = trace.properties.get("scenario")
        for found in trace.trajectories:
            channels = {c: np.asarray(getattr(found, c)) for c in _DRAWN}
            one = _Motion(f"{name}: {found.source.label}", found.t, channels, found)
            if not one.reference:
                others.append(one)
                continue
            place = next((i for i, (known, _) in enumerate(references) if scenario and known == scenario), None)
            if place is None:
                references.append((scenario, one))
            elif one.t.size > references[place][1].t.size:
                references[place] = scenario, one
        for recording in trace.recordings:
            channels = {c: recording[c] for c in _DRAWN if c in recording}
            others.append(_Motion(f"{name}: {recording.file.rpartition('/')[2]}", recording.t, channels))
    first = [one for _, one in references]
    if len(first) == 1 and first[0].of is not None:
        first = [replace(first[0], name=first[0].of.source.label)]
    return [*first, *others]


def named(places: Sequence[str]) -> list[str]:
    """A short name for each place: its last part, or all of it where several end alike."""
    short = [place.rstrip("/").rpartition("/")[2] for place in places]
    return [one if short.count(one) == 1 else place for one, place in zip(short, places, strict=True)]
