"""Whether a recording shows a swing at all: the base model against a slider at rest under a sensor's noise.

A base fit follows noise as well as it can and leaves noise, so that a test of what is left says "adequate" of a sensor
that hangs on the bench. The rival moves nothing: of every channel a level, with noise about it that may wander. That is
an ARMA(1, 1) process, whose root is real: white noise, a random walk, all between and both together. It swings at no
frequency (Box and Jenkins 1976, chapter 3).
"""

import math
from collections.abc import Mapping

import numpy as np
from scipy.optimize import minimize

from harness.core.arrays import FloatArray
from harness.core.errors import InputError
from harness.diagnosis.baseline.words import Strokes
from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.problem import Problem
from harness.diagnosis.rules import DECISIVE

FEWEST_HALF_CYCLES = 3
"""Of a free decay: its damping and its friction are two numbers, which take three amplitudes."""
_STARTS = ((0.0, 0.0), (0.7, 0.0), (0.97, 0.0), (0.97, 0.7), (0.999, 0.95))
"""Of memory and of what noise beside it takes off: white, coloured, wandering, and wandering under white noise."""


def refuse_no_swing(base: Fit, problem: Problem) -> None:
    """Raise InputError where the base model says no more of the channels than a slider at rest does, or does not swing.

    A sensor that drifts is followed by a slider that creeps.
    """
    accepted = "a slider let go, or the force that moves it as a column u, is accepted"
    count = Strokes.by(base.shown.v).count
    if problem.returns and count < FEWEST_HALF_CYCLES:
        half = f"{count} half-cycle{'' if count == 1 else 's'}"
        found = f"no free decay: the best fit has {half}, not {FEWEST_HALF_CYCLES}; a drifting sensor looks like this"
        raise InputError("recording", found, accepted)
    if swing_evidence(base, problem) >= DECISIVE.value:
        return
    seen = ", ".join(f"{c} {float(np.std(y)):.3g}" for c, y in problem.channels.items())
    found = f"no free decay: a swinging slider explains it no better than noise about a level does (rms: {seen})"
    raise InputError("recording", found, accepted)


def swing_evidence(base: Fit, problem: Problem) -> float:
    """By how much BIC prefers the base model's motion to a slider at rest.

    Both leave noise of unknown level and colour, fitted to what each leaves of every channel.
    """
    left = {c: problem.even(c, y - base.shown.y[c]) for c, y in problem.channels.items()}
    return motion_evidence(problem.channels, left, len(base.free))


def motion_evidence(channels: Mapping[str, FloatArray], left: Mapping[str, FloatArray], numbers: int) -> float:
    """By how much BIC prefers a motion to rest under noise of unknown level and colour.

    channels (n,) : as recorded. left (n,) : what the motion leaves of each. numbers : fitted, of the motion.
    """
    gain, samples = 0.0, 0
    for c, y in channels.items():
        moving = _innovations(left[c])
        if moving <= 0.0:
            return math.inf
        gain += y.size * math.log(_innovations(y - np.mean(y)) / moving)
        samples += y.size
    return gain - (numbers - len(channels)) * math.log(samples)


def _innovations(left: FloatArray) -> float:
    """Mean square of what each value of a series (n,) adds to what those before say of it."""
    # imported when it is needed: it brings half of its library along
    from scipy.signal import lfilter

    def added(at: FloatArray) -> float:
        memory, beside = at
        fresh = lfilter([1.0], [1.0, -beside], left[1:] - memory * left[:-1])
        return float(np.mean(fresh**2))

    start = min(_STARTS, key=lambda at: added(np.array(at)))
    found = minimize(added, start, method="Nelder-Mead", bounds=[(-1.0, 1.0), (-1.0, 1.0)], options={"maxfev": 100})
    return float(found.fun)
