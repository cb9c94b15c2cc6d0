"""Does anything but noise stay? Low-frequency power of the whitened residual against what noise has there."""

import math
from dataclasses import dataclass

import numpy as np

from harness.diagnosis.fit import Fit
from harness.diagnosis.problem import Problem

_HIGHEST = 8.0
"""Multiple of the natural frequency up to which a smooth misfit shows."""
_ONE_IN = 1e-5


@dataclass(frozen=True, slots=True)
class Structure:
    """z : power below the highest frequency in standard deviations over what noise would have, worst channel."""

    z: float
    limit: float

    @property
    def none(self) -> bool:
        """Whether noise alone explains it."""
        return self.z < self.limit


def structure(found: Fit, problem: Problem, omega: float) -> Structure:
    """Structure left in a fit's residual."""
    from scipy.stats import chi2, norm

    t = problem.t
    n = t.size
    worst = -math.inf
    for i, channel in enumerate(problem.channels):
        r = found.residual[i * n : (i + 1) * n]
        weight = problem.weight[channel]
        if np.count_nonzero(weight) < 16:
            continue
        interval = float(np.median(np.diff(t)))
        power = np.abs(np.fft.rfft(r)) ** 2 / np.count_nonzero(weight)
        top = min(int(_HIGHEST * omega * interval * n / (2.0 * math.pi)), power.size - 2)
        top = max(top, 4)
        low = float(np.sum(power[1 : top + 1]))
        # each ordinate of unit white noise is exponential with mean one
        p = float(chi2.sf(2.0 * low, 2 * top))
        worst = max(worst, float(norm.isf(max(p, 1e-300))))
    return Structure(worst, float(norm.isf(_ONE_IN)))
