"""What a whole arm's log says of its joints' friction, and of what is wrong beside it."""

from dataclasses import dataclass
from enum import Enum

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity
from harness.diagnosis.rules import Rule
from harness.robot.friction_curve import FrictionCurve
from harness.robot.whole_arm.identifiable import Identifiable


class Grade(Enum):
    """How much an entry explains, and whether others do as well."""

    EXPLAINS = "explains"
    MAIN = "main"
    ONE_OF = "one-of"
    MINOR = "minor"


@dataclass(frozen=True, slots=True)
class Entry:
    """What a joint's friction has beside Coulomb, viscous and offset, or what is wrong beside friction.

    name : of the catalogue. joint : the one it is of, None for the whole arm. statement : one sentence. parameters : by
    name. share : of what the base leaves beyond the noise. evidence : (estimate over standard error) squared, of one
    number. rivals : what would do nearly as well. partner : what an error can never be told from; the entry stands for
    both. pair : what no log of this kind can part, as both are called; empty where it can.
    """

    name: str
    joint: str | None
    statement: str
    parameters: tuple[tuple[str, Quantity], ...]
    grade: Grade
    share: float
    evidence: float
    rivals: tuple[str, ...] = ()
    partner: str = ""
    pair: str = ""

    @property
    def members(self) -> tuple[str, ...]:
        """What it names: itself, and its partner."""
        return (self.name, self.partner) if self.partner else (self.name,)


@dataclass(frozen=True, slots=True)
class Left:
    """Torque that is left of a joint on guarded samples, each (m,), by its base and by the model; q, v : its motion.

    raw : torque beyond the rigid model of the file. friction : beyond the model as corrected, the offset taken off.
    """

    t: FloatArray
    q: FloatArray
    v: FloatArray
    before: FloatArray
    after: FloatArray
    raw: FloatArray
    friction: FloatArray


@dataclass(frozen=True, slots=True)
class JointFriction:
    """Friction of one joint. A joint that hardly moves has refused quantities.

    coulomb, viscous, offset : N m, N m s/rad, N m of a hinge, N, N s/m, N of a slide. effects : the surest first.
    held_out : rms of the torque left over in blocks of time that were not fitted, by the base and by the model, N m.
    remainder : rms of what the model leaves where no reversal reaches through the filter, over that of the noise of
    torque and positions, None where the torque shows none. guard : s. samples : guarded. base : Coulomb, viscous and
    offset with nothing else in the model. left : the torque itself. curve : friction over speed, None where too few
    speeds occur. All are None where the joint hardly moves.
    """

    joint: str
    coulomb: Quantity
    viscous: Quantity
    offset: Quantity
    statement: str
    effects: tuple[Entry, ...] = ()
    held_out: tuple[float, float] | None = None
    remainder: float | None = None
    guard: float | None = None
    samples: int = 0
    base: tuple[Quantity, Quantity, Quantity] | None = None
    left: Left | None = None
    curve: FrictionCurve | None = None

    @property
    def line(self) -> tuple[Quantity, Quantity]:
        """Coulomb and viscous friction to paste: the line through the curve at the speeds that occur."""
        return (self.coulomb, self.viscous) if self.curve is None else self.curve.line


@dataclass(frozen=True, slots=True)
class WholeArm:
    """Friction of every joint, and what is wrong with the model.

    confounded : pairs that this log, or any, cannot part. left_out : evidence of the best candidate that is not named.
    lowpass : Hz, of the filter everything went through.
    rate : samples a second that torque was fitted at. seconds : of the log. rules : those that decided. notes : what
    was done to the log. identifiable : what the motion can tell of each joint, by its columns alone.
    """

    joints: tuple[JointFriction, ...]
    model: tuple[Entry, ...]
    confounded: tuple[tuple[str, str], ...]
    left_out: float
    lowpass: float
    rate: float
    seconds: float
    rules: tuple[Rule, ...]
    notes: tuple[str, ...]
    identifiable: tuple[Identifiable, ...] = ()

    def joint(self, name: str) -> JointFriction:
        """The joint of this name; KeyError where there is none."""
        return {one.joint: one for one in self.joints}[name]

    @property
    def named(self) -> tuple[tuple[str, str | None], ...]:
        """Everything named, with its joint."""
        every = (*(effect for joint in self.joints for effect in joint.effects), *self.model)
        return tuple((one.name, one.joint) for one in every)
