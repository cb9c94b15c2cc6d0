"""How a slider is held, where nobody says: spring or pendulum, and whether x is measured from the spring's rest.

An encoder's zero is anywhere, and a large swing of an angle hangs on gravity more often than on a torsion spring. The
few combinations are tried at the base fit, and another than the plain spring is taken only where the misfit falls by
what a misfit counts (a word a stroke): anything smaller may be an effect of its own.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np

from harness.core.errors import InputError, SimulationError
from harness.diagnosis.baseline.base_fit import baseline
from harness.diagnosis.baseline.words import Strokes, evidence, words_of
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import P, Problem
from harness.diagnosis.request import Asked
from harness.diagnosis.rules import GAIN, LARGE_ANGLE
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
