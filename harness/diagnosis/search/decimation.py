"""A long recording in few samples, for first looks: means of what a model leaves, added to what it shows.

A thinned recording throws away most of what it says. What a fitted model leaves over is slow beside the motion, so that
its means over short groups of samples keep nearly all of it, at the noise of a mean.
"""

import math

from harness.diagnosis.fit.observe import Observation
from harness.diagnosis.problem import P

_PER_CYCLE = 24
"""Groups a cycle is given at least: the third harmonic then keeps 96 % of its height."""


def condensed(problem: P, shown: Observation, samples: int, omega: float) -> tuple[P, float]:
    """A problem of about this many samples, and by how much its chi-square falls short of the whole one's.

    shown : what a model fitted to ``problem`` shows. omega : rad/s.
    """
    n = problem.t.size
    cycles = omega * float(problem.t[-1] - problem.t[0]) / (2.0 * math.pi)
    size = int(n // max(samples, _PER_CYCLE * cycles))
    return (problem, 1.0) if size <= 1 else problem.condensed(shown.y, size)
