"""What a scene holds, and the axes that the viewer does not draw itself."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.robot.bodies import Bodies
from harness.results.common import Result


@dataclass(frozen=True, slots=True)
class Line:
    """A curve over time. t : s. values : same length, nan draws a gap. color : "#rrggbb"."""

    path: str
    name: str
    t: FloatArray
    values: FloatArray
    color: str
    width: float = 1.5


@dataclass(frozen=True, slots=True)
class Marks:
    """Points over time, drawn as markers."""

    path: str
    name: str
    t: FloatArray
    values: FloatArray
    color: str
    size: float = 4.0
    shape: Literal["circle", "diamond", "cross", "plus", "square"] = "circle"


@dataclass(frozen=True, slots=True)
class Lane:
    """A state over time: from t[i] on it is states[i]; None is a gap. looks : state -> (label, "#rrggbb")."""

    path: str
    t: FloatArray
    states: Sequence[str | None]
    looks: Mapping[str, tuple[str, str]]


@dataclass(frozen=True, slots=True)
class Orbit:
    """A curve in a plane and a point that moves along it.

    points : (n, 2), second axis upwards; the viewer's 2D space points down, the writer turns it over.
    at : times, s, and places, (m, 2), of the point.
    """

    path: str
    name: str
    points: FloatArray
    color: str
    at: tuple[FloatArray, FloatArray]
    width: float = 1.5


@dataclass(frozen=True, slots=True)
class Grid:
    """Still lines with labels in a plane: axes and ticks of a phase portrait. strips : each (m, 2)."""

    path: str
    strips: Sequence[FloatArray]
    labels: Sequence[str]
    places: FloatArray
    color: str = "#5b6470"


@dataclass(frozen=True, slots=True)
class Log:
    """Sentences at times."""

    path: str
    t: FloatArray
    texts: Sequence[str]


@dataclass(frozen=True, slots=True)
class Page:
    """A page of Markdown."""

    path: str
    text: str


@dataclass(frozen=True, slots=True)
class Body:
    """A robot description whose first sliding or turning joint follows ``values``.

    t, values : s, and m or rad. offset : where it stands, m. Visuals whose material is called "spring" are stretched
    from ``anchor`` (the left end of the coil, found in the file) to the body.
    """

    path: str
    name: str
    urdf: Path
    t: FloatArray
    values: FloatArray
    offset: tuple[float, float, float]
    color: str


@dataclass(frozen=True, slots=True)
class Robot:
    """Bodies of a robot, each with its own motion."""

    path: str
    bodies: Bodies


Item: TypeAlias = Line | Marks | Lane | Orbit | Grid | Log | Page | Body | Robot


@dataclass(frozen=True, slots=True)
class Plot:
    """Curves and marks over time. y : fixed range of the axis, so that the first look is the right one."""

    name: str
    paths: Sequence[str]
    y: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True)
class Plane:
    """Orbits. x, y : what is visible, y upwards."""

    name: str
    paths: Sequence[str]
    x: tuple[float, float]
    y: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Lanes:
    """State lanes over time."""

    name: str
    paths: Sequence[str]


@dataclass(frozen=True, slots=True)
class Space:
    """Bodies in three dimensions, seen from ``eye`` towards ``target``, m."""

    name: str
    paths: Sequence[str]
    eye: tuple[float, float, float]
    target: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Words:
    """A page of Markdown."""

    name: str
    path: str


@dataclass(frozen=True, slots=True)
class Events:
    """A list of sentences in order of time."""

    name: str
    path: str


View: TypeAlias = Plot | Plane | Lanes | Space | Words | Events


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

    name : what the viewer calls the recording. items : what there is. layout : how it is laid out.
    blobs : exact data under a name each (harness.show.pack). properties : JSON-able, under a name each.
    """

    name: str
    items: Sequence[Item]
    layout: Layout
    blobs: Mapping[str, bytes] = field(default_factory=dict)
    properties: Mapping[str, Any] = field(default_factory=dict)


def kept(result: Result) -> dict[str, Any]:
    """A result as a trace has it among its properties."""
    return result.model_dump(mode="json", by_alias=True)


def padded(values: Sequence[FloatArray], share: float) -> tuple[float, float]:
    """Smallest and largest finite value of all arrays, widened by ``share`` of their distance on either side."""
    ends = [end for array in values if (end := _ends(array)) is not None]
    low = min((end[0] for end in ends), default=0.0)
    high = max((end[1] for end in ends), default=0.0)
    margin = share * (high - low) if high > low else max(1e-12, 0.1 * abs(high))
    return low - margin, high + margin


def _ends(values: FloatArray) -> tuple[float, float] | None:
    low, high = float(values.min()), float(values.max())
    if np.isfinite(low) and np.isfinite(high):
        return low, high
    finite = values[np.isfinite(values)]
    return (float(finite.min()), float(finite.max())) if finite.size else None


def roomy(values: Sequence[FloatArray]) -> tuple[float, float]:
    """Like ``padded``, out to the next whole power of ten where that is near: there the viewer writes a number."""
    low, high = padded(values, 0.0)
    step = 10.0 ** np.floor(np.log10(high - low))
    further_low, further_high = step * np.floor(low / step), step * np.ceil(high / step)
    near = 0.3 * (high - low)
    low = float(further_low) if low - further_low < near else low
    high = float(further_high) if further_high - high < near else high
    return padded([np.array([low, high])], 0.06)


def ticks(low: float, high: float, about: int = 5) -> FloatArray:
    """Round numbers (1, 2 or 5 times a power of ten apart) within [low, high]."""
    rough = (high - low) / about
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * next(nice for nice in (1.0, 2.0, 5.0, 10.0) if rough <= nice * power)
    return np.asarray(np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step)


def plane_grid(
    path: str, x: tuple[float, float], y: tuple[float, float], x_axis: tuple[str, float], y_axis: tuple[str, float]
) -> Grid:
    """Axes through the origin with ticks. x_axis, y_axis : label, and label units for one unit drawn."""
    zero_x, zero_y = min(max(0.0, x[0]), x[1]), min(max(0.0, y[0]), y[1])
    strips = [np.array([[x[0], zero_y], [x[1], zero_y]]), np.array([[zero_x, y[0]], [zero_x, y[1]]])]
    labels, places = [], []
    size_x, size_y = 0.008 * (x[1] - x[0]), 0.012 * (y[1] - y[0])
    for value in ticks(x[0] * x_axis[1], x[1] * x_axis[1]) / x_axis[1]:
        strips.append(np.array([[value, zero_y - size_y], [value, zero_y + size_y]]))
        if value != 0.0:
            labels.append(f"{value * x_axis[1]:g}")
            places.append([value, zero_y - 3.0 * size_y])
    for value in ticks(y[0] * y_axis[1], y[1] * y_axis[1]) / y_axis[1]:
        strips.append(np.array([[zero_x - size_x, value], [zero_x + size_x, value]]))
        if value != 0.0:
            labels.append(f"{value * y_axis[1]:g}")
            places.append([zero_x + 5.0 * size_x, value])
    labels += [x_axis[0], y_axis[0]]
    places += [[x[1] - 8.0 * size_x, zero_y + 4.0 * size_y], [zero_x + 8.0 * size_x, y[1] - 2.0 * size_y]]
    return Grid(path, strips, labels, np.array(places))
