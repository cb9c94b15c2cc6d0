"""What a log can tell of its joints' friction, before anything is fitted: from the columns of its own motion.

The error that each number would have beside what is expected to be wrong with a model (masses, a load, tilt, rotors,
the scale and the delay of the torque), for the noise that the recorded torque has, over the size of the joint's torque.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from harness.core.arrays import FloatArray
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
