"""What a whole arm's log says of its joints' friction, and of what is wrong beside it."""

from dataclasses import dataclass
from enum import Enum

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity
from harness.robot.whole_arm.rules import Rule


class Grade(Enum):
    """How much an entry explains, and whether others do as well."""

    EXPLAINS = "explains"
    MAIN = "main"
    ONE_OF = "one-of"
    MINOR = "minor"


@dataclass(frozen=True, slots=True)
class Effect:
    """What a joint's friction has beside Coulomb, viscous and offset.

    name : of the catalogue. statement : one sentence. parameters : by name. share : of what the base leaves beyond the
    noise. evidence : (estimate over standard error) squared, of one number. rivals : what would do nearly as well.
    pair : what it can never be told from in this log, as both are called; empty where it can.
    """

    name: str
    statement: str
    parameters: tuple[tuple[str, Quantity], ...]
    grade: Grade
    share: float
    evidence: float
    rivals: tuple[str, ...] = ()
    pair: str = ""


@dataclass(frozen=True, slots=True)
class ModelError:
    """What is wrong beside friction: fields as in Effect. joint : the one it is of, None for the whole arm.

    partner : what it can never be told from; the entry stands for both.
    """

    name: str
    joint: str | None
    partner: str
    statement: str
    parameters: tuple[tuple[str, Quantity], ...]
    grade: Grade
    share: float
    evidence: float
    rivals: tuple[str, ...] = ()
    pair: str = ""

    @property
    def members(self) -> tuple[str, ...]:
        """What it names: itself, and its partner."""
        return (self.name, self.partner) if self.partner else (self.name,)


@dataclass(frozen=True, slots=True)
class Left:
    """Torque that is left of a joint on guarded samples, each (m,), by its base and by the model; q, v : its motion."""

    t: FloatArray
    q: FloatArray
    v: FloatArray
    before: FloatArray
    after: FloatArray


@dataclass(frozen=True, slots=True)
class JointFriction:
    """Friction of one joint. A joint that hardly moves has refused quantities.

    coulomb, viscous, offset : N m, N m s/rad, N m of a hinge, N, N s/m, N of a slide. effects : the surest first.
    held_out : rms of the torque left over in blocks of time that were not fitted, by the base and by the model, N m.
    remainder : rms of what the model leaves over that of the recorded torque's noise, None where that
    shows none. guard : s. samples : guarded. base : Coulomb, viscous and offset with nothing else in the model.
    left : the torque itself. line : Coulomb and viscous friction that come nearest to all of the friction that was
    found, at the speeds and loads of the log. All are None where the joint hardly moves.
    """

    joint: str
    coulomb: Quantity
    viscous: Quantity
    offset: Quantity
    effects: tuple[Effect, ...]
    held_out: tuple[float, float] | None
    remainder: float | None
    guard: float | None
    samples: int
    statement: str
    base: tuple[Quantity, Quantity, Quantity] | None = None
    left: Left | None = None
    line: tuple[Quantity, Quantity] | None = None


@dataclass(frozen=True, slots=True)
class WholeArm:
    """Friction of every joint, and what is wrong with the model.

    confounded : pairs that this log, or any, cannot part. left_out : evidence of the best candidate that is not named.
    lowpass : Hz, of the filter everything went through.
    rate : samples a second that torque was fitted at. seconds : of the log. rules : those that decided. notes : what
    was done to the log.
    """

    joints: tuple[JointFriction, ...]
    model: tuple[ModelError, ...]
    confounded: tuple[tuple[str, str], ...]
    left_out: float
    lowpass: float
    rate: float
    seconds: float
    rules: tuple[Rule, ...]
    notes: tuple[str, ...]

    def joint(self, name: str) -> JointFriction:
        """The joint of this name; KeyError where there is none."""
        return next((j for j in self.joints if j.joint == name), None) or _missing(name)

    @property
    def named(self) -> tuple[tuple[str, str | None], ...]:
        """Everything named, with its joint."""
        own = tuple((effect.name, joint.joint) for joint in self.joints for effect in joint.effects)
        return own + tuple((error.name, error.joint) for error in self.model)


def _missing(name: str) -> JointFriction:
    raise KeyError(name)
