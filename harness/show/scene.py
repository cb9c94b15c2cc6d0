"""What a trace shows, said without the viewer's library: things with names, and views that list them.

A diagnosis or a sweep builds its own Scene from the same pieces; harness.show.trace writes any of them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

from harness.core.arrays import FloatArray
from harness.core.robot.bodies import Bodies


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
