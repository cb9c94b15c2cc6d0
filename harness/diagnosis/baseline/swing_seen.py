"""Whether a fitted motion says more of a recording than a slider at rest under a sensor's noise.

A fit follows noise as well as it can and leaves noise. The rival moves nothing: of every channel a level, with noise
about it that may wander. That is an ARMA(1, 1) process, whose root is real: white noise, a random walk, all between and
both together. It swings at no frequency (Box and Jenkins 1976, chapter 3).
"""

import math
from collections.abc import Mapping

import numpy as np

from harness.core.arrays import FloatArray

_STARTS = ((0.0, 0.0), (0.7, 0.0), (0.97, 0.0), (0.97, 0.7), (0.999, 0.95))
"""Of memory and of what noise beside it takes off: white, coloured, wandering, and wandering under white noise."""


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
    # imported when they are needed: they bring half of their library along
    from scipy.optimize import minimize
    from scipy.signal import lfilter

    def added(at: FloatArray) -> float:
        memory, beside = at
        fresh = lfilter([1.0], [1.0, -beside], left[1:] - memory * left[:-1])
        return float(np.mean(fresh**2))

    start = min(_STARTS, key=lambda at: added(np.array(at)))
    found = minimize(added, start, method="Nelder-Mead", bounds=[(-1.0, 1.0), (-1.0, 1.0)], options={"maxfev": 100})
    return float(found.fun)
