"""How a slider is held, where nobody says: spring or pendulum, and whether x is measured from the spring's rest.

An encoder's zero is anywhere, and a large swing of an angle hangs on gravity more often than on a torsion spring. The
few combinations are tried at the base fit, and another than the plain spring is taken only where the misfit falls by
what a misfit counts (a word a stroke): anything smaller may be an effect of its own.

A spring where the user says that there is none: it takes nearly all off that the base leaves of the force.

How a driven slider is held, where nobody says: as its force asks, by a regression on the smoothed motion.

As for a free decay (harness.diagnosis.prepare.held), another way than the plain spring, measured from its rest, is
taken only where the force left over falls by what a misfit counts.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError, SimulationError
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.baseline.words import Strokes, evidence, words_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import GAIN, LARGE_ANGLE, ZERO_REACH
from harness.diagnosis.smoothed_state.state import in_motion
from harness.model.model import Restoring

_LOOKED_AT = 1500
"""Samples that these first fits are made of."""


def held(problem: P, asked: Asked) -> tuple[P, str]:
    """The problem with its restoring force and its zero, and a sentence on what was chosen; "" where it was given."""
    problem = replace(problem, zero_chosen=asked.zero_free is None)
    choices = _choices(problem, asked)
    if len(choices) == 1:
        return replace(problem, restoring=choices[0][0], zero_free=choices[0][1]), ""
    thin = problem.part(slice(None, None, max(1, problem.t.size // _LOOKED_AT)))
    fits: list[tuple[Fit, Restoring, bool]] = []
    for restoring, free in choices:
        with suppress(InputError, SimulationError):
            fits.append((baseline(replace(thin, restoring=restoring, zero_free=free))[0], restoring, free))
    if not fits:
        return replace(problem, restoring=choices[0][0], zero_free=choices[0][1]), ""
    first, restoring, free = fits[0]
    words, gain = words_of(Strokes.by(first.shown.v)), 0.0
    for found, other, zero in fits[1:]:
        one = evidence(first.chi2, found.chi2, words, int(zero) - int(fits[0][2]), 1.0)
        if one >= GAIN.value and one > gain:
            gain, restoring, free = one, other, zero
    problem = replace(problem, restoring=restoring, zero_free=free)
    if gain == 0.0:
        return problem, ""
    said = {Restoring.PENDULUM: "a pendulum", Restoring.SPRING: "a spring"}[restoring]
    origin = "an unknown zero" if free else "its rest"
    return problem, f"held by {said} and measured from {origin}: the base fit asks for it (evidence {gain:.0f})"


def _choices(problem: Problem, asked: Asked) -> Sequence[tuple[Restoring, bool]]:
    """Combinations to try, the plainest first."""
    position = "x" in problem.channels
    zeros = (asked.zero_free,) if asked.zero_free is not None else ((False, True) if position else (False,))
    if asked.restoring is Restoring.PENDULUM:
        return [(Restoring.PENDULUM, asked.zero_free is not False and position)]
    found = [(Restoring.SPRING, zero) for zero in zeros]
    swung = position and problem.angular and float(np.ptp(problem.channels["x"])) > 2.0 * LARGE_ANGLE.value
    if asked.restoring is None and asked.zero_free is not False and swung:
        found.append((Restoring.PENDULUM, True))
    return found


MOST = 0.9
"""Share of the mean square left of the force that a spring takes off only where there is one: of 60 driven axes that
have none, with one effect or without, it takes .12 off at most, of twelve recordings of pneumatic cylinders .32."""


@dataclass(frozen=True, slots=True)
class Beside:
    """What a spring of stiffness k (N/m) takes off the mean square that the base leaves of the force."""

    k: float
    share: float

    @classmethod
    def of(cls, state: tuple[FloatArray, FloatArray, FloatArray], u: FloatArray, mass: float | None) -> "Beside":
        """By least squares over the samples in motion; state : x, v, a (n,), u : force (n,)."""
        x, v, a = state
        moving = in_motion(v)
        table = np.column_stack([v, np.sign(v), np.ones_like(v), *([a] if mass is None else [])])[moving]
        right = (u if mass is None else u - mass * a)[moving]
        without, _ = left_by(table, right)
        left, found = left_by(np.column_stack([table, x[moving]]), right)
        return cls(float(found[-1]), 1.0 - left / without if without > 0.0 else 0.0)

    @property
    def is_unsaid(self) -> bool:
        """Whether there is a spring."""
        return self.k > 0.0 and self.share > MOST


def left_by(table: FloatArray, right: FloatArray) -> tuple[float, FloatArray]:
    """Sum of squares that the columns (n, q) leave, and their factors (q,)."""
    size = np.sqrt(np.mean(table**2, axis=0))
    size[size == 0.0] = 1.0
    found = np.linalg.lstsq(table / size, right, rcond=None)[0] / size
    rest = right - table @ found
    return float(rest @ rest), found


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
