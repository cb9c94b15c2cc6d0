"""Scenes as .rrd files for the rerun viewer, and back. The only module that imports rerun."""

import json
import sys
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import singledispatch
from pathlib import Path
from typing import Any, cast

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
import rerun_bindings
from lxml import etree
from rerun.chunk import RrdReader
from rerun.error_utils import RerunWarning
from rerun.experimental import ViewerClient
from rerun.urdf import UrdfTree

from harness.core.apart import Found
from harness.core.arrays import FloatArray
from harness.core.errors import InputError, StoreError
from harness.core.robot.bodies import Shape
from harness.core.writing import replacing
from harness.show import scene as s
from harness.show.pack import plain, unpack
from harness.show.stored import ACCEPTED, Pipe, poured, stored_of

_THINNEST = 0.05


@dataclass(frozen=True, slots=True)
class Coil:
    """visuals : which of the fixed link's visuals are rings. anchor : left end, m. length : to the body at x = 0, m."""

    visuals: tuple[int, ...]
    anchor: float
    length: float

    @classmethod
    def of(cls, urdf: Path, fixed: str, body: str) -> "Coil | None":
        """The coil drawn in this file, None when there is none. Raises OSError when the file cannot be read."""
        root = etree.parse(str(urdf)).getroot()
        rings, places = [], []
        for index, visual in enumerate(root.xpath("link[@name=$name]/visual", name=fixed)):
            if visual.xpath("material/@name") == ["spring"]:
                rings.append(index)
                places.append(float(visual.xpath("string(origin/@xyz)").split()[0]))
        if not rings:
            return None
        boxes = root.xpath("link[@name=$name]/visual/geometry/box/@size", name=body)
        half = 0.5 * max((float(size.split()[0]) for size in boxes), default=0.0)
        anchor = min(places)
        return cls(tuple(rings), anchor, -half - anchor)

    def stretch(self, x: FloatArray) -> FloatArray:
        """Length over free length when the body is at ``x``; never turned inside out."""
        return np.maximum(1.0 + x / self.length, _THINNEST)


APPLICATION = "friction-harness"
TIMELINE = "time"
BLOCK = 65_536
"""Rows in one call: larger chunks are slower to load, smaller ones larger on disk."""

_DATA, _PROPERTIES = "/data", "/__properties"
_SAMPLES, _JSON = "samples", "json"


def write_trace(path: Path, scene: s.Scene) -> None:
    """Write a scene with its blueprint as one .rrd; the file appears whole or not at all.

    Raises StoreError when it cannot be written, InputError when a robot description cannot be read.
    """
    with replacing(path) as part:
        with poured(part) as pipe:
            _stream(pipe, scene)
        # the threads and the memory of a stream that is closed stay, and a call with many recordings has many
        rerun_bindings.flush_and_cleanup_orphaned_recordings()
        _check_whole(part, path)


def _stream(pipe: Pipe, scene: s.Scene) -> None:
    recording = rr.RecordingStream(APPLICATION, send_properties=False)
    try:
        _fill(recording, pipe, scene)
    finally:
        recording.disconnect()


def _fill(recording: rr.RecordingStream, pipe: Pipe, scene: s.Scene) -> None:
    recording.save(pipe.name, default_blueprint=_blueprint(scene.layout))
    pipe.opened()
    recording.send_recording_name(scene.name)
    _send_properties(recording, scene.properties)
    for item in scene.items:
        send(item, recording)
    for name, data in scene.blobs.items():
        blob = rr.DynamicArchetype("harness", components={_SAMPLES: np.frombuffer(data, dtype=np.uint8)})
        recording.log(f"{_DATA}/{name}", blob, static=True, strict=True)
    recording.flush()


def _reader(path: Path) -> RrdReader:
    """A reader of a whole file; RerunWarning when its closing manifest is missing."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", RerunWarning)
        return RrdReader(path)


def _check_whole(part: Path, path: Path) -> None:
    """A file without its closing manifest was cut short, whatever the library has said."""
    try:
        _reader(part).store()
    except (RerunWarning, ValueError, OSError, RuntimeError) as error:
        raise StoreError(f"{path}: could not be written to its end; room on the disk is accepted") from error


def _send_properties(recording: rr.RecordingStream, properties: Mapping[str, Any]) -> None:
    for name, value in properties.items():
        shown = {k: v for k, v in value.items() if isinstance(v, (str, int, float))} if isinstance(value, dict) else {}
        named: dict[str, Any] = {k: v for k, v in shown.items() if k.isidentifier() and k != _JSON}
        recording.send_property(name, rr.AnyValues(True, **(named | {_JSON: json.dumps(value, default=plain)})))


def columns_of(path: Path) -> Found:
    """What a .rrd of ours holds, as a process of its own hands it on (harness.show.stored.read_trace)."""
    blobs: dict[str, bytes] = {}
    properties: dict[str, Any] = {}
    try:
        for chunk in _reader(path).stream().filter(is_static=True, content=[f"{_DATA}/**", f"{_PROPERTIES}/**"]):
            batch = chunk.to_record_batch()
            for column in batch.schema.names:
                if chunk.entity_path.startswith(_DATA + "/") and column.endswith(_SAMPLES):
                    values = batch.column(column).flatten().to_numpy(zero_copy_only=False)
                    blobs[chunk.entity_path.removeprefix(_DATA + "/")] = values.astype(np.uint8, copy=False).tobytes()
                elif chunk.entity_path.startswith(_PROPERTIES + "/") and column == _JSON:
                    name = chunk.entity_path.removeprefix(_PROPERTIES + "/")
                    properties[name] = json.loads(batch.column(column)[0].as_py()[0])
    except RerunWarning:
        raise InputError(str(path), "was cut short", ACCEPTED) from None
    if not blobs:
        raise InputError(str(path), "holds no trajectory of this program", "a .rrd written by it is accepted")
    columns: dict[str, FloatArray] = {}
    about: list[dict[str, Any]] = []
    for name, data in sorted(blobs.items()):
        found, said = unpack(data)
        columns |= {f"{len(about)}/{column}": values for column, values in found.items()}
        about.append({"name": name, "columns": list(found), "about": said})
    whole = {"blobs": about, "properties": properties}
    stored_of(columns, whole)  # what does not make trajectories and recordings is found here, not where it is used
    return columns, whole


def headless_viewer(port: int) -> ViewerClient:
    """A viewer without a window, listening on ``port`` of this machine; a context manager that ends it."""
    beside = Path(sys.executable).with_name("rerun")
    path = str(beside) if beside.is_file() else None
    return ViewerClient.spawn(headless=True, port=port, hide_welcome_screen=True, executable_path=path)


def _time(t: FloatArray) -> rr.TimeColumn:
    """Nanoseconds, rounded: the library would truncate floats. Exact times are in the packed data."""
    return rr.TimeColumn(TIMELINE, duration=np.rint(t * 1e9).astype("timedelta64[ns]"))


def _blocks(n: int) -> Iterator[slice]:
    return (slice(start, start + BLOCK) for start in range(0, n, BLOCK))


def _send_scalars(recording: rr.RecordingStream, item: s.Line | s.Marks) -> None:
    for block in _blocks(item.t.size):
        columns = rr.Scalars.columns(scalars=item.values[block])
        recording.send_columns(item.path, [_time(item.t[block])], columns, strict=True)


@singledispatch
def send(item: object, recording: rr.RecordingStream) -> None:
    """Send one item of a scene."""
    raise TypeError(f"no way to show a {type(item).__name__}")


@send.register
def _(item: s.Line, recording: rr.RecordingStream) -> None:
    style = rr.SeriesLines(colors=[_rgb(item.color)], widths=[item.width], names=[item.name])
    recording.log(item.path, style, static=True, strict=True)
    _send_scalars(recording, item)


@send.register
def _(item: s.Marks, recording: rr.RecordingStream) -> None:
    style = rr.SeriesPoints(
        colors=[_rgb(item.color)], markers=[item.shape], marker_sizes=[item.size], names=[item.name]
    )
    recording.log(item.path, style, static=True, strict=True)
    _send_scalars(recording, item)


@send.register
def _(item: s.Lane, recording: rr.RecordingStream) -> None:
    values, looks = list(item.looks), list(item.looks.values())
    style = rr.StateConfiguration(
        values=values, labels=[label for label, _ in looks], colors=[_rgb(color) for _, color in looks]
    )
    recording.log(item.path, style, static=True, strict=True)
    recording.send_columns(
        item.path, [_time(item.t)], rr.StateChange.columns(state=cast(Any, list(item.states))), strict=True
    )


@send.register
def _(item: s.Orbit, recording: rr.RecordingStream) -> None:
    down = np.array([1.0, -1.0])
    color = _rgb(item.color)
    strip = rr.LineStrips2D([item.points * down], colors=[color], radii=_pixels(0.5 * item.width))
    recording.log(f"{item.path}/curve", strip, static=True, strict=True)
    point = rr.Points2D.from_fields(colors=[color], radii=_pixels(4.0), labels=[item.name], show_labels=False)
    recording.log(f"{item.path}/now", point, static=True, strict=True)
    t, places = item.at
    for block in _blocks(t.size):
        columns = rr.Points2D.columns(positions=places[block] * down)
        recording.send_columns(f"{item.path}/now", [_time(t[block])], columns, strict=True)


@send.register
def _(item: s.Grid, recording: rr.RecordingStream) -> None:
    down = np.array([1.0, -1.0])
    color = _rgb(item.color)
    lines = rr.LineStrips2D(
        [strip * down for strip in item.strips], colors=[color], radii=_pixels(0.5), draw_order=-10.0
    )
    recording.log(f"{item.path}/lines", lines, static=True, strict=True)
    text = rr.Points2D(item.places * down, labels=list(item.labels), radii=[0.0], colors=[color], show_labels=True)
    recording.log(f"{item.path}/ticks", text, static=True, strict=True)


@send.register
def _(item: s.Log, recording: rr.RecordingStream) -> None:
    columns = rr.TextLog.columns(text=list(item.texts), level=["INFO"] * len(item.texts))
    recording.send_columns(item.path, [_time(item.t)], columns, strict=True)


@send.register
def _(item: s.Page, recording: rr.RecordingStream) -> None:
    document = rr.TextDocument(item.text, media_type=rr.MediaType.MARKDOWN)
    recording.log(item.path, document, static=True, strict=True)


@send.register
def _(item: s.Body, recording: rr.RecordingStream) -> None:
    prefix = f"{item.path}/".removeprefix("/")
    frame = prefix
    try:
        tree = UrdfTree.from_file_path(item.urdf, item.path.strip("/"), frame_prefix=frame)
    except (ValueError, OSError, RuntimeError) as error:
        raise InputError(str(item.urdf), f"cannot be read ({error})", "a URDF file is accepted") from None
    joint = next((j for j in tree.joints() if j.joint_type in ("prismatic", "revolute", "continuous")), None)
    if joint is None:
        raise InputError(str(item.urdf), "no joint that moves", "a URDF with a sliding or turning joint is accepted")
    tree.log_urdf_to_recording(recording)
    _dress(recording, tree, joint.child_link, _rgb(item.color))
    root = tree.root_link()
    home = rr.Transform3D(translation=item.offset, parent_frame="tf#/", child_frame=frame + root.name)
    recording.log(f"{item.path}-place", home, static=True, strict=True)
    now = [_time(item.t)]
    recording.send_columns(
        f"{item.path}-motion", now, joint.compute_transform_columns(item.values.tolist()), strict=True
    )

    coil = Coil.of(item.urdf, root.name, joint.child_link)
    if coil is None:
        return
    rings = tree.get_visual_geometry_paths(root)
    for index in coil.visuals:
        recording.log(rings[index], rr.CoordinateFrame(frame + "coil"), static=True, strict=True)
    stretch = coil.stretch(item.values)
    ones = np.ones_like(stretch)
    columns = rr.Transform3D.columns(
        translation=np.column_stack([coil.anchor * (1.0 - stretch), 0.0 * ones, 0.0 * ones]),
        scale=np.column_stack([stretch, ones, ones]),
        parent_frame=[frame + root.name] * stretch.size,
        child_frame=[frame + "coil"] * stretch.size,
    )
    recording.send_columns(f"{item.path}-coil", now, columns, strict=True)


@send.register
def _(item: s.Robot, recording: rr.RecordingStream) -> None:
    bodies = item.bodies
    for number, name in enumerate(bodies.names):
        path = f"{item.path}/{number:02d}-{''.join(c if c.isalnum() else '-' for c in name)}"
        own = [shape for shape in bodies.shapes if shape.body == number]
        for i, shape in enumerate(own):
            recording.log(f"{path}/{i}", _shape(shape), static=True, strict=True)
        if own and number:
            columns = rr.Transform3D.columns(
                translation=bodies.places[:, number], quaternion=bodies.turns[:, number][:, [1, 2, 3, 0]]
            )
            recording.send_columns(path, [_time(bodies.t)], columns, strict=True)


def _shape(shape: Shape) -> Any:
    """A shape of a body, filled (the viewer's default is its edges)."""
    w, x, y, z = shape.turn.tolist()
    place: dict[str, Any] = {"quaternions": [(x, y, z, w)], "colors": [shape.color]}
    solid: dict[str, Any] = {"fill_mode": rr.components.FillMode.Solid}
    radius, half = float(shape.size[0]), float(shape.size[1])
    at = shape.place
    match shape.kind:
        case "box":
            return rr.Boxes3D(half_sizes=[shape.size], centers=[at], **place, **solid)
        case "cylinder":
            return rr.Cylinders3D(lengths=[2.0 * half], radii=[radius], centers=[at], **place, **solid)
        case "capsule":
            # the viewer's begin at the origin
            foot = at - half * _matrix(w, x, y, z)[:, 2]
            return rr.Capsules3D(lengths=[2.0 * half], radii=[radius], translations=[foot], **place, **solid)
        case "mesh":
            assert shape.corners is not None
            turned = at + shape.corners @ _matrix(w, x, y, z).T
            return rr.Mesh3D(vertex_positions=turned, triangle_indices=shape.faces, albedo_factor=shape.color)
        case _:
            sizes = np.full(3, radius) if shape.kind == "sphere" else shape.size
            return rr.Ellipsoids3D(half_sizes=[sizes], centers=[at], **place, **solid)


def _matrix(w: float, x: float, y: float, z: float) -> FloatArray:
    """The rotation of a quaternion, (3, 3)."""
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def _dress(recording: rr.RecordingStream, tree: UrdfTree, body: str, color: tuple[int, int, int]) -> None:
    """Draw shapes filled (the viewer's default is their edges); the body's first visual wears the source's colour."""
    painted = tree.get_visual_geometry_paths(body)[:1]
    for chunk in tree.stream(include_joint_transforms=False):
        for shape in (rr.Boxes3D, rr.Cylinders3D):
            if any(name.startswith(f"{shape.__name__}:") for name in chunk.to_record_batch().schema.names):
                paint = [color] if chunk.entity_path in painted else None
                filled = shape.from_fields(fill_mode=rr.components.FillMode.Solid, colors=paint)
                recording.log(chunk.entity_path, filled, static=True, strict=True)


def _rgb(color: str) -> tuple[int, int, int]:
    return int(color[1:3], 16), int(color[3:5], 16), int(color[5:7], 16)


def _pixels(radius: float) -> Any:
    """A radius in points of the screen: stays as thin when one zooms in."""
    return rr.components.Radius.ui_points([radius])


def _blueprint(layout: s.Layout) -> rrb.Blueprint:
    return rrb.Blueprint(
        _part(layout),
        rrb.TimePanel(state="collapsed", timeline=TIMELINE, play_state="paused", loop_mode="all"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.SelectionPanel(state="hidden"),
        auto_views=False,
        auto_layout=False,
    )


def _contents(paths: object) -> list[str]:
    assert isinstance(paths, (list, tuple))
    return [f"+ {path}/**" for path in paths]


def _part(layout: s.Layout) -> Any:  # noqa: PLR0911  (one return a kind of view)
    match layout:
        case s.Rows(parts, shares, name):
            return rrb.Vertical(*map(_part, parts), row_shares=shares, name=name)
        case s.Columns(parts, shares):
            return rrb.Horizontal(*map(_part, parts), column_shares=shares)
        case s.Tabs(parts):
            return rrb.Tabs(*map(_part, parts), active_tab=0)
        case s.Plot(name, paths, y):
            axis = rrb.ScalarAxis(range=y) if y is not None else None
            link = rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal)
            legend = rrb.PlotLegend(corner=rrb.components.Corner2D.RightTop)
            return rrb.TimeSeriesView(
                name=name, contents=_contents(paths), axis_x=link, axis_y=axis, plot_legend=legend
            )
        case s.Plane(name, paths, x, y):
            bounds = rrb.VisualBounds2D(x_range=x, y_range=(-y[1], -y[0]))
            return rrb.Spatial2DView(name=name, contents=_contents(paths), visual_bounds=bounds)
        case s.Lanes(name, paths):
            return rrb.StateTimelineView(name=name, contents=_contents(paths))
        case s.Space(name, paths, eye, target):
            look = rrb.EyeControls3D(position=eye, look_target=target, eye_up=(0.0, 0.0, 1.0))
            return rrb.Spatial3DView(
                name=name, contents=_contents(paths), eye_controls=look, line_grid=rrb.LineGrid3D(visible=False)
            )
        case s.Words(name, path):
            return rrb.TextDocumentView(name=name, contents=_contents([path]))
        case s.Events(name, path):
            # the sentences say their own time; the viewer's column of times is too narrow to read
            columns = rrb.TextLogColumns(
                timeline_columns=[rrb.encodings.TimelineColumn(TIMELINE, visible=False)], text_log_columns=["Body"]
            )
            return rrb.TextLogView(name=name, contents=_contents([path]), columns=columns)
