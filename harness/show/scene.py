"""What a trace shows: figures as on the page, lanes, bodies in space and words, laid out; and the axes of a plane."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.core.robot import Bodies
from harness.core.trajectory import Trajectory
from harness.results.common import Result
from harness.show.blocks import Figure
from harness.show.pack import packed

FRAMES = 600
"""Places of what moves: a body, a point on a curve in a plane."""


@dataclass(frozen=True, slots=True)
class Lane:
    """A state over time: from t[i] on it is states[i]. looks : state -> (label, "#rrggbb")."""

    name: str
    t: FloatArray
    states: Sequence[str]
    looks: Mapping[str, tuple[str, str]]


@dataclass(frozen=True, slots=True)
class Lanes:
    """State lanes over time."""

    name: str
    lanes: Sequence[Lane]


@dataclass(frozen=True, slots=True)
class Body:
    """A robot description whose first sliding or turning joint follows ``values``.

    t, values : s, and m or rad. offset : where it stands, m. Visuals whose material is called "spring" are stretched
    from the left end of the coil, found in the file, to the body.
    """

    name: str
    urdf: Path
    t: FloatArray
    values: FloatArray
    offset: tuple[float, float, float]
    color: str


@dataclass(frozen=True, slots=True)
class Space:
    """A body each source, or the bodies of a robot, seen from ``eye`` towards ``target``, m."""

    name: str
    bodies: Sequence[Body | Bodies]
    eye: tuple[float, float, float]
    target: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Words:
    """A page of Markdown."""

    name: str
    text: str


@dataclass(frozen=True, slots=True)
class Events:
    """Sentences at times, s."""

    name: str
    t: FloatArray
    texts: Sequence[str]


View: TypeAlias = Figure | Lanes | Space | Words | Events
"""A figure is drawn over time, or as a plane where its curves have times of their own (harness.show.plots.orbit)."""


@dataclass(frozen=True, slots=True)
class Rows:
    """Views one above the other. name : of a tab that holds them."""

    parts: Sequence["Layout"]
    shares: Sequence[float] | None = None
    name: str | None = None


@dataclass(frozen=True, slots=True)
class Columns:
    """Views side by side."""

    parts: Sequence["Layout"]
    shares: Sequence[float] | None = None


@dataclass(frozen=True, slots=True)
class Tabs:
    """Views behind one another."""

    parts: Sequence["Layout"]


Layout: TypeAlias = View | Rows | Columns | Tabs


@dataclass(frozen=True, slots=True)
class Scene:
    """A whole trace.

    name : what the viewer calls the recording. layout : views, laid out. blobs : exact data under a name each
    (harness.show.pack). properties : JSON-able, under a name each.
    """

    name: str
    layout: Layout
    blobs: Mapping[str, bytes] = field(default_factory=dict)
    properties: Mapping[str, Any] = field(default_factory=dict)

    @property
    def views(self) -> Iterator[View]:
        return _views(self.layout)


def _views(layout: Layout) -> Iterator[View]:
    if isinstance(layout, (Rows, Columns, Tabs)):
        for part in layout.parts:
            yield from _views(part)
    else:
        yield layout


def of_result(
    name: str,
    layout: Layout,
    result: Result | Mapping[str, Any],
    notes: str,
    parts: Mapping[str, Sequence[Trajectory | Recording]],
    properties: Mapping[str, Any] | None = None,
) -> Scene:
    """The scene of a result, which is kept in it whole; so are trajectories and recordings, the parts by their kind."""
    data = result.model_dump(mode="json", by_alias=True) if isinstance(result, Result) else dict(result)
    return Scene(name, layout, packed(parts), {"result": data, "notes": {"text": notes}} | dict(properties or {}))


def notes_of(heading: str, sentences: Sequence[str], before: str = "") -> str:
    """A page of Markdown: a heading, a paragraph ``before`` them where there is one, and sentences."""
    lines = [f"# {heading}", "", *([before, ""] if before else []), *(f"- {one}" for one in sentences)]
    return "\n".join(lines).replace("+-", "\u00b1")


def slug(name: str) -> str:
    """A name as part of a path: without characters that the viewer would escape."""
    return "".join(c if c.isalnum() else "-" for c in name)


def padded(values: Sequence[FloatArray], share: float) -> tuple[float, float]:
    """Smallest and largest finite value of all arrays, widened by ``share`` of their distance on either side."""
    every = np.concatenate([np.empty(0), *map(np.ravel, values)])
    finite = every[np.isfinite(every)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    margin = share * (high - low) if high > low else max(1e-12, 0.1 * abs(high))
    return low - margin, high + margin


def roomy(values: Sequence[FloatArray]) -> tuple[float, float]:
    """Like ``padded``, out to the next whole power of ten where that is near: there the viewer writes a number."""
    low, high = padded(values, 0.0)
    step = 10.0 ** np.floor(np.log10(high - low))
    further_low, further_high = step * np.floor(low / step), step * np.ceil(high / step)
    near = 0.3 * (high - low)
    low = float(further_low) if low - further_low < near else low
    high = float(further_high) if further_high - high < near else high
    return padded([np.array([low, high])], 0.06)


@dataclass(frozen=True, slots=True)
class Plane:
    """How a figure lies in the viewer's plane, which has one scale for both axes, y upwards.

    scale : what its y are multiplied by, so that it is as high as wide. x, y : what is visible. strips : axes and
    ticks, each (m, 2). labels, places : their words, and where (n, 2).
    """

    scale: float
    x: tuple[float, float]
    y: tuple[float, float]
    strips: Sequence[FloatArray]
    labels: Sequence[str]
    places: FloatArray


def plane_of(figure: Figure) -> Plane:
    """Axes through the origin with ticks, as far as its curves reach."""
    across, up = ([np.asarray(trace[axis]) for trace in figure.traces] for axis in ("x", "y"))
    spans = [high - low for low, high in (padded(across, 0.0), padded(up, 0.0))]
    scale = spans[0] / max(spans[1], 1e-300)
    x, y = padded(across, 0.06), padded([scale * values for values in up], 0.06)
    zero_x, zero_y = min(max(0.0, x[0]), x[1]), min(max(0.0, y[0]), y[1])
    strips = [np.array([[x[0], zero_y], [x[1], zero_y]]), np.array([[zero_x, y[0]], [zero_x, y[1]]])]
    labels, places = list[str](), list[list[float]]()
    size_x, size_y = 0.008 * (x[1] - x[0]), 0.012 * (y[1] - y[0])
    for value in _ticks(*x):
        strips.append(np.array([[value, zero_y - size_y], [value, zero_y + size_y]]))
        labels.append(f"{value:g}")
        places.append([value, zero_y - 3.0 * size_y])
    for value in _ticks(y[0] / scale, y[1] / scale):
        strips.append(np.array([[zero_x - size_x, value * scale], [zero_x + size_x, value * scale]]))
        labels.append(f"{value:g}")
        places.append([zero_x + 5.0 * size_x, value * scale])
    labels += [figure.layout[axis]["title"]["text"] for axis in ("xaxis", "yaxis")]
    places += [[x[1] - 8.0 * size_x, zero_y + 4.0 * size_y], [zero_x + 8.0 * size_x, y[1] - 2.0 * size_y]]
    return Plane(scale, x, y, strips, labels, np.array(places))


def _ticks(low: float, high: float, about: int = 5) -> FloatArray:
    """Round numbers (1, 2 or 5 times a power of ten apart) within [low, high], but for zero."""
    rough = (high - low) / about
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * next(nice for nice in (1.0, 2.0, 5.0, 10.0) if rough <= nice * power)
    whole = np.arange(np.ceil(low / step), np.floor(high / step) + 1)
    return np.asarray(whole[whole != 0] * step)
