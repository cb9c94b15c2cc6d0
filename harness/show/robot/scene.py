"""What a trace shows of a robot: itself, moving as the log, and the torque that is left of its joints."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.robot.bodies import Bodies
from harness.core.trajectory import Trajectory
from harness.results.diagnosis import DiagnosisResult
from harness.results.run import JointRunResult
from harness.show import scene as s
from harness.show.numbers import of_engines
from harness.show.robot.shown import (
    AFTER,
    AFTER_NAME,
    BEFORE,
    BEFORE_NAME,
    HELD,
    SWING,
    Left,
    Shown,
    binned,
    kept,
    moved_in,
    packed,
    slug,
)
from harness.show.scene import padded, plane_grid, roomy

_CORNER = np.array([0.62, -0.7, 0.36])
"""The direction from which a robot is looked at."""
_AWAY = 1.6
"""Distance over the radius of the ball that holds all of it."""
_FRAMES = 1500
"""Places of a moving point."""


def robot_view(bodies: Bodies, name: str = "the robot, as logged") -> tuple[list[s.Item], s.Space]:
    """The robot and how it is looked at: so that all it reaches is in sight."""
    low, high = _box(bodies)
    middle = 0.5 * (low + high)
    eye = middle + _AWAY * 0.5 * max(float(np.linalg.norm(high - low)), 1e-3) * _CORNER
    to, at = ((float(x), float(y), float(z)) for x, y, z in (eye, middle))
    return [s.Robot("/robot", bodies)], s.Space(name, ["/robot"], to, at)


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


def torque_views(left: Left, joint: str, units: Mapping[str, str]) -> tuple[list[s.Item], list[s.Layout]]:
    """Torque that is left of each joint over time, speed and position, before and after; a tab a joint, that asked
    for first. units : of each joint's torque."""
    items: list[s.Item] = []
    tabs: list[s.Layout] = []
    for name in sorted(left, key=lambda one: one != joint):
        rows, own = left[name], f"/left/{slug(name)}"
        unit, place = units[name], moved_in(units[name])
        t, before, after = rows[:, 0], rows[:, 3], rows[:, 4]
        items.append(s.Marks(f"{own}/time/before", BEFORE_NAME, t, before, BEFORE, 1.5))
        items.append(s.Marks(f"{own}/time/after", AFTER_NAME, t, after, AFTER, 1.5))
        planes: list[s.Layout] = []
        for what, column, per in (("speed", 2, f"{place}/s"), ("position", 1, place)):
            drawn, view = _plane(rows, column, f"{own}/{what}", (f"{name}: torque left over {what}", what, per, unit))
            items += drawn
            planes.append(view)
        time = s.Plot(f"{name}: torque left / ({unit})", [f"{own}/time"], roomy([before, after]))
        tabs.append(s.Rows([time, *planes], [1.0, 1.3, 1.3], name))
    return items, tabs


def _plane(rows: FloatArray, column: int, path: str, words: tuple[str, str, str, str]) -> tuple[list[s.Item], s.Plane]:
    """Means of the torque left over speed or position, and a point that moves with the log."""
    title, what, per, unit = words
    means = binned(rows, column)
    at, torque = means[:, column], means[:, 3:]
    # a plane of the viewer has one scale: the torque is drawn as large as a third of what it stands over
    scale = float(np.ptp(at)) / (2.0 * max(float(np.ptp(torque)), 1e-300))
    items: list[s.Item] = []
    some = rows[:: max(1, -(-rows.shape[0] // _FRAMES))]
    for name, k, color in ((BEFORE_NAME, 3, BEFORE), (AFTER_NAME, 4, AFTER)):
        points = np.column_stack((at, means[:, k] * scale))
        moving = np.column_stack((some[:, column], np.interp(some[:, column], at, points[:, 1])))
        items.append(s.Orbit(f"{path}/{k}", name, points, color, (some[:, 0], moving), 2.0))
    x, y = padded([at], 0.06), padded([torque[:, 0] * scale, torque[:, 1] * scale], 0.15)
    per = f"({per})" if "/" in per else per
    axes = ((f"{what} / {per}", 1.0), (f"torque / ({unit})", 1.0 / scale))
    items.append(plane_grid(f"{path}/axes", x, y, *axes))
    return items, s.Plane(title, [path], x, y)


def units_of(result: DiagnosisResult) -> dict[str, str]:
    """Unit of the torque of each joint that a result is of."""
    robot = result.robot
    assert robot is not None
    own = {robot.joint: result.baseline.parameters["f_k"].unit}
    if robot.arm is not None:
        own |= {one.joint: one.f_k.unit for one in robot.arm.joints}
    return own


def arm_scene(result: DiagnosisResult, shown: Shown, notes: str) -> s.Scene:
    """The trace of an arm that moves as a whole. notes : Markdown."""
    assert result.robot is not None
    items, space = _robot(shown)
    more, tabs = torque_views(shown.left, result.robot.joint, units_of(result))
    engines, plots = _engines(result, shown)
    verdict = s.Words("verdict", "/notes")
    torque: list[s.Layout] = [s.Tabs([*tabs, *plots])] if tabs or plots else []
    layout = s.Columns([s.Rows([*space, verdict]), *torque])
    title = f"joints of {result.robot.file.rpartition('/')[2]}"
    properties = {"result": s.kept(result), "notes": {"text": notes}}
    return s.Scene(title, [s.Page("/notes", notes), *items, *more, *engines], layout, packed(shown), properties)


def with_robot(scene: s.Scene, result: DiagnosisResult, shown: Shown) -> s.Scene:
    """The trace of a joint's diagnosis with the robot and the joint's torque beside what it has."""
    assert result.robot is not None
    items, space = _robot(shown)
    more, tabs = torque_views(shown.left, result.robot.joint, units_of(result))
    engines, plots = _engines(result, shown)
    found = scene.layout
    assert isinstance(found, s.Columns)
    curves, side = found.parts
    assert isinstance(side, s.Rows)
    views = s.Tabs([*side.parts[:1], *tabs, *plots, *side.parts[1:]])
    layout = s.Columns([curves, s.Rows([*space, views])], found.shares)
    blobs = {**scene.blobs, **packed(shown)}
    return replace(scene, items=[*scene.items, *items, *more, *engines], layout=layout, blobs=blobs)


def _robot(shown: Shown) -> tuple[list[s.Item], list[s.Layout]]:
    if shown.bodies is None:
        return [], []
    items, view = robot_view(shown.bodies)
    return items, [view]


def _engines(result: DiagnosisResult, shown: Shown) -> tuple[list[s.Item], list[s.Layout]]:
    """Engine minus log, before and after, over time."""
    items: list[s.Item] = []
    plots: list[s.Layout] = []
    place = moved_in(next(iter(units_of(result).values())))
    for motion in shown.motions:
        path, sides = f"/simulated/{motion.engine}", []
        for key, name, y, color in (
            ("before", "the model as it is", motion.before, BEFORE),
            ("after", "with what is pasted", motion.after, AFTER),
        ):
            sides.append(y - motion.logged)
            items.append(s.Line(f"{path}/{key}", name, motion.t, sides[-1], color))
        plots.append(s.Plot(f"{motion.engine} minus log / {place}", [path], roomy(sides)))
    return items, [s.Rows(plots, name="in engines")] if plots else []


_PLACES = {False: ("deg", np.degrees(1.0)), True: ("mm", 1e3)}


def joint_scene(
    result: JointRunResult, held: Sequence[Trajectory], swings: Sequence[Trajectory], robot: Bodies, notes: str
) -> s.Scene:
    """held, swings : one an engine and preset. robot : moves as the first swing. notes : Markdown."""
    items, space = robot_view(robot, "the robot, swinging" if swings else "the robot")
    items.append(s.Page("/notes", notes))
    unit, scale = _PLACES[result.slides]
    plots: list[s.Layout] = []
    for path, title, motions in (
        ("/creep", f"creep under the load / {unit}", held),
        ("/swing", f"swing / {unit}", swings),
    ):
        curves = [(one.x - (one.x[0] if path == "/creep" else 0.0)) * scale for one in motions]
        for one, y, color in zip(motions, curves, of_engines([m.source for m in motions]), strict=True):
            items.append(s.Line(f"{path}/{one.source.name}-{one.source.preset}", one.source.label, one.t, y, color))
        if motions:
            plots.append(s.Plot(title, [path], roomy(curves)))
    right = [s.Rows(plots)] if plots else []
    layout = s.Columns([s.Rows([space, s.Words("what engines make of it", "/notes")]), *right])
    blobs = kept(HELD, held) | kept(SWING, swings)
    properties = {"result": s.kept(result), "notes": {"text": notes}}
    return s.Scene(f"{result.joint} in engines", items, layout, blobs, properties)
