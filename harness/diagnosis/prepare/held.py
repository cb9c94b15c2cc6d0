"""How a slider is held, where nobody says: spring or pendulum, and whether x is measured from the spring's rest.

An encoder's zero is anywhere, and a large swing of an angle hangs on gravity more often than on a torsion spring. Of a
free decay the few combinations are tried at the base fit, of a driven slider by a regression of its force on the
smoothed motion. Another than the plain spring is taken only where what is left falls by what a misfit counts (a word a
stroke): anything smaller may be an effect of its own.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.arrays import BoolArray, FloatArray
from harness.core.errors import InputError, SimulationError
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.baseline.words import Strokes, evidence, words_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import GAIN, LARGE_ANGLE, ZERO_REACH
from harness.diagnosis.smoothed_state.state import State, in_motion
from harness.model.model import Restoring

_LOOKED_AT = 1500
"""Samples that these first fits are made of."""
_NAMES = {Restoring.PENDULUM: "a pendulum", Restoring.SPRING: "a spring"}
_MOST = 0.9
"""Share of the mean square left of the force that a spring takes off only where there is one: of 60 driven axes that
have none, with one effect or without, it takes .12 off at most, of twelve recordings of pneumatic cylinders .32."""


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
    plain, words, gain = free, words_of(Strokes.by(first.shown.v)), 0.0
    for found, other, zero in fits[1:]:
        one = evidence(first.chi2, found.chi2, words, int(zero) - int(plain), 1.0)
        if one >= GAIN.value and one > gain:
            gain, restoring, free = one, other, zero
    problem = replace(problem, restoring=restoring, zero_free=free)
    return problem, _chosen(restoring, free, gain) if gain > 0.0 else ""


def _chosen(restoring: Restoring, free: bool, gain: float) -> str:
    """What was fitted because it is better by this in BIC."""
    return f"fitted {_NAMES[restoring]}{' with a zero offset' if free else ' measured from rest'} (BIC +{gain:.0f})"


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


def spring_beside(state: State, u: FloatArray, mass: float | None) -> tuple[float, float, bool]:
    """The stiffness (N/m) of a spring, what it takes off the mean square that the base leaves of a force u (n,), and
    whether that is so much that there is one; by least squares over the samples in motion.
    """
    base, right, moving = _base(state, u, mass)
    table = np.column_stack([*base, np.ones(right.size)])
    without, _ = _left_by(table, right)
    left, found = _left_by(np.column_stack([table, state[0][moving]]), right)
    k, share = float(found[-1]), 1.0 - left / without if without > 0.0 else 0.0
    return k, share, k > 0.0 and share > _MOST


def _base(state: State, u: FloatArray, mass: float | None) -> tuple[list[FloatArray], FloatArray, BoolArray]:
    """Of the samples in motion: what the base's forces are in proportion to, the force (m,), and which they are."""
    _, v, a = state
    moving = in_motion(v)
    columns = [v, np.sign(v), *([a] if mass is None else [])]
    return [y[moving] for y in columns], (u if mass is None else u - mass * a)[moving], moving


def _left_by(table: FloatArray, right: FloatArray) -> tuple[float, FloatArray]:
    """Sum of squares that the columns (n, q) leave, and their factors (q,)."""
    size = np.sqrt(np.mean(table**2, axis=0))
    size[size == 0.0] = 1.0
    found = np.linalg.lstsq(table / size, right, rcond=None)[0] / size
    rest = right - table @ found
    return float(rest @ rest), found


def held_driven(asked: Asked, state: State, u: FloatArray, angular: bool) -> tuple[Asked, tuple[str, ...]]:
    """What was asked, with restoring force and zero as the force u (n,) has them where nobody said; and a sentence.

    Where covariates act they may be the force that a zero would take up, and a servo's joint has its own zero: there
    both are taken as they were asked.
    """
    given = asked.zero_free is not None or asked.covariates or asked.guarded
    if given or asked.restoring in (Restoring.NONE, Restoring.PENDULUM):
        return asked, ()
    columns, right, moving = _base(state, u, asked.mass)
    base, x = np.column_stack(columns), state[0][moving]
    # by which a force pulls back towards a zero that is not known
    ways = {Restoring.SPRING: np.column_stack([x, np.ones_like(x)])}
    if asked.restoring is None and angular:
        ways[Restoring.PENDULUM] = np.column_stack([np.sin(x), np.cos(x)])
    found = {way: _left_by(np.column_stack([pull, base]), right) for way, pull in ways.items()}
    free, _ = _left_by(np.column_stack([base, np.ones(right.size)]), right)
    plain, _ = _left_by(np.column_stack([x, base]), right)
    hangs = Restoring.PENDULUM
    # whether some way takes nearly all off what is left of the force without any
    pulls = any((way is hangs or by[0] > 0.0) and left < (1.0 - _MOST) * free for way, (left, by) in found.items())
    if asked.restoring is None and not pulls:
        return replace(asked, restoring=Restoring.NONE), ("held by nothing: the force shows no spring",)
    reach, words = 0.5 * float(np.ptp(state[0])), words_of(Strokes.by(state[1][moving]))
    best, most = Restoring.SPRING, 0.0
    for way, (left, by) in found.items():
        gain = evidence(plain, left, words, 1, 1.0) if left > 0.0 else 0.0
        # something that pulls back, towards a zero not far off
        near = by[0] > 0.0 and abs(by[1]) <= ZERO_REACH.value * reach * by[0]
        if (way is hangs or near) and gain >= GAIN.value and gain > most:
            best, most = way, gain
    chosen = replace(asked, restoring=best, zero_free=most > 0.0)
    return chosen, (_chosen(best, True, most),) if most > 0.0 else ()
