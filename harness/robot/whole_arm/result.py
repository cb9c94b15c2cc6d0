"""What a whole arm's log says of its joints' friction, of what is wrong beside it, and what it can tell at all.

That is known before anything is fitted, from the columns of its own motion: the error that each number would have
beside what is expected to be wrong with a model (masses, a load, tilt, rotors, the scale and the delay of the torque),
for the noise that the recorded torque has, over the size of the joint's torque.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Literal

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.quantity import Quantity
from harness.diagnosis.grading.likely import Likely
from harness.diagnosis.rules import Rule
from harness.robot.friction_curve import FrictionCurve
from harness.robot.whole_arm.columns import ARMATURE, DELAY, INERTIA, MOTOR, PAYLOAD, SENSOR, TILT, ZERO
from harness.robot.whole_arm.rules import IDENTIFIABLE, WEAK
from harness.robot.whole_arm.search import Problem

Verdict = Literal["identifiable", "weak", "not"]
COULOMB, VISCOUS, OFFSET = "Coulomb friction", "viscous friction", "offset"
_NUMBERS = (COULOMB, VISCOUS, OFFSET)
_CALLED = {
    INERTIA: "masses",
    PAYLOAD: "a load",
    TILT: "a tilted base",
    ZERO: "zeros of positions",
    ARMATURE: "the rotor",
    MOTOR: "the scale of the torque",
    DELAY: "a delay of the torque",
    SENSOR: "the side of the sensor",
}
_MENDS = {
    (COULOMB, VISCOUS): "move it slowly as well as fast, both ways",
    (VISCOUS, COULOMB): "move it slowly as well as fast, both ways",
    (VISCOUS, _CALLED[DELAY]): "turn it round more quickly, so that acceleration is not in step with speed",
    (OFFSET, _CALLED[INERTIA]): "move it through a larger angle",
    (OFFSET, _CALLED[PAYLOAD]): "move it through a larger angle",
    (OFFSET, _CALLED[ZERO]): "move it through a larger angle",
    (OFFSET, _CALLED[TILT]): "move it through a larger angle",
}
_LONGER = "record it longer, to and fro at several speeds"
_STILL = "it does not move to and fro enough"
_ABOUT = 0.5
"""Share of an error's square that one partner makes, from which it is said."""


@dataclass(frozen=True, slots=True)
class Identifiable:
    """One number of one joint. error : that it would have, over the joint's torque. why : what it goes with, or that
    the motion is too short. mend : the motion that would part them.
    """

    joint: str
    parameter: str
    verdict: Verdict
    error: float | None = None
    why: str = ""
    mend: str = ""


def identifiable(problem: Problem, still: tuple[str, ...]) -> tuple[Identifiable, ...]:
    """Of every joint; still : those that hardly move."""
    found = []
    for j, name in enumerate(problem.filtered.joints):
        part = problem.parts[j]
        base = part.white(part.base[:, :3])
        beside = {
            _CALLED[one.name]: part.white(one.torque(one.values[0])[j]) / _within(one.spread)
            for one in problem.candidates
            if one.name in _CALLED and one.joint in (j, None) and j in one.torque(one.values[0])
        }
        kept = part.stretches.kept
        size = float(np.std(part.torque[kept])) or 1.0
        sizes = size / np.sqrt(np.mean(part.base[kept, :3] ** 2, axis=0))
        for i, number in enumerate(_NUMBERS):
            found.append(_told(name, number, i, base, beside, float(sizes[i])))
    found += [Identifiable(name, n, "not", None, _STILL, _LONGER) for name in still for n in _NUMBERS]
    return tuple(found)


def _within(spread: FloatArray) -> FloatArray:
    """What columns are divided by, so that each number is expected to be 1; anything goes as far as a hundred."""
    return 1.0 / np.where(np.isfinite(spread), spread, 100.0)


def _told(
    joint: str, number: str, i: int, base: FloatArray, beside: dict[str, FloatArray], size: float
) -> Identifiable:
    """size : that the number would have if it alone made the joint's torque."""
    others = {name: base[:, [k]] for k, name in enumerate(_NUMBERS) if k != i}
    whole = _variance(base, i, beside)
    error = float(np.sqrt(whole)) / size
    if error < IDENTIFIABLE.value:
        return Identifiable(joint, number, "identifiable", error)
    verdict: Verdict = "weak" if error < WEAK.value else "not"
    without = {name: _variance(base, i, {n: c for n, c in beside.items() if n != name}) for name in beside}
    for name in others:
        kept = [k for k, n in enumerate(_NUMBERS) if n != name]
        without[name] = _variance(base[:, kept], kept.index(i), beside)
    partner = min(without, key=lambda name: without[name])
    if 1.0 - without[partner] / whole < _ABOUT:
        return Identifiable(joint, number, verdict, error, "the torque's noise is large for so short a motion", _LONGER)
    return Identifiable(
        joint, number, verdict, error, f"it goes with {partner}", _MENDS.get((number, partner), _LONGER)
    )


def _variance(base: FloatArray, i: int, beside: dict[str, FloatArray]) -> float:
    """Of a base number, in the units of whitened torque; each of what stands beside is expected to be about 1."""
    more = np.hstack([*beside.values(), np.zeros((base.shape[0], 0))])
    scale = np.sqrt(np.sum(base**2, axis=0))
    columns = np.hstack((base / scale, more))
    prior = np.concatenate((np.full(base.shape[1], 1e-12), np.ones(more.shape[1])))
    return float(np.linalg.inv(columns.T @ columns + np.diag(prior))[i, i] / scale[i] ** 2)


def with_joint(name: str, joint: str | None) -> str:
    """A name with the joint that it is of; what is of the whole arm stands alone."""
    return name if joint is None else f"{joint}: {name}"


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
    number. bic : the same less the logarithm of the samples that show it. worse : what would do nearly as well, named
    with its joint, and by how much worse. partner : what an error can never be told from; the entry stands for both.
    pair : what no log of this kind can part, as both are called; empty where it can.
    """

    name: str
    joint: str | None
    statement: str
    parameters: tuple[tuple[str, Quantity], ...]
    grade: Grade
    share: float
    evidence: float
    bic: float
    worse: Mapping[str, float] = field(default_factory=dict)
    partner: str = ""
    pair: str = ""

    @property
    def label(self) -> str:
        """Its name with the joint that it is of."""
        return with_joint(self.name, self.joint)

    @property
    def rivals(self) -> tuple[str, ...]:
        """What would do nearly as well, with its joint where that is another."""
        return tuple(one.removeprefix(with_joint("", self.joint)) for one in self.worse)

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
    was done to the log. identifiable : what the motion can tell of each joint, by its columns alone. likely : which
    names are missing, each with the joint that it is of.
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
    likely: Likely = field(default_factory=dict)

    def joint(self, name: str) -> JointFriction:
        """The joint of this name; KeyError where there is none."""
        return {one.joint: one for one in self.joints}[name]

    @property
    def named(self) -> tuple[tuple[str, str | None], ...]:
        """Everything named, with its joint."""
        return tuple((one.name, one.joint) for one in self.entries)

    @property
    def entries(self) -> tuple[Entry, ...]:
        """Everything named."""
        return (*(effect for joint in self.joints for effect in joint.effects), *self.model)
