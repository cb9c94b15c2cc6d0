"""Rigid bodies as they are drawn, and how they move."""

from dataclasses import dataclass
from typing import Literal

from harness.core.arrays import FloatArray, IntArray

Kind = Literal["box", "sphere", "capsule", "cylinder", "ellipsoid", "mesh"]


@dataclass(frozen=True, slots=True)
class Shape:
    """One shape, in the frame of its body.

    body : number of it. size (3,) : half lengths of a box or an ellipsoid, m; of a sphere its radius first, of a
    capsule or a cylinder, whose axis is z, radius and half length. place (3,) : m. turn (4,) : quaternion w, x, y, z.
    color : red, green, blue, 0 to 255. corners (k, 3), faces (m, 3) : of a mesh.
    """

    body: int
    kind: Kind
    size: FloatArray
    place: FloatArray
    turn: FloatArray
    color: tuple[int, int, int]
    corners: FloatArray | None = None
    faces: IntArray | None = None


@dataclass(frozen=True, slots=True)
class Bodies:
    """Bodies that move.

    names : of the bodies, nb of them; the first stands still. shapes : theirs. t (n,) : s. places (n, nb, 3) : m.
    turns (n, nb, 4) : quaternions w, x, y, z.
    """

    names: tuple[str, ...]
    shapes: tuple[Shape, ...]
    t: FloatArray
    places: FloatArray
    turns: FloatArray
