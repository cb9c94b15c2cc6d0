"""The search, begun anew with each error of the model corrected whose effect is not linear in its size."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.core.robot.joint_log import JointLog
from harness.robot.arm import Arm
from harness.robot.whole_arm.columns import DELAY, PAYLOAD, TILT
from harness.robot.whole_arm.differentiate import differentiate
from harness.robot.whole_arm.perturb import tilted, with_load
from harness.robot.whole_arm.prepare import Known, Problem, moving, prepare
from harness.robot.whole_arm.search import CORRECTED, Chosen, Model, search

_ROUNDS = 8
"""Of searching and correcting, at most."""


@dataclass(frozen=True, slots=True)
class Solved:
    """model : what was chosen. problem : with every correction. first : the problem without any.

    corrected : by name, the sum of what was corrected, in the candidate's numbers. still : joints that hardly move.
    """

    model: Model
    problem: Problem
    first: Problem
    corrected: dict[str, FloatArray]
    still: tuple[str, ...]


def solve(log: JointLog, arm: Arm, joints: Sequence[str] | None, lowpass: float | None, known: Known) -> Solved:
    """Search, correct, and search again, until nothing is to be corrected.

    Raises InputError where no joint moves enough.
    """
    applied: dict[str, FloatArray] = {}
    forced: list[Chosen] = []
    everything = differentiate(log, arm, joints, lowpass)
    going = moving(everything)
    if not going:
        raise InputError(log.file, "no joint that moves to and fro", "a log in which joints move both ways is accepted")
    still = tuple(name for j, name in enumerate(everything.joints) if j not in going)
    names = [everything.joints[j] for j in going]
    first = problem = prepare(differentiate(log, arm, names, everything.band.lowpass), arm, known)
    model = search(problem.parts, problem.candidates, problem.filtered.t, forced)
    steady = 0
    for _ in range(_ROUNDS):
        rest = _rest(model)
        if not model.again and (steady or not rest):
            break
        # what is left of a correction is taken up once more, by itself: it is no other error beside
        steady = 0 if model.again else steady + 1
        for name, numbers in rest.items():
            applied[name] = applied.get(name, np.zeros(numbers.size)) + numbers
        forced = [one for one in model.chosen if one.named.candidate.name in CORRECTED]
        now, late = _corrected(arm, applied)
        problem = prepare(differentiate(log, now, names, everything.band.lowpass, late), now, known)
        keys = {one.named.candidate.key for one in forced}
        offered = [one for one in problem.candidates if steady or one.key in keys]
        model = search(problem.parts, offered, problem.filtered.t, forced)
    return Solved(model, problem, first, applied, still)


def _rest(model: Model) -> dict[str, FloatArray]:
    """Numbers found for what is corrected, by name."""
    places = model.design.places[len(model.design.parts) :]
    return {
        one.candidate.name: model.design.numbers[place]
        for one, place in zip(model.design.named, places, strict=True)
        if one.candidate.name in CORRECTED
    }


def _corrected(arm: Arm, applied: dict[str, FloatArray]) -> tuple[Arm, float]:
    """The arm with what was found, and the delay, s."""
    if (load := applied.get(PAYLOAD)) is not None and load[0] > 0.0:
        arm = with_load(arm, float(load[0]), load[1:] / float(load[0]))
    if (turn := applied.get(TILT)) is not None:
        arm = tilted(tilted(arm, float(turn[0]), 0), float(turn[1]), 1)
    late = applied.get(DELAY)
    return arm, 0.0 if late is None else float(late[0])


def total(solved: Solved, name: str, numbers: FloatArray) -> FloatArray:
    """Numbers of a named error: what was corrected and what was fitted beside it."""
    return solved.corrected.get(name, np.zeros(numbers.size)) + numbers
