"""Pages of robots: an arm that moves as a whole, one joint in the engines, logs that are compared."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from harness.core.errors import short_names
from harness.core.quantity import Quantity
from harness.core.trajectory import Trajectory
from harness.results.common import P
from harness.results.diagnosis import DiagnosisResult
from harness.results.fleet import FleetResult, FleetRow
from harness.results.robot import (
    CurveResult,
    EntryResult,
    IdentifiableResult,
    JointResult,
    MatchResult,
    PasteResult,
    RobotResult,
    SimulatedResult,
)
from harness.results.run import JointRunResult
from harness.show import blocks as b
from harness.show.numbers import number, of_engines, of_names, quantity, shown_unit
from harness.show.plots import GROUP, axes, curve, dots, per, plain, some
from harness.show.report.page import made_with
from harness.show.stored import AFTER, AFTER_NAME, BEFORE, BEFORE_NAME, Left, Motion, Shown, moved_in

_FRICTION = {"f_k": "Coulomb", "c": "viscous", "slow": "slow", "middle": "middle", "fast": "fast"}
_AS_IT_IS, _PASTED = "the model as it is", "with what is pasted"
_POINTS = 6000
_STILL: dict[str, Any] = {"meta": {"curve": False}}


def _robot_of(result: DiagnosisResult) -> RobotResult:
    assert result.robot is not None
    return result.robot


def arm_page(result: DiagnosisResult, shown: Shown) -> b.Page:
    """Friction of an arm's joints, and the torque that is left."""
    robot = _robot_of(result)
    assert robot.arm is not None
    said = result.statement
    table, named = _joints(robot.arm.joints, robot.joint), [_found(robot.arm.found)] if robot.arm.found else []
    if any(one.joint == robot.joint for one in robot.arm.joints):
        over_speed, engines, *more = joint_beside(result, shown)
        sections = [b.verdict(said, result.warnings), over_speed, engines, table, *named, *more]
        title = f"Friction of {robot.joint}"
    else:
        curved = [one for one in robot.arm.joints if one.curve is not None]
        own = Shown({name: rows[:: len(curved)] for name, rows in shown.left.items()}, shown.motions)
        curves = [_curve(one.joint, one.curve, own.left) for one in curved]
        each = [*(one.statement for one in robot.arm.joints), *(one.statement for one in robot.arm.found)]
        each = [*each, *result.warnings]
        sections = [
            b.verdict(f"Friction of {len(curved)} joints of an arm that moves as a whole.", each),
            table,
            *curves,
        ]
        sections += [*_of_models(result, own, "rad"), *named, *_told(result)]
        title = "Friction of every joint"
    return b.Page(title, result.recording.file, [*sections, made_with(result.machine, result.files, result.command)])


def match_page(result: DiagnosisResult) -> b.Page:
    """Of a log that does not go together with its model."""
    robot = _robot_of(result)
    sections = [
        b.verdict(result.statement, result.warnings),
        _matches(robot.match),
        made_with(result.machine, result.files, result.command),
    ]
    return b.Page(f"Log and model of {robot.joint}", result.recording.file, sections)


def joint_beside(result: DiagnosisResult, shown: Shown) -> list[b.Section]:
    """What is said of any robot's joint: torque that is left, engines against the log, pairs, what to paste."""
    robot, unit = _robot_of(result), result.baseline.parameters["f_k"].unit
    return [
        _curve(robot.joint, result.curve, shown.left),
        *_of_models(result, shown, moved_in(unit)),
        _torque(robot.joint, shown.left, unit),
        *_told(result),
    ]


def _of_models(result: DiagnosisResult, shown: Shown, place: str) -> list[b.Section]:
    """The copy of the model in engines. place : rad or m."""
    robot = _robot_of(result)
    return [_in_engines(robot.joint, robot.simulated, shown.motions, place)] if robot.simulated else []


def _told(result: DiagnosisResult) -> list[b.Section]:
    """What a log cannot tell apart, how it goes with its model, and what to paste."""
    robot = _robot_of(result)
    pairs = [" and ".join(pair) for pair in robot.confounded]
    return [
        *([_identifiable(robot.identifiable)] if robot.identifiable else []),
        *([b.verdict("", pairs, heading="What this log cannot distinguish")] if pairs else []),
        *([_matches(robot.match)] if robot.match else []),
        to_paste(robot.paste, result.model_left_out),
    ]


_BAND = "rgba(43, 127, 214, 0.22)"
_RAW_NAME, _FRICTION_NAME = "the model as it is", "the model as corrected"


def _curve(joint: str, found: CurveResult | None, left: Left) -> b.Section:
    """Torque minus the rigid model over speed, before and after, with the curve; its laws, and what it changes with."""
    heading = f"Friction of {joint} over its speed"
    if found is None or joint not in left:
        return b.Section(heading, [])
    place = moved_in(found.unit)
    rows = left[joint][:: max(1, -(-left[joint].shape[0] // _POINTS))]
    traces = [
        dots(of, rows[:, 2], rows[:, k], {"size": 3, "color": color, "opacity": 0.35}, "%{y:.4g}<br>%{x:.4g}", **_STILL)
        for of, k, color in ((_RAW_NAME, 5, BEFORE), (_FRICTION_NAME, 6, AFTER))
    ]
    half = len(found.v) // 2
    for side in (slice(0, half), slice(half, None)):
        v, low, high = found.v[side], found.low[side], found.high[side]
        edge = plain("", v, low, "rgba(0,0,0,0)", 0.0, showlegend=False, hoverinfo="skip")
        band = {
            "name": "its band of 95 %",
            "y": high,
            "fill": "tonexty",
            "fillcolor": _BAND,
            "showlegend": side.start == 0,
        }
        traces += [
            edge,
            edge | band,
            plain("the curve", v, found.friction[side], "ink", 2.4, showlegend=side.start == 0),
        ]
    f_k, c = (q.value or 0.0 for q in found.line)
    at = np.array([found.v[0], 0.0, 0.0, found.v[-1]])
    pasted = c * at + f_k * np.array([-1.0, -1.0, 1.0, 1.0])
    traces.append(plain("the line that is pasted", at, pasted, "muted", 1.4, mode="lines"))
    layout = axes(f"speed / ({place}/s)", f"torque minus rigid model / {per(found.unit)}", showlegend=True)
    figure = b.Figure(
        f"friction-curve-{joint}", traces, layout, "Guarded samples. The band is as wide as blocks of time differ."
    )
    laws = []
    for one in found.laws:
        numbers = ", ".join(f"{name} {_said(p)}" for name, p in one.parameters.items())
        laws.append(f"{one.name}, probability {one.probability:.2f}: {numbers}")
    zero = [("break-away", found.break_away), ("distance of presliding", found.presliding)]
    beside = [
        *(f"{name}: {'not seen in this log' if p is None else _said(p)}" for name, p in zero),
        *(
            f"change with {one.what}: {one.why if one.by is None else _said(one.by)}{', surely' if one.surely else ''}"
            for one in found.changes
        ),
    ]
    said = b.Items(laws, "Candidate laws"), b.Items(beside, "At its zero, and with what else it changes")
    return b.Section(heading, [figure, *said])


def _said(p: P) -> str:
    return str(Quantity(p.value, p.stderr, p.unit, why=p.why))


def _torque(joint: str, left: Left, unit: str) -> b.Section:
    """joint : whose torque is drawn. unit : of it, of a hinge N m."""
    figures, place = list[b.Figure](), moved_in(unit)
    rows = left.get(joint, np.empty((0, 5)))
    rows = rows[:: max(1, -(-rows.shape[0] // _POINTS))]
    alike = np.array_equal(rows[:, 3], rows[:, 4])  # no term was found
    caption = "Guarded samples: the torque minus the rigid model, Coulomb and viscous friction and an offset."
    for name, at, along, said in (("speed", 2, f"{place}/s", caption), ("position", 1, place, "")):
        traces = [
            dots(
                of,
                rows[:, at],
                rows[:, column],
                {"size": 4, "color": color, "opacity": 0.6},
                "%{y:.4g}<br>%{x:.4g}",
                **_STILL,
            )
            for of, column, color in ((BEFORE_NAME, 3, BEFORE), (AFTER_NAME, 4, AFTER))[: 1 if alike else 2]
        ]
        layout = axes(f"{name} / {per(along)}", f"residual torque / ({unit})", showlegend=True)
        figures.append(b.Figure(f"left-{name}", traces, layout, said))
    return b.Section(f"Residual torque of {joint}", figures if joint in left else [])


def _in_engines(joint: str, simulated: Sequence[SimulatedResult], motions: Sequence[Motion], place: str) -> b.Section:
    """motions : one an engine. place : rad or m."""

    def rms(side: str, c: str) -> Callable[[SimulatedResult], str]:
        return lambda one: number(getattr(one, side)[c], 3)

    columns = [
        b.Column("position, as it is", rms("before", "x"), place, "rms of simulation minus log"),
        b.Column(_PASTED, rms("after", "x"), place),
        b.Column("speed, as it is", rms("before", "v"), f"{place}/s"),
        b.Column(_PASTED, rms("after", "v"), f"{place}/s"),
    ]
    notes = []
    for one in simulated:
        notes += [f"{_version(one)}: {one.error}"] if one.error else one.left_out
    window = next((one.window_s for one in simulated if one.window_s), None)
    caption = "" if window is None else (
        f"{'Each joint in turn' if joint == 'all' else joint} is driven by the torque of the log and the other joints"
        f" are led along it, in windows of {window:g} s that each begin at the smoothed log."
    )  # fmt: skip
    table = b.tabulated(
        "engine",
        columns,
        [one for one in simulated if not one.error],
        _version,
        lambda one: f"step {1e3 * one.dt_s:g} ms, {one.windows} windows",
        caption=caption,
        footnotes=notes,
    )
    return b.Section("Your model against the log, before and after", [table, *engine_figures(motions, place)])


def engine_figures(motions: Sequence[Motion], place: str) -> list[b.Figure]:
    """Engine minus log, before and after, over time. place : rad or m."""
    found = []
    for motion in motions:
        traces = [
            curve(said, motion.t, y - motion.logged, color, place, connectgaps=False)
            for said, y, color in ((_AS_IT_IS, motion.before, BEFORE), (_PASTED, motion.after, AFTER))
        ]
        layout = axes("time / s", f"{motion.engine} minus log / {place}", showlegend=True)
        found.append(b.Figure(f"engine-{motion.engine}", traces, layout, "", GROUP, 280))
    return found


def _version(one: SimulatedResult) -> str:
    whose = "" if one.joint is None else f"{one.joint}, "
    return f"{whose}{one.engine} {one.version}".strip()


def _identifiable(found: Sequence[IdentifiableResult]) -> b.Section:
    columns = [
        b.Column("verdict", lambda one: one.verdict),
        b.Column("error", lambda one: _or_none(one.error, 100.0), "%", "that it would have, of the joint's torque"),
        b.Column("why", lambda one: b.Cell(one.why or "-", (one.mend,) if one.mend else ())),
    ]
    table = b.tabulated("joint", columns, found, lambda one: f"{one.joint}, {one.parameter}")
    return b.Section("Identifiable parameters", [table])


def _matches(match: Sequence[MatchResult]) -> b.Section:
    columns = [
        b.Column("by", lambda one: one.by or "-", "", "what loads the joint"),
        b.Column("correlation", lambda one: _or_none(one.correlation), "", "of logged and modelled torque"),
        b.Column("slope", lambda one: _or_none(one.slope), "", "logged over modelled torque"),
        b.Column("offset", lambda one: number(one.offset, 3)),
    ]
    if any(one.suspicion for one in match):
        columns.append(
            b.Column("what looks wrong", lambda one: b.Cell(one.suspicion or "-", (one.option,) if one.option else ()))
        )
    tables = [b.tabulated("joint", columns, match, lambda one: one.joint)] if match else []
    return b.Section("The log against its model", tables)


def to_paste(paste: PasteResult, left_out: Sequence[str] = ()) -> b.Section:
    """left_out : what those formats have no word for, a sentence each."""
    lines = paste.urdf.splitlines()
    dynamics, calls = ("\n".join(line for line in lines if line.startswith("<") is own) for own in (True, False))
    blocks: list[b.Block] = [
        b.Code(paste.mjcf, "MJCF, in the joint's element"),
        b.Code(dynamics, "URDF, in the joint's element"),
    ]
    blocks += [b.Code(calls, "PyBullet, for what it does not read of a URDF")] if calls else []
    others = [
        b.Code(text, title)
        for title, text in {
            "Isaac Lab, and PhysX in a USD": paste.isaac,
            "Newton": paste.newton,
            "SDF": paste.sdf,
            "Genesis": paste.genesis,
            "Drake": paste.drake,
            "ROS 2, for a controller": paste.ros2,
        }.items()
        if text
    ]
    blocks += [b.Folded("For other engines and a controller", others)] if others else []
    blocks += [b.Items(left_out, "What these formats cannot express")] if left_out else []
    return b.Section("What to paste into the model", blocks)


def _joints(joints: Sequence[JointResult], first: str) -> b.Section:
    """first : the one that was asked for."""
    columns = [
        b.Column("Coulomb", lambda one: _with_unit(one.f_k)),
        b.Column("viscous", lambda one: _with_unit(one.c)),
        b.Column("offset", lambda one: _with_unit(one.offset)),
        b.Column("residual", lambda one: number(one.held_out_before, 3), "", "rms of torque that was not fitted"),
        b.Column("refined", lambda one: number(one.held_out_after, 3), "", "the same with every term"),
        b.Column(
            "over noise",
            lambda one: number(one.over_noise, 3),
            "",
            "rms of the residual over that of the torque's noise",
        ),
    ]
    table = b.tabulated(
        "joint", columns, joints, lambda one: one.joint, lambda one: "--joint" if one.joint == first else ""
    )
    return b.Section("Friction of every joint", [table])


def _with_unit(p: P) -> b.Cell:
    if p.value is None:
        return b.Cell("-", (p.why or "",))
    value, stderr, unit = quantity(p)
    return b.Cell(value, (f"\u00b1 {stderr} {unit}" if stderr else unit,))


def _found(found: Sequence[EntryResult]) -> b.Section:
    """Everything named, of friction and of the model."""
    columns = [
        b.Column("of", lambda one: one.joint or "the arm"),
        b.Column("or", lambda one: ", ".join(filter(None, (one.partner, *one.rivals))) or "-"),
        b.Column("grade", lambda one: one.grade),
        b.Column("probability", lambda one: number(one.probability, 2)),
        b.Column("explains", lambda one: f"{100.0 * one.share:.0f}", "%"),
        b.Column("evidence", lambda one: number(one.evidence, 3)),
    ]
    return b.Section("Further effects", [b.tabulated("name", columns, found, lambda one: one.name)])


def joint_page(result: JointRunResult, held: Sequence[Trajectory], swings: Sequence[Trajectory]) -> b.Page:
    """A robot's joint in the engines. held, swings : its motions."""
    first, *rest = result.conclusions
    sections = [
        b.verdict(first, rest),
        *([_scores(result, held, swings)] if result.scores else []),
        *([_servo(result)] if result.servo is not None else []),
        to_paste(result.paste),
        made_with(result.machine, result.files, result.command),
    ]
    return b.Page(f"What engines make of {result.joint}", result.file, sections)


def _scores(result: JointRunResult, held: Sequence[Trajectory], swings: Sequence[Trajectory]) -> b.Section:
    """Creep and lead, in numbers and as motions."""
    unit, scale = _moved(result)
    columns = [
        b.Column("creep", str, f"{unit}/s", "under the load; a real joint does not move"),
        b.Column("lead", str, "ms", "by which friction reverses before the velocity"),
    ]
    rows, notes = [], []
    for one in result.scores:
        if one.error:
            notes.append(f"{one.engine} {one.preset}: {one.error}")
            continue
        cells = [b.Cell(_or_none(one.creep, scale)), b.Cell(_or_none(one.reversal_lead_s, 1e3))]
        rows.append(b.Row(f"{one.engine} {one.preset}", cells, f"step {1e3 * (one.dt_s or 0.0):.3g} ms"))
    for own in result.as_it_is:
        creep = "it diverges" if own.diverges_after else _or_none(own.creep, scale)
        label = f"your file itself, {own.engine} {own.preset}"
        rows.append(b.Row(label, [b.Cell(creep), b.Cell("-")], f"step {1e3 * own.dt_s:.3g} ms"))
    table = b.Table("engine", columns, rows, footnotes=notes)
    return b.Section("Creep and lead", [table, *motion_figures(result, held, swings)])


def motion_figures(result: JointRunResult, held: Sequence[Trajectory], swings: Sequence[Trajectory]) -> list[b.Figure]:
    """Creep under the load, and the swing, by engine."""
    figures, (unit, scale) = [], _moved(result)
    for name, motions in (("creep", held), ("swing", swings)):
        hues = of_engines([motion.source for motion in motions])
        traces = [
            curve(one.source.label, one.t, (one.x - (one.x[0] if name == "creep" else 0.0)) * scale, color, unit, 1.8)
            for one, color in zip(motions, hues, strict=True)
        ]
        figures.append(b.Figure(name, traces, axes("time / s", f"{name} / {unit}", showlegend=True), "", "", 300))
    return some(figures)


def _moved(result: JointRunResult) -> tuple[str, float]:
    """Unit in which its motion is drawn, and how many of it one rad or m is."""
    return ("mm", 1e3) if result.slides else ("deg", float(np.degrees(1.0)))


def _servo(result: JointRunResult) -> b.Section:
    """What a step does to the servo of the joint."""
    servo = result.servo
    assert servo is not None

    def told(name: str) -> Callable[[Any], str]:
        return lambda one: _or_none(getattr(one, name)) if one.stable else "it diverges"

    unit = "N s/m" if result.slides else "N m s/rad"
    columns = [
        b.Column("false damping", told("false_damping"), unit, "beyond what was asked for"),
        b.Column("zeta", told("zeta")),
    ]
    caption = f"It has zeta {_or_none(servo.zeta)}; the step is {1e3 * servo.step_s:.3g} ms."
    table = b.tabulated("who computes it", columns, servo.scores, lambda one: one.who, caption=caption)
    return b.Section("What the step does to its servo", [table])


def _or_none(value: float | None, times: float = 1.0) -> str:
    return "-" if value is None else number(value * times, 3)


def fleet_sections(fleet: FleetResult) -> list[b.Section]:
    """What logs of one robot say together: which joint's friction is not the same in all."""
    first, *more = fleet.statements
    names = short_names([log.file for log in fleet.logs])
    logs = [names[log.file] for log in fleet.logs]
    trends = dict.fromkeys(t.name for row in fleet.rows for t in row.trends)
    columns = [
        *(b.Column(name, b.by(i, lambda row, i: _or_dash(row.values[i]))) for i, name in enumerate(logs)),
        b.Column("between logs", _between, "%", "standard deviation beyond errors, of the mean"),
        b.Column("the same?", _same, "", "probability of such a scatter where it is"),
        *(b.Column(f"per {name}", b.by(name, _slope)) for name in trends),
    ]
    table = b.tabulated(
        "joint",
        columns,
        fleet.rows,
        lambda row: f"{row.joint}, {_FRICTION[row.parameter]}{'' if row.speed is None else f' ({row.speed:.2g})'}",
        lambda row: shown_unit(row.mean.unit),
    )
    # where logs differ most stands first
    parameters = dict.fromkeys(row.parameter for row in sorted(fleet.rows, key=lambda row: row.chance))
    drawn = some([_spread(fleet, logs, parameter) for parameter in parameters])
    others = [b.Folded("Of the other parameters", drawn[1:])] if drawn[1:] else []
    return [
        b.verdict(first, more, heading="Over all logs"),
        b.Section("How far each log is from the mean", [*drawn[:1], *others]),
        b.Section("Joints over logs", [table]),
    ]


def _or_dash(p: P | None, grade: int | None = None) -> b.Cell:
    return b.Cell("-") if p is None else b.measured(p, grade=grade)


def _between(row: FleetRow) -> str:
    return number(100.0 * row.between / abs(row.mean.value), 2) if row.mean.value else "-"


def _same(row: FleetRow) -> b.Cell:
    return b.Cell("differs" if row.differs else number(row.chance, 2), (), 4 if row.differs else 0)


def _slope(row: FleetRow, name: str) -> b.Cell:
    one = next((trend for trend in row.trends if trend.name == name), None)
    return b.Cell("-") if one is None else _or_dash(one.slope, 4 if one.differs else None)


def _spread(fleet: FleetResult, logs: Sequence[str], parameter: str) -> b.Figure:
    """Friction of every joint over its mean, with two errors: over the condition that changes it, else the logs."""
    traces = []
    rows = [(row, row.mean.value) for row in fleet.rows if row.parameter == parameter and row.mean.value]
    changed = [trend.name for row, _ in rows for trend in row.trends if trend.differs]
    over = changed[0] if changed else ""
    places: Sequence[str | float | None] = [log.conditions.get(over) for log in fleet.logs] if over else logs
    for (row, mean), color in zip(rows, of_names(len(rows)), strict=True):
        found = zip(places, logs, row.values, strict=True)
        there = [(x, log, p) for x, log, p in found if p is not None and x is not None]
        bars = {"type": "data", "array": [2.0 * abs((p.stderr or 0.0) / mean) for _, _, p in there]}
        traces.append(
            dots(
                row.joint,
                [x for x, _, _ in there],
                [(p.value or 0.0) / mean for _, _, p in there],
                {"size": 8, "color": color},
                "%{y:.4f}<br>%{text}",
                text=[log for _, log, _ in there],
                error_y=bars,
                **_STILL,
            )
        )
    layout = axes(over or "log", f"{_FRICTION[parameter]} friction over the mean", showlegend=True)
    if not over:
        layout["xaxis"]["type"] = "category"
    return b.Figure(f"fleet-{parameter}", traces, layout, "Bars are two standard errors." if traces else "", "", 320)
