"""The trace of a robot's joint in the engines: the robot, its creep under a load, and a swing."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from harness.core.robot.bodies import Bodies
from harness.core.trajectory import Trajectory
from harness.show import scene as s
from harness.show.axes import roomy
from harness.show.palette import of_engines
from harness.show.robot.scene import robot_view
from harness.show.robot.shown import HELD, SWING, kept

_PLACES = {False: ("deg", np.degrees(1.0)), True: ("mm", 1e3)}


def joint_scene(
    result: Mapping[str, Any], held: Sequence[Trajectory], swings: Sequence[Trajectory], robot: Bodies, notes: str
) -> s.Scene:
    """held, swings : one an engine and preset. robot : moves as the first swing. notes : Markdown."""
    items, space = robot_view(robot, "the robot, swinging" if swings else "the robot")
    items.append(s.Page("/notes", notes))
    unit, scale = _PLACES[result["slides"]]
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
    properties = {"result": dict(result), "notes": {"text": notes}}
    return s.Scene(f"{result['joint']} in engines", items, layout, blobs, properties)
