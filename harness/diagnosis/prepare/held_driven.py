"""How a driven slider is held, where nobody says: as its force asks, by a regression on the smoothed motion.

As for a free decay (harness.diagnosis.prepare.held), another way than the plain spring, measured from its rest, is
taken only where the force left over falls by what a misfit counts.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.diagnosis.baseline.words import Strokes, evidence, words_of
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import GAIN, ZERO_REACH
from harness.diagnosis.smoothed_state.inverse_start import in_motion
from harness.diagnosis.smoothed_state.unsaid_spring import MOST, left_by
from harness.model.model import Restoring


@dataclass(frozen=True, slots=True)
class _Way:
    """columns (n, 2) : by which a force pulls back towards a zero that is not known."""

    restoring: Restoring
    columns: FloatArray

    def is_one(self, along: float, across: float, reach: float) -> bool:
        """Whether factors of the columns are of something that pulls back towards a zero not far off."""
        if self.restoring is Restoring.PENDULUM:
            return True
        return along > 0.0 and abs(across) <= ZERO_REACH.value * reach * along


def _pulls_back(ways: Sequence[_Way], base: FloatArray, moving: BoolArray, right: FloatArray) -> bool:
    """Whether some way takes nearly all off what is left of the force (m,) without any; base (m, q) : its columns."""
    free, _ = left_by(np.column_stack([base, np.ones(right.size)]), right)
    for way in ways:
        left, factors = left_by(np.column_stack([way.columns[moving], base]), right)
        pulls = way.restoring is Restoring.PENDULUM or factors[0] > 0.0
        if pulls and left < (1.0 - MOST) * free:
            return True
    return False


def held_driven(
    asked: Asked, state: tuple[FloatArray, FloatArray, FloatArray], u: FloatArray, angular: bool
) -> tuple[Asked, tuple[str, ...]]:
    """What was asked, with restoring force and zero as the force u (n,) has them where nobody said; and a sentence.

    state : x, v, a (n,), smoothed. Where covariates act they may be the force that a zero would take up, and a servo's
    joint has its own zero: there both are taken as they were asked.
    """
    given = asked.zero_free is not None or asked.covariates or asked.guarded
    if given or asked.restoring in (Restoring.NONE, Restoring.PENDULUM):
        return asked, ()
    x, v, a = state
    moving = in_motion(v)
    ways = [_Way(Restoring.SPRING, np.column_stack([x, np.ones_like(x)]))]
    if asked.restoring is None and angular:
        ways.append(_Way(Restoring.PENDULUM, np.column_stack([np.sin(x), np.cos(x)])))
    base = np.column_stack([v, np.sign(v), *([a] if asked.mass is None else [])])[moving]
    right = (u if asked.mass is None else u - asked.mass * a)[moving]
    reach, words = 0.5 * float(np.ptp(x)), words_of(Strokes.by(v[moving]))
    plain, _ = left_by(np.column_stack([x[moving], base]), right)
    if asked.restoring is None and not _pulls_back(ways, base, moving, right):
        return replace(asked, restoring=Restoring.NONE), ("held by nothing: the force shows no spring",)
    best, most = Restoring.SPRING, 0.0
    for way in ways:
        left, factors = left_by(np.column_stack([way.columns[moving], base]), right)
        gain = evidence(plain, left, words, 1, 1.0) if left > 0.0 else 0.0
        if way.is_one(float(factors[0]), float(factors[1]), reach) and gain >= GAIN.value and gain > most:
            best, most = way.restoring, gain
    chosen = replace(asked, restoring=best, zero_free=most > 0.0)
    if most == 0.0:
        return chosen, ()
    what = "a pendulum" if best is Restoring.PENDULUM else "a spring"
    return chosen, (f"held by {what} and measured from an unknown zero: the force asks for it (evidence {most:.0f})",)
