"""Scenes as .rrd files for the rerun viewer, and back. The only module that imports rerun."""

import json
import sys
import warnings
from collections.abc import Iterator, Mapping, Sequence
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
from harness.core.robot import Bodies, Shape
from harness.core.writing import replacing
from harness.show import scene as s
from harness.show.blocks import Figure
from harness.show.numbers import REFERENCE
from harness.show.pack import plain, unpack
from harness.show.plots import is_plane, thinned
from harness.show.scene import FRAMES, plane_of
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
DRAWN = 50_000
"""Samples drawn of a curve. All are stored; of more of them the curves are thinned (harness.show.plots.thinned)."""
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
        try:  # a file without its closing manifest was cut short, whatever the library has said
            _reader(part).store()
        except (RerunWarning, ValueError, OSError, RuntimeError) as error:
            raise StoreError(f"{path}: could not be written to its end; expected room on the disk") from error


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
    for view in scene.views:
        send(view, recording)
    for name, data in scene.blobs.items():
        blob = rr.DynamicArchetype("harness", components={_SAMPLES: np.frombuffer(data, dtype=np.uint8)})
        recording.log(f"{_DATA}/{name}", blob, static=True, strict=True)
    recording.flush()


def _reader(path: Path) -> RrdReader:
    """A reader of a whole file; RerunWarning when its closing manifest is missing."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", RerunWarning)
        return RrdReader(path)


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
        raise InputError(str(path), "holds no trajectory of this program", "a .rrd written by it")
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


@singledispatch
def send(view: object, recording: rr.RecordingStream) -> None:
    """Send what a view shows."""
    raise TypeError(f"no way to show a {type(view).__name__}")


@send.register
def _(view: Figure, recording: rr.RecordingStream) -> None:
    # the number keeps the order: the viewer draws by name, and the reference belongs below the others
    curves = [(f"/{s.slug(view.name)}/{i:02d}", trace) for i, trace in enumerate(thinned(view, DRAWN))]
    if is_plane(view):
        _send_plane(view, curves, recording)
        return
    for path, trace in curves:
        name, t = trace["name"], np.asarray(trace["x"])
        style: Any
        if trace["mode"] == "markers":
            marker = trace["marker"]
            shape: Any = str(marker.get("symbol", "circle")).removesuffix("-open")
            style = rr.SeriesPoints(colors=[_rgb(marker["color"])], markers=[shape], marker_sizes=[4.0], names=[name])
        else:
            line = trace["line"]
            style = rr.SeriesLines(colors=[_rgb(line["color"])], widths=[line["width"]], names=[name])
        recording.log(path, style, static=True, strict=True)
        for block in _blocks(t.size):
            columns = rr.Scalars.columns(scalars=np.asarray(trace["y"])[block])
            recording.send_columns(path, [_time(t[block])], columns, strict=True)


def _send_plane(view: Figure, curves: Sequence[tuple[str, Mapping[str, Any]]], recording: rr.RecordingStream) -> None:
    """Curves of a plane, a point that moves along each that has times, points with their errors, and axes; the viewer's
    2D space points down.
    """
    plane = plane_of(view)
    upright = np.array([1.0, -plane.scale])
    for path, trace in curves:
        name, corners = trace["name"], np.column_stack([trace["x"], trace["y"]]) * upright
        if trace["mode"] == "markers":
            color = _rgb(trace["marker"]["color"])
            off = np.column_stack([np.zeros(len(corners)), trace["error_y"]["array"]]) * upright
            errors = rr.LineStrips2D(np.stack([corners - off, corners + off], 1), colors=[color], radii=_pixels(0.5))
            recording.log(f"{path}/errors", errors, static=True, strict=True)
            points = rr.Points2D(corners, colors=[color], radii=_pixels(3.0), labels=[name], show_labels=False)
            recording.log(f"{path}/points", points, static=True, strict=True)
            continue
        color, width = _rgb(trace["line"]["color"]), _pixels(0.5 * trace["line"]["width"])
        gaps = np.flatnonzero(np.isnan(corners).any(axis=1))
        strips = [strip[np.isfinite(strip).all(axis=1)] for strip in np.split(corners, gaps)]
        recording.log(f"{path}/curve", rr.LineStrips2D(strips, colors=[color], radii=width), static=True, strict=True)
        if "now" not in trace and "t" not in trace:
            continue
        point = rr.Points2D.from_fields(colors=[color], radii=_pixels(4.0), labels=[name], show_labels=False)
        recording.log(f"{path}/now", point, static=True, strict=True)
        t, x, y = trace["now"] if "now" in trace else (trace["t"], trace["x"], trace["y"])
        at = np.linspace(t[0], t[-1], min(FRAMES, t.size))
        places = np.column_stack([np.interp(at, t, x), np.interp(at, t, y)]) * upright
        recording.send_columns(f"{path}/now", [_time(at)], rr.Points2D.columns(positions=places), strict=True)
    down, grey = np.array([1.0, -1.0]), _rgb("muted")
    axes = [strip * down for strip in plane.strips]
    lines = rr.LineStrips2D(axes, colors=[grey], radii=_pixels(0.5), draw_order=-10.0)
    recording.log(f"/{s.slug(view.name)}/axes/lines", lines, static=True, strict=True)
    text = rr.Points2D(plane.places * down, labels=plane.labels, radii=[0.0], colors=[grey], show_labels=True)
    recording.log(f"/{s.slug(view.name)}/axes/ticks", text, static=True, strict=True)


@send.register
def _(view: s.Lanes, recording: rr.RecordingStream) -> None:
    for i, lane in enumerate(view.lanes):
        path, (labels, colors) = f"{_path(view)}/{i}-{s.slug(lane.name)}", zip(*lane.looks.values(), strict=True)
        style = rr.StateConfiguration(values=list(lane.looks), labels=labels, colors=list(map(_rgb, colors)))
        recording.log(path, style, static=True, strict=True)
        columns = rr.StateChange.columns(state=cast(Any, list(lane.states)))
        recording.send_columns(path, [_time(lane.t)], columns, strict=True)


@send.register
def _(view: s.Events, recording: rr.RecordingStream) -> None:
    columns = rr.TextLog.columns(text=list(view.texts), level=["INFO"] * len(view.texts))
    recording.send_columns(_path(view), [_time(view.t)], columns, strict=True)


@send.register
def _(view: s.Words, recording: rr.RecordingStream) -> None:
    document = rr.TextDocument(view.text, media_type=rr.MediaType.MARKDOWN)
    recording.log(_path(view), document, static=True, strict=True)


@send.register
def _(view: s.Space, recording: rr.RecordingStream) -> None:
    for name, body in _named(view).items():
        if isinstance(body, s.Body):
            _send_body(name, body, recording)
        else:
            _send_robot(f"/{name}", body, recording)


def _named(view: s.Space) -> dict[str, s.Body | Bodies]:
    """What is seen in a space, by its path, which has one part: the URDF reader takes a prefix for one."""
    place = s.slug(view.name)
    return {
        f"{place}-{i}-{s.slug(body.name)}" if isinstance(body, s.Body) else place: body
        for i, body in enumerate(view.bodies)
    }


def _send_body(name: str, item: s.Body, recording: rr.RecordingStream) -> None:
    path, frame = f"/{name}", f"{name}/"
    try:
        tree = UrdfTree.from_file_path(item.urdf, name, frame_prefix=frame)
    except (ValueError, OSError, RuntimeError) as error:
        raise InputError(str(item.urdf), f"cannot be read ({error})", "a URDF file") from None
    joint = next((j for j in tree.joints() if j.joint_type in ("prismatic", "revolute", "continuous")), None)
    if joint is None:
        raise InputError(str(item.urdf), "no joint that moves", "a URDF with a sliding or turning joint")
    tree.log_urdf_to_recording(recording)
    _dress(recording, tree, joint.child_link, _rgb(item.color))
    root = tree.root_link()
    home = rr.Transform3D(translation=item.offset, parent_frame="tf#/", child_frame=frame + root.name)
    recording.log(f"{path}-place", home, static=True, strict=True)
    now = [_time(item.t)]
    recording.send_columns(f"{path}-motion", now, joint.compute_transform_columns(item.values.tolist()), strict=True)

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
    recording.send_columns(f"{path}-coil", now, columns, strict=True)


def _send_robot(place: str, bodies: Bodies, recording: rr.RecordingStream) -> None:
    for number, name in enumerate(bodies.names):
        path = f"{place}/{number:02d}-{s.slug(name)}"
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
    from scipy.spatial.transform import Rotation  # of robots alone, and slow to import

    w, x, y, z = shape.turn.tolist()
    turn = Rotation.from_quat([x, y, z, w])
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
            foot = at - half * turn.as_matrix()[:, 2]
            return rr.Capsules3D(lengths=[2.0 * half], radii=[radius], translations=[foot], **place, **solid)
        case "mesh":
            assert shape.corners is not None
            turned = at + turn.apply(shape.corners)
            return rr.Mesh3D(vertex_positions=turned, triangle_indices=shape.faces, albedo_factor=shape.color)
        case _:
            sizes = np.full(3, radius) if shape.kind == "sphere" else shape.size
            return rr.Ellipsoids3D(half_sizes=[sizes], centers=[at], **place, **solid)


def _dress(recording: rr.RecordingStream, tree: UrdfTree, body: str, color: tuple[int, int, int]) -> None:
    """Draw shapes filled (the viewer's default is their edges); the body's first visual wears the source's colour."""
    painted = tree.get_visual_geometry_paths(body)[:1]
    for chunk in tree.stream(include_joint_transforms=False):
        for shape in (rr.Boxes3D, rr.Cylinders3D):
            if any(name.startswith(f"{shape.__name__}:") for name in chunk.to_record_batch().schema.names):
                paint = [color] if chunk.entity_path in painted else None
                filled = shape.from_fields(fill_mode=rr.components.FillMode.Solid, colors=paint)
                recording.log(chunk.entity_path, filled, static=True, strict=True)


_OF_THE_PAGE = {"ink": REFERENCE, "muted": "#5b6470"}


def _rgb(color: str) -> tuple[int, int, int]:
    color = _OF_THE_PAGE.get(color, color)
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


def _path(view: s.Lanes | s.Events | s.Words) -> str:
    return f"/{type(view).__name__.lower()}/{s.slug(view.name)}"


def _part(layout: s.Layout) -> Any:  # noqa: PLR0911  (one return a kind of view)
    match layout:
        case s.Rows(parts, shares, name):
            return rrb.Vertical(*map(_part, parts), row_shares=shares, name=name)
        case s.Columns(parts, shares):
            return rrb.Horizontal(*map(_part, parts), column_shares=shares)
        case s.Tabs(parts):
            return rrb.Tabs(*map(_part, parts), active_tab=0)
        case Figure():
            return _plot(layout)
    paths = [f"/{name}" for name in _named(layout)] if isinstance(layout, s.Space) else [_path(layout)]
    known: dict[str, Any] = {"name": layout.name, "contents": [f"+ {path}/**" for path in paths]}
    match layout:
        case s.Lanes():
            return rrb.StateTimelineView(**known)
        case s.Space(eye=eye, target=target):
            look = rrb.EyeControls3D(position=eye, look_target=target, eye_up=(0.0, 0.0, 1.0))
            return rrb.Spatial3DView(eye_controls=look, line_grid=rrb.LineGrid3D(visible=False), **known)
        case s.Words():
            return rrb.TextDocumentView(**known)
        case s.Events():
            # the sentences say their own time; the viewer's column of times is too narrow to read
            columns = rrb.TextLogColumns(
                timeline_columns=[rrb.encodings.TimelineColumn(TIMELINE, visible=False)], text_log_columns=["Body"]
            )
            return rrb.TextLogView(columns=columns, **known)


def _plot(figure: Figure) -> Any:
    """A view of curves over time or in a plane, whose first look is the right one."""
    across, up = (figure.layout[axis]["title"]["text"] for axis in ("xaxis", "yaxis"))
    contents = [f"+ /{s.slug(figure.name)}/**"]
    if is_plane(figure):
        plane = plane_of(figure)
        bounds = rrb.VisualBounds2D(x_range=plane.x, y_range=(-plane.y[1], -plane.y[0]))
        return rrb.Spatial2DView(name=f"{up} over {across}", contents=contents, visual_bounds=bounds)
    values = [np.asarray(trace["y"]) for trace in figure.traces]
    axis = rrb.ScalarAxis(range=s.roomy(values)) if any(map(np.ptp, values)) else None
    return rrb.TimeSeriesView(
        name=up,
        contents=contents,
        axis_x=rrb.TimeAxis(link=rrb.components.LinkAxis.LinkToGlobal),
        axis_y=axis,
        plot_legend=rrb.PlotLegend(corner=rrb.components.Corner2D.RightTop),
    )
