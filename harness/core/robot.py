"""A robot: a log of its joints as somebody recorded it, in SI units, and its bodies as they are drawn and move."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from harness.core.arrays import FloatArray, IntArray
from harness.core.checks import increasing, vector
from harness.core.errors import InputError

MINIMUM_SAMPLES = 50


@dataclass(frozen=True, slots=True)
class JointLog:
    """Positions, velocities and efforts of named joints over time; every array has shape (n,) and is read-only.

    t : s, increasing. position : rad or m, by joint. velocity : rad/s or m/s, effort : N m or N; joints that were not
    logged are not used. file : where it came from. sha256 : of that file. notes : what the reader did, one sentence
    each. goal : position that is asked of a servo, rad or m. voltage : of its supply, V. driven : 1 where it drives.
    temperature : of the joint, degC. unit : that positions came in, where the log says one for all, else "".

    Raises InputError for fewer than 50 samples, a value not finite, time that does not increase, or no position.
    """

    t: FloatArray
    position: Mapping[str, FloatArray]
    velocity: Mapping[str, FloatArray] = field(default_factory=dict)
    effort: Mapping[str, FloatArray] = field(default_factory=dict)
    file: str = "log"
    sha256: str = ""
    notes: tuple[str, ...] = ()
    goal: Mapping[str, FloatArray] = field(default_factory=dict)
    voltage: Mapping[str, FloatArray] = field(default_factory=dict)
    driven: Mapping[str, FloatArray] = field(default_factory=dict)
    temperature: Mapping[str, FloatArray] = field(default_factory=dict)
    unit: str = ""

    def __post_init__(self) -> None:
        t = vector(f"{self.file}: time", self.t)
        if t.size < MINIMUM_SAMPLES:
            raise InputError(self.file, f"{t.size} samples", f"at least {MINIMUM_SAMPLES}")
        increasing(f"{self.file}: time", t)
        object.__setattr__(self, "t", t)
        if not self.position:
            raise InputError(self.file, "no joint's position", "a log with positions of joints")
        for kind in ("position", "velocity", "effort", "goal", "voltage", "driven", "temperature"):
            given = getattr(self, kind)
            kept = {name: vector(f"{self.file}: {name}.{kind}", y, t.size) for name, y in given.items()}
            object.__setattr__(self, kind, MappingProxyType(kept))

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, as the log orders them."""
        return tuple(self.position)


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
